//! Sheets of the layers of all frames: encoded and written by rows of frames, so that no sheet is in memory.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_author::sprite::six_way::Packing;
use haze_core::assets::image::Image;
use haze_core::error::{AssetError, Error};
use haze_core::formula::six_way::SixWay;
use haze_core::formula::tonemap::DisplayTransform;
use haze_core::settings::Tonemap;
use haze_demo::tonemap_pass::{encoded, rgba8_codes};
use haze_preset::CompressionEffort;

use super::fill::filled;
use super::frame_layers::FrameLayers;
use super::motion_fit::{HalfwayImages, followed, kept_inside};
use crate::engine::Engine;
use crate::image_format::{Alpha, Emission};
use crate::png_stream::{EncodedPng, PngShape, PngStream};

pub const COLOR: &str = "color.png";
pub const NORMALS: &str = "normals.png";
pub const MOTION: &str = "motion.png";
pub const EMISSION: &str = "emission.png";
pub const SIX_WAY: [&str; 2] = ["six_way_1.png", "six_way_2.png"];

/// Least opacity of smoke whose motion and brightness set the scale of a sheet.
const VISIBLE: f32 = 0.05;

/// Texels of the sheets of a row: codes, and values of which the scale is known after the last frame.
type Rgba = [u8; 4];
type Rgb = [u8; 3];
/// Way to the right and up.
type Way = [f32; 2];
/// Light from the positive sides, from the negative sides, opacity, emission.
type SixWayTexel = [f32; 8];

/// Bytes of memory per pixel of a row of frames.
pub fn row_bytes_per_pixel(burns: bool, has_six_way: bool) -> u64 {
    let color = size_of::<Rgba>() + size_of::<Rgb>() + size_of::<Way>();
    let fire = if burns { size_of::<Rgb>() } else { 0 };
    let six_way = if has_six_way { size_of::<SixWayTexel>() } else { 0 };
    (color + fire + six_way) as u64
}

/// Bytes of memory per pixel of a frame: layers of this frame and of one that fades into it, the encoded frame and the images halfway
/// to its neighbors, and a layer that is filled (light without fire, its texels, those of coarser levels, and the result).
pub fn frame_bytes_per_pixel(burns: bool, has_six_way: bool) -> u64 {
    let six_way = if has_six_way { SIX_WAY.len() as u64 + u64::from(burns) } else { 0 };
    let layers = 3 + u64::from(burns) + six_way;
    let texel = size_of::<Vec4>() as u64;
    (2 * layers + 3) * texel + 5 * texel
}

/// Layout that all sheets share.
#[derive(Clone, Copy)]
pub struct SheetLayout<'a> {
    /// Engine whose conventions they follow.
    pub engine: Engine,
    /// Size of a frame.
    pub frame: UVec2,
    /// Rows (`x`) and columns (`y`).
    pub cells: UVec2,
    /// Of the colors.
    pub alpha: Alpha,
    /// Of the colors.
    pub emission: Emission,
    /// Of the colors.
    pub tonemap: Tonemap,
    /// Of the files.
    pub effort: CompressionEffort,
    /// Folder of the files; it need not exist.
    pub folder: &'a Path,
}

impl SheetLayout<'_> {
    /// Encodes light that is exposed.
    pub fn encoded(&self, exposed: &Image<Vec4>) -> Image<Vec4> {
        encoded(exposed, DisplayTransform { exposure: 1.0, tonemap: self.tonemap })
    }

    fn size(&self) -> UVec2 {
        self.frame * UVec2::new(self.cells.y, self.cells.x)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The folder, or the nearest above it that exists.
    fn scratch(&self) -> &Path {
        self.folder.ancestors().find(|folder| folder.is_dir()).unwrap_or(Path::new("."))
    }

    fn png(&self, name: &str, has_alpha: bool) -> Result<PngStream, Error> {
        let size = self.size();
        let shape =
            PngShape { width: size.x, height: size.y, has_alpha, path: self.path(name), scratch: self.scratch() };
        PngStream::new(shape, self.effort)
    }
}

/// Row of frames of one sheet.
struct Row<T> {
    width: usize,
    texels: Vec<T>,
}

impl<T: Pod> Row<T> {
    fn new(layout: &SheetLayout<'_>) -> Self {
        let width = layout.size().x as usize;
        Self { width, texels: vec![T::zeroed(); width * layout.frame.y as usize] }
    }

