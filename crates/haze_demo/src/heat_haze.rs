//! Hot air above flames, which bends light: what is behind it shimmers. On the CPU; `heat_haze.wgsl` has the same
//! functions for the GPU.

use glam::{IVec2, UVec3, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::curve::smoothstep_unit;
use haze_core::formula::depth::view_depth_from_ndc_depth;
use haze_core::formula::hash::{pcg3d, unit};
use haze_core::formula::saturate;
use haze_core::formula::view::pixel_from_ndc;
use haze_core::frame::{Light, View};

use super::scene::coefficients;

/// WGSL of the [`ImagePass`](super::image_pass::ImagePass). Its uniform is a [`HeatHaze`].
pub const HEAT_HAZE_SHADER: &str = include_str!("heat_haze.wgsl");

/// Maximum number of plumes: those of further fires are left out.
pub const MAX_PLUMES: usize = 8;
/// Height of a plume above the middle of its flames, in radii of the flames.
const HEIGHT: f32 = 4.0;
/// Cells of the noise over the height of the image.
const CELLS: f32 = 36.0;
/// Cells per second by which the noise rises, and changes.
const RISE: f64 = 5.0;
const CHANGE: f64 = 4.0;
/// The noise repeats after this many cells, so that it is as fine at any time.
const PERIOD: u32 = 4096;
/// Largest shift of a strength of 1, in cells; and in radii of a plume, for small ones.
const SHIFT_IN_CELLS: f32 = 0.6;
const SHIFT_IN_RADII: f32 = 0.3;

/// Hot air above a fire, as seen. `Plume` in heat_haze.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Plume {
    /// Middle of the flames, pixels.
    pub base: Vec2,
    /// From there to the top, pixels.
    pub axis: Vec2,
    /// Radius at the base, pixels. It is twice as large at the top.
    pub radius: f32,
    /// View depth of the flames, metres.
    pub depth: f32,
    /// Radius, metres.
    pub thickness: f32,
    /// Largest shift, pixels.
    pub shift: f32,
}

/// Hot air in an image. `HeatHaze` in heat_haze.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct HeatHaze {
    /// As for [`view_depth_from_ndc_depth`].
    pub depth_coefficients: Vec4,
    /// Cells by which the noise has risen, and changed, below `PERIOD`.
    pub phase: Vec2,
    /// Side of a cell, pixels.
    pub cell: f32,
    /// Number of plumes.
    pub count: u32,
    /// The first `count` are valid.
    pub plumes: [Plume; MAX_PLUMES],
}

impl HeatHaze {
    /// Hot air above fires. `fires`: their lights, which have the extent of the flames. `strength`: 0..=1. `time`: seconds.
    /// `None` if nothing is to be seen.
    pub fn new(view: &View, fires: &[Light], strength: f32, time: f64) -> Option<Self> {
        let cell = view.size.y as f32 / CELLS;
        let mut plumes = [Plume::default(); MAX_PLUMES];
        let mut count = 0;
        for plume in fires.iter().filter_map(|fire| plume(view, fire, strength, cell)).take(MAX_PLUMES) {
            plumes[count] = plume;
            count += 1;
        }
        let phase = |rate: f64| (time * rate).rem_euclid(f64::from(PERIOD)) as f32;
        (count > 0 && strength > 0.0).then(|| Self {
            depth_coefficients: coefficients(view),
            phase: Vec2::new(phase(RISE), phase(CHANGE)),
            cell,
            count: count as u32,
            plumes,
        })
    }

    /// Returns the image seen through the hot air. `depth`: depth buffer of the scene.
    pub fn distorted(&self, image: &Image<Vec4>, depth: &Image<f32>) -> Image<Vec4> {
        let view_depth =
            |at: Vec2| view_depth_from_ndc_depth(depth.load(at.floor().as_ivec2()), self.depth_coefficients);
        let mut distorted = Image::new(image.size, Vec4::W);
        distorted.for_each(|at, texel| {
            let pixel = at.as_vec2() + 0.5;
            *texel = image.load(at.as_ivec2());
            let shift = self.largest_shift(pixel, view_depth(pixel));
            if shift <= 0.0 {
                return;
            }
            let moved = pixel + self.direction(pixel) * shift;
            // Surfaces in front of the air are not seen through it.
            if self.largest_shift(pixel, view_depth(moved)) > 0.0 {
                *texel = bilinear(image, moved).extend(texel.w);
            }
        });
        distorted
    }

