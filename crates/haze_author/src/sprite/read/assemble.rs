//! Builds haze's images from sheets whose questions are answered.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};
use haze_core::assets::image::{Image, MAX_SIDE};
use haze_core::assets::sprite::{MAX_FRAMES, Sprite, SpriteLayout};
use haze_core::formula::color::{linear_from_srgb, luminance};
use haze_core::formula::saturate;
use haze_core::formula::six_way::SixWay;
use image::{GrayImage, Luma, Rgba, RgbaImage};

use super::super::detail::{bake_detail_frame, detail_size, optical_flow};
use super::super::height::{dome_heights, map_pixels, normal_of};
use super::super::six_way::encode_texel;
use super::color::{AlphaMode, CodeSpace, decode};
use super::fill::continue_edges;
use super::frame_grid::FrameGrid;
use super::motion::MotionAxes;
use super::playback::Playback;
use super::sheet_file::SheetFile;
use super::six_way::SideOrder;

/// Channel of a file.
#[derive(Clone, Copy)]
pub(super) struct Channel<'a> {
    pub file: &'a SheetFile,
    /// 0 to 3: red, green, blue, alpha.
    pub index: usize,
}

/// Two light maps and the meaning of their codes.
#[derive(Clone, Copy)]
pub(super) struct LightMaps<'a> {
    pub maps: [&'a SheetFile; 2],
    pub sides: SideOrder,
    pub alpha: AlphaMode,
    pub space: CodeSpace,
}

/// Painted normals and the meaning of their codes.
#[derive(Clone, Copy)]
pub(super) struct NormalMap<'a> {
    pub file: &'a SheetFile,
    pub alpha: AlphaMode,
    pub space: CodeSpace,
    pub y_down: bool,
}

/// Motion vectors and the meaning of their codes.
#[derive(Clone, Copy)]
pub(super) struct MotionMap<'a> {
    pub file: &'a SheetFile,
    /// Code of rest in red and green, 0 to 1.
    pub rest: Vec2,
    pub axes: MotionAxes,
    pub scale: f32,
}

/// Heat of smoke.
#[derive(Clone, Copy)]
pub(super) enum HeatSource<'a> {
    /// One channel is the heat.
    Channel(Channel<'a>),
    /// The luminance of colors of sRGB is the heat.
    Luminance(&'a SheetFile),
}

/// Depth, near or far.
#[derive(Clone, Copy)]
pub(super) struct DepthMap<'a> {
    pub file: &'a SheetFile,
    /// True if white is near.
    pub white_is_near: bool,
}

/// All that images are built from.
pub(super) struct Sources<'a> {
    pub grid: FrameGrid,
    pub frames: u32,
    /// Size of a frame in the file of the finest frames.
    pub size: UVec2,
    pub playback: Playback,
    pub opacity: Channel<'a>,
    pub normals: Option<NormalMap<'a>>,
    pub light: Option<LightMaps<'a>>,
    pub motion: Option<MotionMap<'a>>,
    pub heat: Option<HeatSource<'a>>,
    pub depth: Option<DepthMap<'a>>,
    /// Relief of normals that are made from alpha or light.
    pub strength: f32,
}

/// Images of one sprite, as `haze sprite bake` writes them.
#[derive(Clone, Debug)]
pub struct ReadSprite {
    /// rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a = amount.
    pub image: RgbaImage,
    /// Depth and motion: see [`detail`](crate::sprite::detail).
    pub detail: RgbaImage,
    /// Six-way maps: see [`six_way`](crate::sprite::six_way).
    pub six_way: Option<RgbaImage>,
    /// Heat of what is visible.
    pub heat: Option<GrayImage>,
    /// Layout of the frames.
    pub layout: SpriteLayout,
    /// Side of a frame, texels.
    pub side: u32,
    /// Changes that were made: `motion by optical flow`.
    pub mended: Vec<String>,
}

/// Frames, and their cells on the sheet that is written.
struct OutputLayout {
    /// Frames of the source, in the order of the sheet.
    frames: Vec<u32>,
    /// Source frames from one to the next.
    step: u32,
    columns: u32,
    rows: u32,
    /// Side of a frame, before and after it is reduced.
    full_side: u32,
    side: u32,
}