    /// Encodes a frame. `texel` gets its texel and the position in the frame.
    fn place(&mut self, frame: &Image<Vec4>, column: u32, texel: impl Fn(Vec4, UVec2) -> T + Sync)
    where
        T: Send,
    {
        let mut codes = Image::new(frame.size, T::zeroed());
        codes.for_each(|at, code| *code = texel(frame.load(at.as_ivec2()), at));
        let side = frame.size.x as usize;
        let start = column as usize * side;
        for (row, codes) in self.texels.chunks_mut(self.width).zip(codes.texels.chunks(side)) {
            row[start..][..side].copy_from_slice(codes);
        }
    }

    fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.texels)
    }
}

/// A sheet of codes.
struct CodeSheet<T> {
    name: &'static str,
    row: Row<T>,
    png: PngStream,
}

impl<T: Pod> CodeSheet<T> {
    fn new(layout: &SheetLayout<'_>, name: &'static str) -> Result<Self, Error> {
        Ok(Self { name, row: Row::new(layout), png: layout.png(name, size_of::<T>() == size_of::<Rgba>())? })
    }

    fn end_row(&mut self) -> Result<(), Error> {
        self.png.write_rows(self.row.bytes())
    }

    fn finish(self) -> Result<(&'static str, EncodedPng), Error> {
        Ok((self.name, self.png.finish()?))
    }
}

/// A sheet of values, in a temporary file without a name until their scale is known.
struct ValueSheet<T> {
    row: Row<T>,
    path: PathBuf,
    values: File,
    largest: f32,
}

impl<T: Pod> ValueSheet<T> {
    /// `name`: file that is named in errors.
    fn new(layout: &SheetLayout<'_>, name: &str) -> Result<Self, Error> {
        let path = layout.path(name);
        let values = tempfile::tempfile_in(layout.scratch());
        let values = values.map_err(|error| Error::from(AssetError::Io { path: path.clone(), error }))?;
        Ok(Self { row: Row::new(layout), path, values, largest: 0.0 })
    }

    fn check(&self, result: io::Result<()>) -> Result<(), Error> {
        result.map_err(|error| Error::from(AssetError::Io { path: self.path.clone(), error }))
    }

    fn end_row(&mut self) -> Result<(), Error> {
        let written = self.values.write_all(self.row.bytes());
        self.check(written)
    }

    /// Encodes the values, by rows of frames.
    fn encode<C: Pod>(
        &mut self,
        mut png: PngStream,
        code: impl Fn(T) -> C,
        goes_on: &impl Fn() -> Result<(), Error>,
    ) -> Result<EncodedPng, Error> {
        let rewound = self.values.rewind();
        self.check(rewound)?;
        let rows = self.values.metadata().map(|found| found.len() / self.row.bytes().len().max(1) as u64);
        let rows = rows.map_err(|error| Error::from(AssetError::Io { path: self.path.clone(), error }))?;
        for _ in 0..rows {
            goes_on()?;
            let read = self.values.read_exact(bytemuck::cast_slice_mut(&mut self.row.texels));
            self.check(read)?;
            let codes: Vec<C> = self.row.texels.iter().map(|value| code(*value)).collect();
            png.write_rows(bytemuck::cast_slice(&codes))?;
        }
        png.finish()
    }
}

/// Sheets of layers, divided by opacity and filled; opacity in alpha. Fire stays multiplied, and so do premultiplied colors: where
/// they are clear, 0 is the color that filters right, and glow is kept.
pub struct Sheets<'a> {
    layout: SheetLayout<'a>,
    /// Number of frames that have been placed.
    placed: u32,
    light: CodeSheet<Rgba>,
    normals: CodeSheet<Rgb>,
    motion: ValueSheet<Way>,
    fire: Option<CodeSheet<Rgb>>,
    six_way: Option<ValueSheet<SixWayTexel>>,
    /// Largest emission in visible smoke; `None` without fire.
    brightest_fire: Option<f32>,
}

/// Encoded sheets, by file name.
pub struct EncodedSheets {
    pub images: Vec<(&'static str, EncodedPng)>,
    pub motion_scale: f32,
    pub six_way_intensity: Option<f32>,
    pub six_way_emission: Option<f32>,
}

impl<'a> Sheets<'a> {
    /// Starts the sheets.
    ///
    /// # Errors
    /// [`AssetError::Io`] if no temporary file can be created.
    pub fn new(layout: SheetLayout<'a>, burns: bool, has_six_way: bool) -> Result<Self, Error> {
        Ok(Self {
            light: CodeSheet::new(&layout, COLOR)?,
            normals: CodeSheet::new(&layout, NORMALS)?,
            motion: ValueSheet::new(&layout, MOTION)?,
            fire: if burns { Some(CodeSheet::new(&layout, EMISSION)?) } else { None },
            six_way: if has_six_way { Some(ValueSheet::new(&layout, SIX_WAY[0])?) } else { None },
            brightest_fire: None,
            layout,
            placed: 0,
        })
    }

