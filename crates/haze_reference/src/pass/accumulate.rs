//! CPU version of `shaders/accumulate.wgsl`.

use glam::Vec4;
use haze_core::assets::image::Image;
use haze_core::formula::normal::accumulation_from_normal;
use haze_core::settings::{AccumulationFormat, BlendOrder, RenderPath};
use haze_core::view_setup::{AttachmentRole, AttachmentSet, TexelGrid};

use crate::accumulated::AccumulatedTextures;
use crate::blend_unit::{premultiplied_over, quantise, weighted_sum};
use crate::sprite::{SpriteFragment, SpriteSetup};
use crate::visible_system::VisibleSystem;

impl VisibleSystem<'_> {
    /// Textures of the accumulation target, by role. A blend unit rounds to the target's format at every layer; the path
    /// `tiled` sums in f32 and rounds once. `auto` rounds as `raster` does.
    pub fn accumulate(&self, reduced_depth: &Image<f32>) -> AccumulatedTextures {
        let set = AttachmentSet::of(&self.settings);
        let rounds_once = self.settings.path == RenderPath::Tiled;
        AttachmentRole::ALL.map(|role| {
            let format = self.format(role);
            let blended = |fragment, sprite: &SpriteSetup, texel| {
                let sum = self.blended(role, fragment, sprite, texel);
                if rounds_once { sum } else { quantise(format, sum) }
            };
            set.contains(role).then(|| {
                let mut target = self.blend(reduced_depth, blended);
                if rounds_once {
                    target.for_each(|_, texel| *texel = quantise(format, *texel));
                }
                target
            })
        })
    }

    /// Counted layers in the first texture, and no others.
    pub fn overdraw(&self, reduced_depth: &Image<f32>) -> AccumulatedTextures {
        let format = self.settings.accumulate.format;
        let counted = |_, _: &SpriteSetup, texel| quantise(format, texel + Vec4::splat(1.0 / 255.0));
        AttachmentRole::ALL.map(|role| {
            let is_counted = AttachmentSet::NORMAL_AND_AMOUNT.contains(role);
            is_counted.then(|| self.blend(reduced_depth, counted))
        })
    }

    fn format(&self, role: AttachmentRole) -> AccumulationFormat {
        match role {
            AttachmentRole::NormalAndAmount | AttachmentRole::SixWay => self.settings.accumulate.format,
            _ => AccumulationFormat::Rgba16Float,
        }
    }

    /// Texel of the texture with this role after one more fragment, before rounding.
    fn blended(&self, role: AttachmentRole, fragment: SpriteFragment, sprite: &SpriteSetup, texel: Vec4) -> Vec4 {
        let accumulate = &self.settings.accumulate;
        let SpriteFragment { normal, six_way, amount, .. } = fragment;
        let weight = sprite.weight;
        let weighted = amount * weight;
        let source = match role {
            AttachmentRole::NormalAndAmount if self.settings.is_six_way() => {
                (six_way.positive * weighted).extend(amount)
            }
            AttachmentRole::NormalAndAmount => accumulation_from_normal(accumulate.encoding, normal, amount, weight),
            AttachmentRole::SixWay => (six_way.negative * weighted).extend(weighted),
            AttachmentRole::Weights => Vec4::splat(weighted),
            AttachmentRole::OpticalDepths => (sprite.optical_depths * weighted).extend(weighted),
            AttachmentRole::Depth => {
                let moments = self.moments_of_sprite(sprite.view_depth, sprite.radius) * weighted;
                Vec4::new(moments.x, moments.y, 0.0, weighted)
            }
            AttachmentRole::Heat => {
                let heat = self.fragment_heat(&fragment, sprite.heat);
                Vec4::new(heat * weighted, heat * heat * weighted, 0.0, weighted)
            }
            AttachmentRole::Tint => (sprite.tint * weighted).extend(weighted),
        };
        match (self.settings.order(), role) {
            (BlendOrder::Sorted, _) => premultiplied_over(source, texel),
            (BlendOrder::Weighted, AttachmentRole::NormalAndAmount) => weighted_sum(source, texel),
            (BlendOrder::Weighted, _) => source + texel,
        }
    }

    /// Blends `f(fragment, sprite, texel)` of every fragment into a target.
    fn blend(
        &self,
        reduced_depth: &Image<f32>,
        f: impl Fn(SpriteFragment, &SpriteSetup, Vec4) -> Vec4 + Sync,
    ) -> Image<Vec4> {
        let mut target = Image::new(self.setup.rect.size, Vec4::ZERO);
        let origin = self.setup.rect.origin.as_vec2();
        let scene = |at| reduced_depth.load(at);
        target.for_bands(|first_row, band| {
            let grid = TexelGrid { origin, scale: self.setup.rect.scale as f32, size: self.setup.rect.size };
            self.for_fragments(&grid, first_row, band, scene, |_, sprite, fragment, texel: &mut Vec4| {
                *texel = f(fragment, sprite, *texel);
            });
        });
        target
    }
}