impl OutputLayout {
    fn new(sources: &Sources<'_>, mended: &mut Vec<String>) -> Self {
        let halves = if sources.light.is_some() { 2 } else { 1 };
        let mut step = 1;
        while sources.frames.div_ceil(step) * halves > MAX_FRAMES {
            step *= 2;
        }
        if step > 1 {
            mended.push(format!("one of {step} frames: a sheet has at most {} frames", MAX_FRAMES / halves));
        }
        let mut count = sources.frames.div_ceil(step);
        // The sheet has no empty cells. A row alone would be wider than an image may be.
        let columns_of = |count: u32| {
            let fits = |columns: &u32| count.is_multiple_of(*columns) && columns * columns >= count;
            (1..=count).find(fits).unwrap_or(count)
        };
        let cells = sources.grid.cells;
        let mut columns = if cells.element_product() == count { cells.x } else { columns_of(count) };
        while count > 3 && columns > 3 * (count / columns) && cells.element_product() != count {
            count -= 1;
            columns = columns_of(count);
        }
        let left_out = sources.frames.div_ceil(step) - count;
        if left_out > 0 {
            mended.push(format!("{left_out} of the last frames left out: a sheet has no empty cells"));
        }
        let rows = count / columns;
        let full_side = sources.size.max_element();
        let mut side = full_side;
        while side * columns.max(halves * rows) > MAX_SIDE && side > 8 {
            side /= 2;
        }
        if side < full_side {
            mended.push(format!(
                "frames of {side}² instead of {full_side}²: an image has at most {MAX_SIDE} texels a side"
            ));
        }
        if sources.size.x != sources.size.y {
            mended.push(format!("frames of {}x{} in clear squares", sources.size.x, sources.size.y));
        }
        Self { frames: (0..count).map(|frame| frame * step).collect(), step, columns, rows, full_side, side }
    }

    /// Assembles frames of `size` by `size` texels to a sheet.
    fn sheet<T: Copy + Send>(&self, size: u32, frames: &[Image<T>], texel: impl Fn(T) -> Rgba<u8>) -> RgbaImage {
        RgbaImage::from_fn(size * self.columns, size * self.rows, |x, y| {
            let frame = &frames[(y / size * self.columns + x / size) as usize];
            texel(frame.load(UVec2::new(x % size, y % size).as_ivec2()))
        })
    }
}

/// One frame of the sprite that is built.
struct BuiltFrame {
    /// Normals, and the amount.
    normals: Image<Vec4>,
    /// Light from right, top and front, and from left, bottom and back, with the amount.
    light: Option<[Image<Vec4>; 2]>,
    heat: Option<Image<f32>>,
    offset: Image<f32>,
}

/// Builds all images.
pub(super) fn assemble(sources: &Sources<'_>) -> ReadSprite {
    let mut mended = Vec::new();
    let layout = OutputLayout::new(sources, &mut mended);
    let mut most_at_border = 0.0_f32;
    let built: Vec<_> = layout
        .frames
        .iter()
        .map(|&frame| {
            let (built, at_border) = build_frame(sources, &layout, frame);
            most_at_border = most_at_border.max(at_border);
            built
        })
        .collect();
    if most_at_border > 1.5 / 255.0 {
        let code = (most_at_border * 255.0).round();
        mended.push(format!("smoke faded out at the borders of frames, where alpha is up to {code}"));
    }
    if sources.normals.is_none() {
        mended.push(format!("normals from {}", if sources.light.is_some() { "the light maps" } else { "alpha" }));
    }
    let side = layout.side;
    let image = layout.sheet(side, &built.iter().map(|frame| frame.normals.clone()).collect::<Vec<_>>(), encode_normal);
    let six_way = sources.light.is_some().then(|| {
        let halves = [0, 1].map(|half| {
            let of_frame = |frame: &BuiltFrame| frame.light.as_ref().map(|light| light[half].clone());
            let frames: Vec<_> = built.iter().filter_map(of_frame).collect();
            layout.sheet(side, &frames, |light| encode_texel(light.truncate(), alpha_code(light.w)))
        });
        let [mut upper, lower] = halves.map(RgbaImage::into_raw);
        upper.extend(lower);
        RgbaImage::from_raw(side * layout.columns, 2 * side * layout.rows, upper).unwrap_or_default()
    });
    let heat = sources.heat.is_some().then(|| {
        GrayImage::from_fn(side * layout.columns, side * layout.rows, |x, y| {
            let frame = &built[(y / side * layout.columns + x / side) as usize];
            let at = UVec2::new(x % side, y % side).as_ivec2();
            Luma([alpha_code(frame.heat.as_ref().map_or(0.0, |heat| heat.load(at)))])
        })
    });
    let texels = built.iter().flat_map(|frame| frame.normals.texels.iter().map(|texel| encode_normal(*texel).0));
    let sprite = Sprite::with_levels(side, layout.frames.len() as u32, texels.collect());
    if sources.motion.is_none() && layout.frames.len() > 1 {
        mended.push("motion by optical flow".into());
    }
    if sources.depth.is_none() {
        mended.push("depth of a dome".into());
    }
    let detail_side = detail_size(side);
    let details: Vec<_> = (0..)
        .zip(&built)
        .map(|(index, frame)| {
            let motion = motion(sources, &layout, &sprite, index);
            bake_detail_frame(&sprite, index, &frame.offset, &motion)
        })
        .collect();
    let detail = layout.sheet(detail_side, &details, |texel| texel);
    let layout = SpriteLayout { columns: layout.columns, rows: layout.rows, y_down: false };
    ReadSprite { image, detail, six_way, heat, layout, side, mended }
}