    /// Places the next frame. Its motion vectors are fitted to the images halfway to its neighbors.
    ///
    /// # Errors
    /// [`AssetError::Io`] if a row of frames cannot be written.
    pub fn place(&mut self, layers: &FrameLayers, halfway: HalfwayImages<'_>) -> Result<(), Error> {
        let light = match (self.layout.emission, &layers.fire) {
            (Emission::Separate, Some(fire)) => &without(&layers.light, fire),
            _ => &layers.light,
        };
        match self.layout.alpha {
            Alpha::Straight => self.place_light(&filled(light)),
            Alpha::Premultiplied => self.place_light(light),
        }
        self.place_normals(&filled(&layers.normals));
        let frame = self.layout.encoded(&layers.light);
        self.place_motion(&kept_inside(&followed(&filled(&layers.motion), &frame, halfway)));
        if let Some(fire) = &layers.fire {
            self.place_fire(fire);
        }
        if let Some([positive, negative]) = &layers.six_way {
            let emission = layers.emission.as_ref().map(filled);
            self.place_six_way(&filled(positive), &filled(negative), emission.as_ref());
        }
        self.end_cell()
    }

    fn leave_blank(&mut self) -> Result<(), Error> {
        let blank = Image::new(self.layout.frame, Vec4::ZERO);
        self.place_light(&blank);
        self.place_normals(&blank);
        self.place_motion(&blank);
        self.place_fire(&blank);
        self.place_six_way(&blank, &blank, None);
        self.end_cell()
    }

    fn column(&self) -> u32 {
        self.placed % self.layout.cells.y
    }

    /// Upper left texel of the next frame in the sheet.
    fn corner(&self) -> UVec2 {
        UVec2::new(self.column(), self.placed / self.layout.cells.y) * self.layout.frame
    }

    fn place_light(&mut self, light: &Image<Vec4>) {
        let corner = self.corner();
        let column = self.column();
        // Dithering depends on the position in the sheet.
        self.light.row.place(&self.layout.encoded(light), column, |texel, at| rgba8_codes(texel, corner + at));
    }

    fn place_fire(&mut self, fire: &Image<Vec4>) {
        let corner = self.corner();
        let column = self.column();
        if let Some(sheet) = &mut self.fire {
            sheet.row.place(&self.layout.encoded(fire), column, |texel, at| {
                let [r, g, b, _] = rgba8_codes(texel, corner + at);
                [r, g, b]
            });
        }
    }

    fn place_normals(&mut self, normals: &Image<Vec4>) {
        let up = if self.layout.engine.normals_point_up() { 1.0 } else { -1.0 };
        let column = self.column();
        self.normals.row.place(normals, column, |texel, _| {
            let normal = texel.xyz().normalize_or(Vec3::Z);
            codes((normal * Vec3::new(0.5, 0.5 * up, 0.5) + 0.5).to_array())
        });
    }

    fn place_motion(&mut self, motion: &Image<Vec4>) {
        let column = self.column();
        self.motion.row.place(motion, column, |way, _| way.xy().to_array());
        self.motion.largest = self.motion.largest.max(largest(motion, |way| way.xy().abs().max_element()));
    }

    fn place_six_way(&mut self, positive: &Image<Vec4>, negative: &Image<Vec4>, emission: Option<&Image<Vec4>>) {
        let column = self.column();
        if let Some(sheet) = &mut self.six_way {
            sheet.row.place(positive, column, |p, at| {
                let n = negative.load(at.as_ivec2());
                let fire = emission.map_or(0.0, |emission| emission.load(at.as_ivec2()).x);
                [p.x, p.y, p.z, n.x, n.y, n.z, p.w, fire]
            });
            for side in [positive, negative] {
                sheet.largest = sheet.largest.max(largest(side, |light| light.xyz().max_element()));
            }
            if let Some(emission) = emission {
                let brightest = self.brightest_fire.unwrap_or_default();
                self.brightest_fire = Some(brightest.max(largest(emission, |fire| fire.x)));
            }
        }
    }

