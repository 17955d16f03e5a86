//! One baked frame of a sprite, and the ray accumulator that produces its texels.

use glam::{UVec2, Vec2, Vec3};
use image::Rgba;

use haze_core::assets::image::Image;
use haze_core::formula::saturate;

/// One baked frame of a sprite.
#[derive(Clone, Debug)]
pub struct BakedFrame {
    /// rgb = normal / 2 + 1/2, a = amount.
    pub image: Image<Rgba<u8>>,
    /// Offset of the visible surface towards the viewer, -1..1 half sides.
    pub offset: Image<f32>,
    /// Means of three more numbers of the voxels over what is visible.
    pub carried: Image<Vec3>,
}

/// One texel of a frame, in the order of [`BakedFrame`]'s images.
#[derive(Clone, Copy)]
pub(super) struct MarchedTexel {
    pub texel: Rgba<u8>,
    pub offset: f32,
    pub carried: Vec3,
}

impl BakedFrame {
    pub(super) fn new(size: u32, texels: &[MarchedTexel]) -> Self {
        let size = UVec2::splat(size);
        Self {
            image: Image { size, texels: texels.iter().map(|marched| marched.texel).collect() },
            offset: Image { size, texels: texels.iter().map(|marched| marched.offset).collect() },
            carried: Image { size, texels: texels.iter().map(|marched| marched.carried).collect() },
        }
    }
}

/// Accumulates normal, offset and transmittance along a ray, front to back.
#[derive(Clone, Copy)]
pub(super) struct RayAccumulator {
    pub transmittance: f32,
    normal: Vec3,
    offset: f32,
    carried: Vec3,
}

impl RayAccumulator {
    pub fn new() -> Self {
        Self { transmittance: 1.0, normal: Vec3::ZERO, offset: 0.0, carried: Vec3::ZERO }
    }

    /// True if anything further along the ray is invisible.
    pub fn is_opaque(&self) -> bool {
        self.transmittance < 1.0 / 512.0
    }

    pub fn accumulate(&mut self, amount: f32, normal: Vec3, offset: f32, carried: Vec3) {
        self.normal += normal * (self.transmittance * amount);
        self.offset += offset * self.transmittance * amount;
        self.carried += carried * (self.transmittance * amount);
        self.transmittance *= 1.0 - amount;
    }

    /// Returns the texel, and its visible offset towards the viewer in half sides. `position` is the texel's position,
    /// -1..1.
    pub fn texel(&self, at: UVec2, size: u32, position: Vec2) -> MarchedTexel {
        let border = at.min_element() == 0 || at.max_element() == size - 1;
        let amount = if border { 0.0 } else { 1.0 - self.transmittance };
        // Clear texels get an outward normal, since texture filters blend them in at the edge.
        let outwards = position.extend(0.5);
        let encoded = self.normal.normalize_or(outwards.normalize()) * 0.5 + 0.5;
        let channel = |value: f32| (saturate(value) * 255.0).round() as u8;
        let texel = Rgba([channel(encoded.x), channel(encoded.y), channel(encoded.z), channel(amount)]);
        let visible = (1.0 - self.transmittance).max(1.0e-6);
        MarchedTexel { texel, offset: self.offset / visible, carried: self.carried / visible }
    }
}
