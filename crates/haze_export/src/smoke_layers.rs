//! Layers of the smoke of a shot, without its scene: light, amount, normals, depth, motion, fire, six-way light.
//!
//! Layers are multiplied by the smoke's opacity, which is in alpha: such images can be mixed, as the frames of a loop are.

use glam::{Vec3, Vec4, Vec4Swizzles};
use haze::{Light, LightKind};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::formula::color::luminance;
use haze_core::settings::DebugView;
use haze_demo::particle_scalar::ParticleScalar;
use haze_demo::shot::Shot;

use crate::backend::Backend;
use crate::smoke_alone::{before_two_skies, separated};

/// Opacity below which half floats hold too few bits of a layer.
const LEAST_OPACITY: f32 = 1.0e-3;

/// Renderer of the layers of a shot.
pub struct SmokeLayers<'a> {
    backend: &'a Backend,
    shot: &'a Shot,
    /// The shot before a black sky.
    dark: Shot,
    /// Light and opacity: linear, premultiplied, not exposed.
    pub light: Image<Vec4>,
}

impl<'a> SmokeLayers<'a> {
    /// Renders light and opacity.
    pub async fn new(backend: &'a Backend, shot: &'a Shot) -> Result<Self, Error> {
        let [dark, bright] = before_two_skies(shot);
        let light = separated([&backend.render_async(&dark).await?, &backend.render_async(&bright).await?]);
        Ok(Self { backend, shot, dark, light })
    }

    /// Accumulated amount, in x.
    pub async fn amount(&self) -> Result<Image<Vec4>, Error> {
        self.backend.render_async(&Shot { debug_view: DebugView::Amount, ..self.dark.clone() }).await
    }

    /// Mean normal in view space, times opacity.
    pub async fn normals(&self) -> Result<Image<Vec4>, Error> {
        let view = Shot { debug_view: DebugView::Normals, ..self.dark.clone() };
        // The view has n/2 + 1/2 times opacity.
        Ok(self.with_opacity(&self.backend.render_async(&view).await?, |texel, opacity| texel * 2.0 - opacity))
    }

    /// Light of fire alone, times opacity.
    pub async fn fire(&self) -> Result<Image<Vec4>, Error> {
        let fire = self.backend.render_async(&self.dark.without_light()).await?;
        Ok(self.with_opacity(&fire, |texel, _| texel))
    }

    /// Mean of a scalar of the particles, not multiplied by opacity; 0 without smoke.
    pub async fn scalar(&self, scalar: ParticleScalar) -> Result<Image<f32>, Error> {
        let Some((shot, shown)) = self.shot.showing(scalar) else {
            return Ok(Image::new(self.shot.size, 0.0));
        };
        let values = shown.values(&self.backend.render_async(&shot).await?);
        let texels = values.texels.into_iter().map(Option::unwrap_or_default).collect();
        Ok(Image { size: values.size, texels })
    }

    /// Mean way in so many seconds, times opacity: x to the right, y up, pixels.
    pub async fn motion(&self, seconds: f32) -> Result<Image<Vec4>, Error> {
        let right = self.scalar(ParticleScalar::MotionRight(seconds)).await?;
        let up = self.scalar(ParticleScalar::MotionUp(seconds)).await?;
        let mut motion = self.light.clone();
        let ways = right.texels.iter().zip(&up.texels);
        for (texel, (right, up)) in motion.texels.iter_mut().zip(ways) {
            *texel = (Vec3::new(*right, *up, 0.0) * texel.w).extend(texel.w);
        }
        Ok(motion)
    }

    /// Light of the smoke under lights from right, top and front, and from left, bottom and back, times opacity: luminances
    /// in x, y and z. The lights are directional and have the intensity 1; the preset's own light is left out.
    pub async fn six_way(&self) -> Result<[Image<Vec4>; 2], Error> {
        let world_from_view = self.shot.preset.camera.view(self.shot.size).view_from_world.inverse();
        let mut sides = [self.light.clone(), self.light.clone()];
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            for (axis, from) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
                let direction = world_from_view.transform_vector3(-sign * from);
                let light =
                    Light { kind: LightKind::Directional, direction, specular_scatter: 0.0, ..Light::default() };
                let lit = self.backend.render_async(&self.under(light)).await?;
                for (texel, lit) in side.texels.iter_mut().zip(&lit.texels) {
                    texel[axis] = luminance(lit.xyz());
                }
            }
        }
        Ok(sides)
    }

    /// The shot under one light, with the diffuse light of its settings alone.
    fn under(&self, light: Light) -> Shot {
        let mut shot = self.dark.without_light();
        shot.preset.lights = vec![light];
        for (system, own) in shot.preset.systems.iter_mut().zip(&self.dark.preset.systems) {
            system.settings.diffuse.intensity = own.settings.diffuse.intensity;
            system.settings.shadow.strength = own.settings.shadow.strength;
            system.settings.fire.intensity = 0.0;
        }
        shot
    }

    fn with_opacity(&self, image: &Image<Vec4>, change: impl Fn(Vec3, f32) -> Vec3) -> Image<Vec4> {
        let pairs = image.texels.iter().zip(&self.light.texels);
        let texels = pairs.map(|(texel, light)| match light.w > LEAST_OPACITY {
            true => change(texel.xyz(), light.w).extend(light.w),
            false => Vec4::ZERO,
        });
        Image { size: image.size, texels: texels.collect() }
    }
}