    /// Writes the row of frames if this was the last of it.
    fn end_cell(&mut self) -> Result<(), Error> {
        self.placed += 1;
        if self.column() > 0 {
            return Ok(());
        }
        self.light.end_row()?;
        self.normals.end_row()?;
        self.motion.end_row()?;
        self.fire.as_mut().map_or(Ok(()), CodeSheet::end_row)?;
        self.six_way.as_mut().map_or(Ok(()), ValueSheet::end_row)
    }

    /// Bytes of memory that the rows of frames take.
    #[cfg(test)]
    pub fn bytes(&self) -> usize {
        let fire = self.fire.as_ref().map_or(0, |sheet| sheet.row.bytes().len());
        let six_way = self.six_way.as_ref().map_or(0, |sheet| sheet.row.bytes().len());
        let color = self.light.row.bytes().len() + self.normals.row.bytes().len();
        color + self.motion.row.bytes().len() + fire + six_way
    }

    /// Encodes the sheets. Cells without a frame are clear. `goes_on` returns an error to stop the work.
    ///
    /// # Errors
    /// [`AssetError::Io`] if they cannot be written; that of `goes_on`.
    pub fn encode(mut self, goes_on: &impl Fn() -> Result<(), Error>) -> Result<EncodedSheets, Error> {
        while self.placed < self.layout.cells.element_product() {
            goes_on()?;
            self.leave_blank()?;
        }
        let Self { layout, light, normals, mut motion, fire, six_way, brightest_fire, .. } = self;
        let mut images = vec![light.finish()?, normals.finish()?];
        let motion_scale = motion.largest.max(1.0e-4);
        // In texture coordinates, whose origin is at the top but in Unity.
        let down = if layout.engine.first_row_is_at_the_top() { -1.0 } else { 1.0 };
        let way_codes = |way: Way| {
            let way = Vec2::from(way) / motion_scale * Vec2::new(1.0, down);
            codes((way.clamp(Vec2::NEG_ONE, Vec2::ONE) * 0.5 + 0.5).extend(0.5).to_array())
        };
        images.push((MOTION, motion.encode(layout.png(MOTION, false)?, way_codes, goes_on)?));
        if let Some(fire) = fire {
            images.push(fire.finish()?);
        }
        let mut six_way_intensity = None;
        let has_emission = layout.engine.six_way_packing().has_emission();
        let six_way_emission = brightest_fire.filter(|_| has_emission).map(|brightest| brightest.max(1.0e-4));
        if let Some(mut six_way) = six_way {
            let brightest = six_way.largest.max(1.0e-4);
            six_way_intensity = Some(brightest);
            for (map, name) in SIX_WAY.into_iter().enumerate() {
                let packing = layout.engine.six_way_packing();
                let light_codes =
                    |texel| six_way_codes(texel, map, packing, [brightest, six_way_emission.unwrap_or(1.0)]);
                images.push((name, six_way.encode(layout.png(name, true)?, light_codes, goes_on)?));
            }
        }
        Ok(EncodedSheets { images, motion_scale, six_way_intensity, six_way_emission })
    }
}

/// Light without that of fire.
fn without(light: &Image<Vec4>, fire: &Image<Vec4>) -> Image<Vec4> {
    let rest = |(light, fire): (&Vec4, &Vec4)| (light.xyz() - fire.xyz()).max(Vec3::ZERO).extend(light.w);
    Image { size: light.size, texels: light.texels.iter().zip(&fire.texels).map(rest).collect() }
}

/// Largest value in visible smoke.
fn largest(frame: &Image<Vec4>, value: impl Fn(&Vec4) -> f32) -> f32 {
    frame.texels.iter().filter(|texel| texel.w > VISIBLE).map(value).fold(0.0, f32::max)
}

fn codes<const N: usize>(values: [f32; N]) -> [u8; N] {
    values.map(|value| (value * 255.0).round() as u8)
}

/// A map of six-way light, linear, with opacity or emission in alpha. `white`: light and emission of full codes.
fn six_way_codes(texel: SixWayTexel, map: usize, packing: Packing, [white, white_fire]: [f32; 2]) -> Rgba {
    let [a, b, c, d, e, f, opacity, fire] = texel;
    let light = SixWay { positive: Vec3::new(a, b, c) / white, negative: Vec3::new(d, e, f) / white };
    let alpha = if map == 1 && packing.has_emission() { fire / white_fire } else { opacity };
    codes(packing.texels(light)[map].extend(alpha).to_array())
}
