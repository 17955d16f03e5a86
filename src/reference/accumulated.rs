//! A system's finished target, read at full resolution. `shaders/lib/accumulated.wgsl`.

use glam::{IVec2, Vec2, Vec3, Vec4};

use super::draw::Draw;
use crate::assets::picture::Picture;
use crate::formula::upsample::upsample_weights;
use crate::settings::Upsample;

/// A system's finished target.
pub struct Accumulated<'a> {
    pub draw: &'a Draw<'a>,
    pub baked: Vec<Picture<Vec3>>,
    pub reduced_depth: Picture<f32>,
    pub accumulation: Picture<Vec4>,
}

impl Accumulated<'_> {
    /// `sample_accumulation()` in accumulated.wgsl.
    pub fn sample_accumulation(&self, pixel: Vec2) -> Vec4 {
        let system = &self.draw.system;
        let texel = pixel / system.scale - system.target_origin;
        if texel.cmplt(Vec2::ZERO).any() || texel.cmpge(system.target_size).any() {
            return Vec4::ZERO;
        }
        if system.scale < 1.5 {
            return self.accumulation.load(texel.as_ivec2());
        }
        let upsample = self.draw.settings.accumulate.upsample;
        let corner = texel - 0.5;
        let base = corner.floor();
        let offsets = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE];
        let taps = offsets.map(|offset| base.as_ivec2() + offset);
        let (depths, depth) = match upsample {
            Upsample::Bilinear => (Vec4::ZERO, 0.0),
            _ => {
                let depth = self.draw.scene_view_depth(pixel.as_ivec2()).min(system.depth_limit);
                (Vec4::from(taps.map(|tap| self.reduced_depth.load(tap))), depth)
            }
        };
        let weights = upsample_weights(upsample, corner - base, depths, depth);
        taps.iter().zip(weights.to_array()).map(|(&tap, weight)| self.accumulation.load(tap) * weight).sum()
    }
}