/// Texels over which smoke that reaches a border fades out.
const FADE: f32 = 4.0;

/// Returns a frame, and the largest amount on the border of the source.
fn build_frame(sources: &Sources<'_>, layout: &OutputLayout, frame: u32) -> (BuiltFrame, f32) {
    let Sources { grid, size, .. } = *sources;
    let side = layout.side;
    let scale = layout.full_side as f32 / side as f32;
    let taps = (scale.ceil() as u32).max(1);
    let margin = (UVec2::splat(layout.full_side) - size) / 2;
    // Positions in the source that a texel covers; `None` in the margin.
    let positions = |at: UVec2| {
        (0..taps * taps).map(move |tap| {
            let offset = (UVec2::new(tap % taps, tap / taps).as_vec2() + 0.5) / taps as f32;
            let full = ((at.as_vec2() + offset) * scale).as_uvec2();
            (full.cmpge(margin).all() && full.cmplt(margin + size).all()).then(|| full - margin)
        })
    };
    let amount_of = |at: UVec2| sources.opacity.file.texel(&grid, frame, at, size)[sources.opacity.index];
    let mut at_border = 0.0_f32;
    for x in 0..size.x {
        at_border = at_border.max(amount_of(UVec2::new(x, 0))).max(amount_of(UVec2::new(x, size.y - 1)));
    }
    for y in 0..size.y {
        at_border = at_border.max(amount_of(UVec2::new(0, y))).max(amount_of(UVec2::new(size.x - 1, y)));
    }
    let is_cut = at_border > 1.5 / 255.0;
    let fade = |at: UVec2| {
        let inside = at.min(UVec2::splat(side - 1) - at).min_element() as f32;
        match (inside <= 0.0, is_cut) {
            (true, _) => 0.0,
            (false, true) => (inside / FADE).min(1.0),
            (false, false) => 1.0,
        }
    };
    let amounts = map_pixels(UVec2::splat(side), |at| {
        let sum: f32 = positions(at).flatten().map(amount_of).sum();
        sum / (taps * taps) as f32 * fade(at)
    });
    // Mean of a color, weighted by the amount.
    let mean = |at: UVec2, color: &dyn Fn(UVec2, f32) -> Vec3| {
        let mut sum = Vec3::ZERO;
        let mut weight = 0.0;
        for position in positions(at).flatten() {
            let amount = amount_of(position);
            let of_texel = amount.max(1.0e-4);
            sum += color(position, amount) * of_texel;
            weight += of_texel;
        }
        (if weight > 0.0 { sum / weight } else { Vec3::ZERO }).extend(amounts.load(at.as_ivec2()))
    };
    let with_color = |color: &(dyn Fn(UVec2, f32) -> Vec3 + Sync)| {
        let mut image = Image::new(UVec2::splat(side), Vec4::ZERO);
        image.for_each(|at, texel| *texel = mean(at, color));
        image
    };
    let light = sources.light.map(|light| {
        let of_texel = |at: UVec2, amount: f32| {
            let [first, second] = light.maps.map(|map| {
                let color = map.texel(&grid, frame, at, size).truncate();
                decode(color, amount, light.alpha, light.space).clamp(Vec3::ZERO, Vec3::ONE)
            });
            light.sides.six_way(first, second)
        };
        let halves = [
            with_color(&|at, amount| of_texel(at, amount).positive),
            with_color(&|at, amount| of_texel(at, amount).negative),
        ];
        halves.map(|half| continue_edges(&half))
    });
    let heights = dome_heights(&amounts);
    let normals = match (&sources.normals, &light) {
        (Some(map), _) => {
            let normals = with_color(&|at, amount| {
                let normal =
                    decode(map.file.texel(&grid, frame, at, size).truncate(), amount, map.alpha, map.space) * 2.0 - 1.0;
                if map.y_down { normal.with_y(-normal.y) } else { normal }
            });
            // Straight normals go on where the sheet is clear; multiplied ones are lost there.
            if map.alpha == AlphaMode::Premultiplied { continue_edges(&normals) } else { normals }
        }
        (None, Some([positive, negative])) => {
            let mut normals = positive.clone();
            normals.for_each(|at, texel| {
                let light = SixWay { positive: texel.truncate(), negative: negative.load(at.as_ivec2()).truncate() };
                *texel = ((light.positive - light.negative) * sources.strength).extend(texel.w);
            });
            normals
        }
        (None, None) => {
            let mut normals = Image::new(UVec2::splat(side), Vec4::ZERO);
            normals.for_each(|at, texel| {
                let at = at.as_ivec2();
                *texel = normal_of(&heights, at, sources.strength).extend(amounts.load(at));
            });
            normals
        }
    };
    let heat = sources.heat.map(|source| {
        let of_texel = |at: UVec2| match source {
            HeatSource::Channel(Channel { file, index }) => file.texel(&grid, frame, at, size)[index],
            HeatSource::Luminance(file) => {
                let [r, g, b, _] = file.texel(&grid, frame, at, size).to_array().map(linear_from_srgb);
                luminance(Vec3::new(r, g, b))
            }
        };
        map_pixels(UVec2::splat(side), |at| {
            saturate(positions(at).flatten().map(of_texel).sum::<f32>() / (taps * taps) as f32)
        })
    });
    let offset = match sources.depth {
        Some(DepthMap { file, white_is_near }) => {
            let sign = if white_is_near { 1.0 } else { -1.0 };
            let depth = with_color(&|at, _| file.texel(&grid, frame, at, size).truncate());
            map_pixels(UVec2::splat(side), |at| sign * (depth.load(at.as_ivec2()).x * 2.0 - 1.0))
        }
        None => heights,
    };
    (BuiltFrame { normals, light, heat, offset }, at_border)
}

