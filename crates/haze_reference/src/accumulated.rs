//! Finished target of a system, read at full resolution. WGSL: `shaders/lib/accumulated.wgsl`.

use glam::{IVec2, Vec2, Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::upsample::{
    GuidedFit, add_texel, bilinear_suffices, fitted_value, guided_weight, upsample_weights,
};
use haze_core::settings::Upsample;
use haze_core::view_setup::AttachmentRole;

use super::visible_system::VisibleSystem;

/// Textures of the accumulation target, indexed by role; `None` for those that the system does not have.
pub type AccumulatedTextures = [Option<Image<Vec4>>; AttachmentRole::ALL.len()];

/// Values of a texel, indexed by role; 0 for textures that the system does not have.
pub type Attachments = [Vec4; AttachmentRole::ALL.len()];

/// Smoke lit once per texel.
pub struct LitTarget {
    /// Light times amount, and amount.
    pub light: Image<Vec4>,
    /// Change of `light` with depth: output of depth_slopes.
    pub slopes: Image<Vec4>,
}

/// Finished target of a system.
pub struct AccumulatedTarget<'a> {
    /// System that was accumulated.
    pub visible: &'a VisibleSystem<'a>,
    /// Baked diffuse light: the faces of a cubemap, one motif, or empty.
    pub baked: &'a [Image<Vec3>],
    /// View depth at the resolution of the target, metres.
    pub reduced_depth: &'a Image<f32>,
    /// Textures of the accumulation target, by role.
    pub textures: &'a AccumulatedTextures,
    /// True if the smoke is lit once per texel.
    pub is_lit: bool,
    /// Outputs of light_target and depth_slopes. `None` if texels are lit as they are read.
    pub lit: Option<LitTarget>,
}

impl AccumulatedTarget<'_> {
    /// Values by role. `accumulated`: value of the first texture. `read` reads one of the others.
    pub fn attachments(&self, accumulated: Vec4, read: impl Fn(&Image<Vec4>) -> Vec4) -> Attachments {
        AttachmentRole::ALL.map(|role| match (role, &self.textures[role as usize]) {
            (AttachmentRole::NormalAndAmount, _) => accumulated,
            (_, Some(texture)) => read(texture),
            (_, None) => Vec4::ZERO,
        })
    }

    /// Samples the first texture.
    pub fn sample_accumulated(&self, pixel: Vec2) -> Vec4 {
        self.first_texture().map_or(Vec4::ZERO, |texture| self.sample_target(texture, pixel))
    }

    /// Normal and amount. Every target has this texture.
    pub fn first_texture(&self) -> Option<&Image<Vec4>> {
        self.textures[AttachmentRole::NormalAndAmount as usize].as_ref()
    }

    /// Samples a texture of the accumulation target. `sample_target()` in accumulated.wgsl.
    pub fn sample_target(&self, target: &Image<Vec4>, pixel: Vec2) -> Vec4 {
        self.sample_texels(|at| target.load(at), pixel)
    }

    /// Depth of a texel that guides the upsampling. Everything behind the smoke counts as one depth.
    pub fn guide(&self, texel: IVec2) -> f32 {
        self.reduced_depth.load(texel).min(self.visible.system.smoke_depth_limit)
    }

    /// As [`sample_target`](Self::sample_target), of a texture that is a function.
    pub fn sample_texels(&self, texel_at: impl Fn(IVec2) -> Vec4, pixel: Vec2) -> Vec4 {
        let system = &self.visible.system;
        let texel = pixel / system.scale as f32 - system.target_origin;
        if texel.cmplt(Vec2::ZERO).any() || texel.cmpge(system.target_size).any() {
            return Vec4::ZERO;
        }
        if system.scale == 1 {
            return texel_at(texel.as_ivec2());
        }
        let upsample = self.visible.settings.accumulate.upsample;
        let corner = texel - 0.5;
        let base = corner.floor().as_ivec2();
        let fraction = corner - corner.floor();
        let taps = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|offset| base + offset);
        let (depths, depth) = match upsample {
            Upsample::Bilinear => (Vec4::ZERO, 0.0),
            _ => {
                let depth = self.visible.scene_view_depth(pixel.as_ivec2()).min(system.smoke_depth_limit);
                (Vec4::from(taps.map(|tap| self.guide(tap))), depth)
            }
        };
        let fade = 1.0 / system.fade_scale;
        if upsample != Upsample::Guided || bilinear_suffices(depths, depth, fade) {
            let weights = upsample_weights(upsample, fraction, depths, depth);
            return taps.iter().zip(weights.to_array()).map(|(&tap, weight)| texel_at(tap) * weight).sum();
        }
        let fit = (0..16).fold(GuidedFit::default(), |fit, i| {
            let offset = IVec2::new(i % 4, i / 4) - 1;
            let at = base + offset;
            let position = (offset.as_vec2() - fraction).extend(self.guide(at) - depth);
            add_texel(&fit, position, guided_weight(position, depth), texel_at(at))
        });
        fitted_value(&fit, fade)
    }
}
