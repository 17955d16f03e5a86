//! A system's finished target, read at full resolution. `shaders/lib/accumulated.wgsl`.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};

use super::draw::Draw;
use crate::assets::picture::Picture;
use crate::formula::texture::Texture2d;
use crate::formula::upsample::{guided_weights, is_smooth, upsample_weights};
use crate::settings::Upsample;

/// A system's finished target.
pub struct Accumulated<'a> {
    pub draw: &'a Draw<'a>,
    pub baked: Vec<Picture<Vec3>>,
    pub reduced_depth: Picture<f32>,
    pub accumulation: Picture<Vec4>,
    /// What the weights of the normals sum to, where that is kept.
    pub weight_sum: Option<Picture<Vec4>>,
}

/// The texels that a pixel is made of.
pub struct Footprint {
    /// Along each side: 0 outside the part of the view that the target covers.
    side: i32,
    first: IVec2,
    /// A row in each vector.
    weights: [Vec4; 4],
}

impl Texture2d for Picture<Vec3> {
    fn dimensions(&self) -> UVec2 {
        self.size
    }

    fn load(&self, at: UVec2) -> Vec4 {
        self.texels[(at.y * self.size.x + at.x) as usize].extend(1.0)
    }
}

impl Accumulated<'_> {
    /// `footprint()` in accumulated.wgsl.
    pub fn footprint(&self, pixel: Vec2) -> Footprint {
        let system = &self.draw.system;
        let texel = pixel / system.scale - system.target_origin;
        if texel.cmplt(Vec2::ZERO).any() || texel.cmpge(system.target_size).any() {
            return Footprint { side: 0, first: IVec2::ZERO, weights: [Vec4::ZERO; 4] };
        }
        if system.scale < 1.5 {
            return Footprint { side: 1, first: texel.as_ivec2(), weights: [Vec4::X; 4] };
        }
        let upsample = self.draw.settings.accumulate.upsample;
        let corner = texel - 0.5;
        let base = corner.floor().as_ivec2();
        let fraction = corner - corner.floor();
        let at = |x, y| self.reduced_depth.load(base + IVec2::new(x, y));
        let (depths, depth) = match upsample {
            Upsample::Bilinear => (Vec4::ZERO, 0.0),
            _ => {
                let depth = self.draw.scene_view_depth(pixel.as_ivec2()).min(system.depth_limit);
                (Vec4::new(at(0, 0), at(1, 0), at(0, 1), at(1, 1)), depth)
            }
        };
        let fade = 1.0 / system.fade_scale;
        if upsample == Upsample::Guided && !is_smooth(depths, depth, fade) {
            let around = [-1, 0, 1, 2].map(|y| Vec4::new(at(-1, y), at(0, y), at(1, y), at(2, y)));
            let weights = guided_weights(fraction, &around, depth, fade);
            return Footprint { side: 4, first: base - 1, weights };
        }
        let weights = upsample_weights(upsample, fraction, depths, depth);
        let rows = [Vec4::new(weights.x, weights.y, 0.0, 0.0), Vec4::new(weights.z, weights.w, 0.0, 0.0)];
        Footprint { side: 2, first: base, weights: [rows[0], rows[1], Vec4::ZERO, Vec4::ZERO] }
    }
}

/// `sample_target()` in accumulated.wgsl.
pub fn sample_target(target: &Picture<Vec4>, at: &Footprint) -> Vec4 {
    let (mut sum, mut low, mut high) = (Vec4::ZERO, Vec4::INFINITY, Vec4::NEG_INFINITY);
    for (y, weights) in (0..at.side).zip(&at.weights) {
        for (x, weight) in (0..at.side).zip(weights.to_array()) {
            let value = target.load(at.first + IVec2::new(x, y));
            sum += value * weight;
            (low, high) = (low.min(value), high.max(value));
        }
    }
    if at.side == 4 { sum.clamp(low, high) } else { sum }
}