/// Returns the motion to the next frame of the sheet, at the size of the detail map.
fn motion(sources: &Sources<'_>, layout: &OutputLayout, sprite: &Sprite, index: u32) -> Image<Vec2> {
    let side = detail_size(layout.side);
    let count = layout.frames.len() as u32;
    let ends = index + 1 == count && sources.playback == Playback::Once;
    if count < 2 || ends {
        return Image::new(UVec2::splat(side), Vec2::ZERO);
    }
    let Some(map) = sources.motion else { return optical_flow(sprite, index, None) };
    let frame = layout.frames[index as usize];
    // A texel of the detail map covers a square of the frame, in which vectors are averaged.
    let full = layout.full_side as f32;
    let margin = ((UVec2::splat(layout.full_side) - sources.size) / 2).as_vec2();
    let mut motion = Image::new(UVec2::splat(side), Vec2::ZERO);
    motion.for_each(|at, way| {
        const TAPS: u32 = 4;
        for tap in 0..TAPS * TAPS {
            let offset = (UVec2::new(tap % TAPS, tap / TAPS).as_vec2() + 0.5) / TAPS as f32;
            let position = ((at.as_vec2() + offset) / side as f32 * full - margin).as_ivec2();
            let position = position.clamp(IVec2::ZERO, sources.size.as_ivec2() - 1).as_uvec2();
            let code = map.file.texel(&sources.grid, frame, position, sources.size);
            *way += (code.truncate().truncate() - map.rest) * 2.0;
        }
        let vector = *way / (TAPS * TAPS) as f32;
        *way = map.axes.way(vector) * map.scale * layout.step as f32 * sources.size.as_vec2() / full;
    });
    motion
}

fn alpha_code(value: f32) -> u8 {
    (saturate(value) * 255.0).round() as u8
}

/// Encodes a normal of unit length; z is 0 or more, so that normals of overlapping sprites do not cancel.
fn encode_normal(texel: Vec4) -> Rgba<u8> {
    let normal = texel.truncate();
    let normal = normal.with_z(normal.z.max(0.0)).normalize_or(Vec3::Z);
    let [x, y, z] = normal.to_array().map(|axis| alpha_code(axis * 0.5 + 0.5));
    Rgba([x, y, z, alpha_code(texel.w)])
}