    /// Largest shift at a pixel whose surface has this view depth, pixels.
    fn largest_shift(&self, pixel: Vec2, view_depth: f32) -> f32 {
        let plumes = self.plumes.iter().take(self.count as usize);
        plumes.fold(0.0, |largest, plume| largest.max(plume.shift * plume.heat(pixel, view_depth)))
    }

    /// Direction of the shift at a pixel: two octaves of noise, each component mostly within -1 to 1.
    fn direction(&self, pixel: Vec2) -> Vec2 {
        let at = (pixel / self.cell).extend(0.0) + Vec3::new(0.0, self.phase.x, self.phase.y);
        noise(at, 0) + 0.5 * noise(at * Vec3::new(2.0, 2.0, 1.0), 1)
    }
}

/// Plume of a fire; `None` if it is behind the viewer.
fn plume(view: &View, fire: &Light, strength: f32, cell: f32) -> Option<Plume> {
    let clip_from_world = view.clip_from_view * view.view_from_world;
    let pixel = |position: Vec3| {
        let clip = clip_from_world * position.extend(1.0);
        (clip.w > 1.0e-3).then(|| (pixel_from_ndc(clip.xy() / clip.w, view.size.as_vec2()), clip.w))
    };
    let (base, depth) = pixel(fire.position)?;
    let (top, _) = pixel(fire.position + Vec3::Y * (HEIGHT * fire.radius))?;
    let radius = 0.5 * view.size.y as f32 * view.clip_from_view.y_axis.y.abs() * fire.radius / depth;
    let shift = strength * (SHIFT_IN_CELLS * cell).min(SHIFT_IN_RADII * radius);
    (shift > 0.0).then_some(Plume { base, axis: top - base, radius, depth, thickness: fire.radius, shift })
}

impl Plume {
    /// Heat at a pixel, 0 to 1. `view_depth`: of the surface there, metres; none in front of the flames.
    fn heat(&self, pixel: Vec2, view_depth: f32) -> f32 {
        let offset = pixel - self.base;
        let along = saturate(offset.dot(self.axis) / self.axis.dot(self.axis).max(1.0e-6));
        let aside = (offset - self.axis * along) / (self.radius * (1.0 + along));
        let inside = saturate(1.0 - aside.dot(aside));
        let behind = saturate((view_depth - self.depth) / self.thickness + 0.5);
        inside * inside * (1.0 - along) * behind
    }
}

/// Noise with two components within -1 to 1: smooth between random values at integers.
fn noise(at: Vec3, octave: u32) -> Vec2 {
    let cell = at.floor();
    let t = (at - cell).map(smoothstep_unit);
    let value = |x: i32, y: i32, z: i32| {
        // Negative cells, left of the image, wrap.
        let cell = (cell.as_ivec3() + glam::IVec3::new(x, y, z)).as_uvec3() & (PERIOD - 1);
        let random = pcg3d(cell + UVec3::new(0, 0, octave * PERIOD));
        Vec2::new(unit(random.x), unit(random.y)) * 2.0 - 1.0
    };
    let row = |y: i32, z: i32| value(0, y, z).lerp(value(1, y, z), t.x);
    let layer = |z: i32| row(0, z).lerp(row(1, z), t.y);
    layer(0).lerp(layer(1), t.z)
}

/// Color at a position of the image, pixels.
fn bilinear(image: &Image<Vec4>, position: Vec2) -> Vec3 {
    let corner = (position - 0.5).floor();
    let t = position - 0.5 - corner;
    let load = |x: i32, y: i32| image.load(corner.as_ivec2() + IVec2::new(x, y)).xyz();
    let row = |y: i32| load(0, y).lerp(load(1, y), t.x);
    row(0).lerp(row(1), t.y)
}
