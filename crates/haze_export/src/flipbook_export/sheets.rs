//! Sheets of the layers of all frames, and their encoding.

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::six_way::SixWay;
use haze_demo::tonemap_pass::{encoded, rgba8};
use image::{DynamicImage, Rgb, RgbImage, Rgba, RgbaImage};

use super::fill::filled;
use super::frame_layers::FrameLayers;
use super::motion_fit::followed;
use crate::engine::Engine;

pub const COLOR: &str = "color.png";
pub const NORMALS: &str = "normals.png";
pub const MOTION: &str = "motion.png";
pub const EMISSION: &str = "emission.png";
pub const SIX_WAY: [&str; 2] = ["six_way_1.png", "six_way_2.png"];

/// Least opacity of smoke whose motion and brightness set the scale of a sheet.
const VISIBLE: f32 = 0.05;

/// Sheets of layers, divided by opacity and filled; opacity in alpha. Fire stays multiplied.
pub struct Sheets {
    frame: UVec2,
    columns: u32,
    light: Image<Vec4>,
    normals: Image<Vec4>,
    motion: Image<Vec4>,
    fire: Option<Image<Vec4>>,
    six_way: Option<[Image<Vec4>; 2]>,
}

/// Bytes of memory per pixel of sheets, between rendering and the files: the sheets, one that is being encoded, and those that
/// are. Half as much again allows for the allocator's overhead.
pub fn bytes_per_pixel(burns: bool, has_six_way: bool) -> u64 {
    let (texel, six_way) = (size_of::<Vec4>() as u64, SIX_WAY.len() as u64);
    // Color with alpha, normals, motion.
    let (mut sheets, mut encoded) = (3, 4 + 3 + 3);
    if burns {
        (sheets, encoded) = (sheets + 1, encoded + 3);
    }
    if has_six_way {
        (sheets, encoded) = (sheets + six_way, encoded + 4 * six_way);
    }
    ((sheets + 1) * texel + encoded) * 3 / 2
}

/// Encoded sheets, by file name.
pub struct EncodedSheets {
    pub images: Vec<(&'static str, DynamicImage)>,
    pub motion_scale: f32,
    pub six_way_intensity: Option<f32>,
}

impl Sheets {
    /// `frame`: size of a frame. `cells`: rows and columns.
    pub fn new(frame: UVec2, cells: UVec2) -> Self {
        let empty = || Image::new(frame * UVec2::new(cells.y, cells.x), Vec4::ZERO);
        Self { frame, columns: cells.y, light: empty(), normals: empty(), motion: empty(), fire: None, six_way: None }
    }

    /// Places a frame. `pair`: this frame and a neighbour, in the order of time, encoded; motion vectors lead from the first to
    /// the second.
    pub fn place(&mut self, index: u32, layers: &FrameLayers, pair: [&Image<Vec4>; 2]) {
        let corner = UVec2::new(index % self.columns, index / self.columns) * self.frame;
        let size = self.light.size;
        let empty = || Image::new(size, Vec4::ZERO);
        copy(&mut self.light, &filled(&layers.light), corner);
        copy(&mut self.normals, &filled(&layers.normals), corner);
        copy(&mut self.motion, &followed(&filled(&layers.motion), pair), corner);
        if let Some(fire) = &layers.fire {
            copy(self.fire.get_or_insert_with(empty), fire, corner);
        }
        if let Some(sides) = &layers.six_way {
            let sheets = self.six_way.get_or_insert_with(|| [empty(), empty()]);
            sheets.iter_mut().zip(sides).for_each(|(sheet, side)| copy(sheet, &filled(side), corner));
        }
    }

    /// Bytes of memory that the sheets take.
    #[cfg(test)]
    pub fn bytes(&self) -> usize {
        let all = [&self.light, &self.normals, &self.motion].into_iter();
        let all = all.chain(&self.fire).chain(self.six_way.iter().flatten());
        all.map(|sheet| size_of_val(sheet.texels.as_slice())).sum()
    }

    /// Encodes the sheets in the conventions of an engine.
    pub fn encode(&self, engine: Engine) -> EncodedSheets {
        let up = if engine.normals_point_up() { 1.0 } else { -1.0 };
        let normals = rgb8(&self.normals, |texel| {
            let normal = texel.xyz().normalize_or(Vec3::Z);
            normal * Vec3::new(0.5, 0.5 * up, 0.5) + 0.5
        });
        let motion_scale = largest(&self.motion, |way| way.xy().abs().max_element()).max(1.0e-4);
        // In texture coordinates, whose origin is at the top but in Unity.
        let down = if engine.first_row_is_at_the_top() { -1.0 } else { 1.0 };
        let motion = rgb8(&self.motion, |texel| {
            let way = texel.xy() / motion_scale * glam::Vec2::new(1.0, down);
            (way.clamp(glam::Vec2::NEG_ONE, glam::Vec2::ONE) * 0.5 + 0.5).extend(0.5)
        });
        let mut images =
            vec![(COLOR, rgba8(&encoded(&self.light, 1.0)).into()), (NORMALS, normals.into()), (MOTION, motion.into())];
        if let Some(fire) = &self.fire {
            images.push((EMISSION, DynamicImage::from(rgba8(&encoded(fire, 1.0))).into_rgb8().into()));
        }
        let six_way_intensity = self.six_way.as_ref().map(|sides| {
            let brightest = sides.each_ref().map(|side| largest(side, |light| light.xyz().max_element()));
            let brightest = brightest[0].max(brightest[1]).max(1.0e-4);
            let maps = SIX_WAY.into_iter().zip(six_way_maps(sides, engine, 1.0 / brightest));
            images.extend(maps.map(|(name, map)| (name, map.into())));
            brightest
        });
        EncodedSheets { images, motion_scale, six_way_intensity }
    }
}

fn copy(sheet: &mut Image<Vec4>, frame: &Image<Vec4>, corner: UVec2) {
    let (width, side) = (sheet.size.x as usize, frame.size.x as usize);
    let start = corner.y as usize * width + corner.x as usize;
    for (y, row) in frame.texels.chunks(side).enumerate() {
        sheet.texels[start + y * width..][..side].copy_from_slice(row);
    }
}

/// Largest value in visible smoke.
fn largest(sheet: &Image<Vec4>, value: impl Fn(&Vec4) -> f32) -> f32 {
    sheet.texels.iter().filter(|texel| texel.w > VISIBLE).map(value).fold(0.0, f32::max)
}

fn rgb8(sheet: &Image<Vec4>, encode: impl Fn(Vec4) -> Vec3) -> RgbImage {
    RgbImage::from_fn(sheet.size.x, sheet.size.y, |x, y| {
        let code = encode(sheet.load(UVec2::new(x, y).as_ivec2()));
        Rgb(code.to_array().map(|channel| (channel * 255.0).round() as u8))
    })
}

/// The two maps of six-way light, linear, with opacity in alpha.
fn six_way_maps([positive, negative]: &[Image<Vec4>; 2], engine: Engine, scale: f32) -> [RgbaImage; 2] {
    [0, 1].map(|map| {
        RgbaImage::from_fn(positive.size.x, positive.size.y, |x, y| {
            let at = UVec2::new(x, y).as_ivec2();
            let [p, n] = [positive, negative].map(|side| side.load(at));
            let light = SixWay { positive: p.xyz() * scale, negative: n.xyz() * scale };
            let texel = engine.six_way_packing().texels(light)[map].extend(p.w);
            Rgba(texel.to_array().map(|channel| (channel * 255.0).round() as u8))
        })
    })
}
