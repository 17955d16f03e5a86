//! Numbers that programs need to show a flipbook.

use glam::UVec2;
use haze_author::sprite::six_way::Packing;

use super::options::FlipbookOptions;
use super::sheets::{COLOR, EMISSION, MOTION, NORMALS, SIX_WAY};
use crate::engine::Engine;
use crate::image_format::{Alpha, Emission};

/// Version of `flipbook.json`. It grows when a key changes its meaning; keys may be added without.
pub const VERSION: u32 = 1;

/// Numbers of a flipbook, for programs: `flipbook.json`. `docs/export.md` describes the keys.
#[derive(serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub struct FlipbookNumbers {
    /// [`VERSION`].
    pub version: u32,
    /// Engine whose conventions the files follow.
    pub engine: Engine,
    /// Pixels.
    pub frame_width: u32,
    /// Pixels.
    pub frame_height: u32,
    pub columns: u32,
    pub rows: u32,
    pub frames: u32,
    /// Frames per second.
    pub rate: f32,
    /// True if the first frame follows the last.
    #[serde(rename = "loop")]
    pub is_loop: bool,
    /// Color of `color.png`.
    pub alpha: Alpha,
    /// Light of fire in `color.png`; absent without `emission.png`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<Emission>,
    /// Direction of a normal whose green is full.
    pub normal_green: Direction,
    /// Direction of a way whose green is full.
    pub motion_green: Direction,
    /// Way that full red or green stands for, as a fraction of a frame's width or height.
    pub motion_scale: f32,
    /// Sides in the six-way maps; absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub six_way_packing: Option<PackingName>,
    /// Intensity of a light under which the six-way maps have the brightness of the preset's smoke; absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub six_way_intensity: Option<f32>,
    /// Luminance of fire that full alpha of `six_way_2.png` stands for, in the unit of `six_way_intensity`; absent without fire, and
    /// where that alpha is opacity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub six_way_emission: Option<f32>,
    /// Images, `color.png` first.
    pub files: Vec<SheetFile>,
}

/// Image of a flipbook.
#[derive(serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub struct SheetFile {
    /// Name of the file, beside `flipbook.json`.
    pub name: String,
    pub color_space: ColorSpace,
    pub alpha: SheetAlpha,
}

/// Vertical direction on the screen.
#[derive(Clone, Copy, serde::Serialize)]
#[cfg_attr(test, derive(Debug, PartialEq, serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    Up,
    Down,
}

/// Order of the sides: see [`Packing`].
#[derive(Clone, Copy, serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum PackingName {
    Unity,
    RltBbf,
}

/// Codes of an image.
#[derive(Clone, Copy, serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum ColorSpace {
    Srgb,
    Linear,
}

/// Alpha of an image.
#[derive(Clone, Copy, serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum SheetAlpha {
    /// No alpha channel.
    None,
    /// Opacity; rgb is not multiplied by it.
    Straight,
    /// Opacity; rgb is multiplied by it.
    Premultiplied,
    /// Luminance of fire.
    Emission,
}

/// Numbers that are known when all frames are.
pub struct Scales {
    pub motion: f32,
    pub six_way_intensity: Option<f32>,
    pub six_way_emission: Option<f32>,
}

impl FlipbookNumbers {
    /// `images`: names of the files. `alpha`: of the color.
    pub fn new<'a>(
        options: &FlipbookOptions,
        alpha: Alpha,
        frame: UVec2,
        frames: u32,
        rate: f32,
        scales: &Scales,
        images: impl Iterator<Item = &'a str>,
    ) -> Self {
        let engine = options.engine;
        let packing = engine.six_way_packing();
        let files: Vec<_> = images.map(|name| SheetFile::new(name, alpha, packing)).collect();
        let has = |name: &str| files.iter().any(|file| file.name == name);
        let direction = |is_up| if is_up { Direction::Up } else { Direction::Down };
        let packing = match packing {
            Packing::Unity => PackingName::Unity,
            Packing::RltBbf => PackingName::RltBbf,
        };
        Self {
            version: VERSION,
            engine,
            frame_width: frame.x,
            frame_height: frame.y,
            columns: options.cells.y,
            rows: options.cells.x,
            frames,
            rate,
            is_loop: options.loop_fade > 0,
            alpha,
            emission: has(EMISSION).then_some(options.emission),
            normal_green: direction(engine.normals_point_up()),
            motion_green: direction(!engine.first_row_is_at_the_top()),
            motion_scale: scales.motion,
            six_way_packing: has(SIX_WAY[0]).then_some(packing),
            six_way_intensity: scales.six_way_intensity,
            six_way_emission: scales.six_way_emission,
            files,
        }
    }
}

impl SheetFile {
    fn new(name: &str, color: Alpha, packing: Packing) -> Self {
        let (color_space, alpha) = match name {
            COLOR => match color {
                Alpha::Straight => (ColorSpace::Srgb, SheetAlpha::Straight),
                Alpha::Premultiplied => (ColorSpace::Srgb, SheetAlpha::Premultiplied),
            },
            EMISSION => (ColorSpace::Srgb, SheetAlpha::None),
            NORMALS | MOTION => (ColorSpace::Linear, SheetAlpha::None),
            name if name == SIX_WAY[1] && packing.has_emission() => (ColorSpace::Linear, SheetAlpha::Emission),
            _ => (ColorSpace::Linear, SheetAlpha::Straight),
        };
        Self { name: name.to_owned(), color_space, alpha }
    }
}
