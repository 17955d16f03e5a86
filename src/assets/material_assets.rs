//! Decoded images of a particle system: ramps, sprite flipbook, detail map, six-way maps and noise.

use std::sync::Arc;

use glam::Vec3;

use super::noise::NoiseVolume;
use super::ramp::Ramp;
use super::ramp_steps::RampSteps;
use super::sprite::Sprite;
use super::sprite::alpha_bounds::AlphaBounds;
use super::sprite::sprite_density::SpriteDensity;
use super::sprite::sprite_detail::SpriteDetail;
use crate::error::FieldError;
use crate::settings::Settings;

/// Decoded images of a particle system. The reference renderer samples these; the GPU renderer uploads them.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialAssets {
    /// Flipbook of normal maps.
    pub sprite: Sprite,
    /// Depth and motion of the sprite, one per frame: see `haze_author::sprite::detail`. Required
    /// by depth sprites and `sprite.motion`.
    pub detail: Option<Sprite>,
    /// Six-way light maps of the sprite, for [`Lighting::SixWay`](crate::settings::Lighting::SixWay): twice as many
    /// frames as the sprite, of the same size. See `haze_author::sprite::six_way`.
    pub six_way: Option<Sprite>,
    /// Density noise of volumetric sprites.
    pub noise: NoiseVolume,
    /// Diffuse light. u (across) = dot(n, l)/2 + 1/2: 0 faces away from the light, 1 faces it. v (up) = amount times
    /// `boost`.
    pub diffuse_ramp: Ramp,
    /// Diffuse light from behind, with the same axes, for [`Backlight::Ramp`](crate::settings::Backlight::Ramp).
    pub backlight_ramp: Ramp,
    /// Light that has come through smoke. u = 1 − 2^(−optical depth): 0 in full light. v: 0 for a light on the viewer's
    /// side, 1 for a light behind the smoke.
    pub shadow_ramp: Ramp,
    /// Soft scatter by amount, for [`SoftScatterMode::Ramp`](crate::settings::SoftScatterMode::Ramp). One row.
    pub soft_scatter_ramp: Ramp,
    /// Specular scatter by distance² (across) and amount (up).
    pub specular_ramp: Ramp,
    /// Painted image of a lit sphere, for [`DiffuseMode::PaintedMotif`](crate::settings::DiffuseMode::PaintedMotif).
    pub motif: Ramp,
    /// Particle color by age; forward path only. One row. (MS)
    pub age_ramp: Ramp,
    /// Heat by age, for [`Settings::burns`](crate::settings::Settings::burns): black is cold, white hottest. One row.
    pub heat_ramp: Ramp,
    /// Light of hot smoke, by heat (across) and by its amount times `boost` (up). Black at heat 0.
    pub fire_ramp: Ramp,
    /// Coverage by amount times `boost`, for [`CoverageMode::Ramp`](crate::settings::CoverageMode::Ramp): black is
    /// transparent, white opaque. One row.
    pub coverage_ramp: Ramp,
}

impl MaterialAssets {
    /// True if both share the memory of every image. Cheap, unlike `==`.
    pub fn shares_memory(&self, other: &Self) -> bool {
        let sprite = |a: &Option<Sprite>, b: &Option<Sprite>| match (a, b) {
            (Some(a), Some(b)) => a.shares_memory(b),
            (None, None) => true,
            _ => false,
        };
        self.sprite.shares_memory(&other.sprite)
            && sprite(&self.detail, &other.detail)
            && sprite(&self.six_way, &other.six_way)
            && self.noise.shares_memory(&other.noise)
            && self.ramps().iter().zip(other.ramps()).all(|(a, b)| a.shares_memory(b))
    }

    fn ramps(&self) -> [&Ramp; 10] {
        [
            &self.diffuse_ramp,
            &self.soft_scatter_ramp,
            &self.specular_ramp,
            &self.motif,
            &self.age_ramp,
            &self.coverage_ramp,
            &self.backlight_ramp,
            &self.shadow_ramp,
            &self.heat_ramp,
            &self.fire_ramp,
        ]
    }

    /// Sizes and frame counts, as validation and the view setup need them.
    pub fn info(&self) -> MaterialInfo {
        MaterialInfo {
            sprite_size: self.sprite.size() as f32,
            alpha_bounds: Arc::new(self.sprite.alpha_bounds(self.six_way.as_ref())),
            frame_count: self.sprite.frame_count() as f32,
            detail: self.detail.as_ref().map(|detail| DetailInfo {
                frame_count: detail.frame_count(),
                lod: (self.sprite.size() as f32 / detail.size() as f32).log2(),
            }),
            noise_size: self.noise.size() as f32,
            six_way: self.six_way.as_ref().map(|maps| (maps.size(), maps.frame_count())),
            density: *self.sprite.density(),
            sprite_detail: *self.sprite.detail(),
            zonal: self.diffuse_ramp.zonal(),
            backlight_zonal: self.backlight_ramp.zonal(),
            ramp_steps: RampSteps {
                diffuse: self.diffuse_ramp.largest_step(),
                backlight: self.backlight_ramp.largest_step(),
                soft_scatter: self.soft_scatter_ramp.largest_step(),
                shadow: self.shadow_ramp.largest_step(),
                motif: self.motif.largest_step(),
                fire: self.fire_ramp.largest_step(),
            },
        }
    }
}

/// Properties of a material's images that preparing a frame needs.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MaterialInfo {
    /// Side of one frame of the sprite, texels.
    pub sprite_size: f32,
    /// Frames of the sprite, followed by those of the six-way maps.
    pub alpha_bounds: Arc<AlphaBounds>,
    /// Frames of the sprite.
    pub frame_count: f32,
    /// The detail map, if there is one.
    pub detail: Option<DetailInfo>,
    /// Texels of the noise along each side.
    pub noise_size: f32,
    /// Frame size in texels and frame count of the six-way maps.
    pub six_way: Option<(u32, u32)>,
    /// Detail of the sprite that coarse targets lose.
    pub(crate) sprite_detail: SpriteDetail,
    /// Density of the sprite, for shadow.
    pub(crate) density: SpriteDensity,
    /// Zonal harmonic coefficients of the diffuse ramp.
    pub zonal: [Vec3; 3],
    /// Zonal harmonic coefficients of the backlight ramp.
    pub backlight_zonal: [Vec3; 3],
    /// Steps of the ramps.
    pub ramp_steps: RampSteps,
}

/// Properties of a detail map that preparing a frame needs.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct DetailInfo {
    /// Frames of the detail map.
    pub frame_count: u32,
    /// log2 of the sprite's size over the detail map's size.
    pub lod: f32,
}

impl MaterialInfo {
    /// Returns an error if the settings need an image that the material of system `index` lacks.
    pub fn validate(&self, index: usize, settings: &Settings) -> Result<(), FieldError> {
        let field = |name: &str| format!("systems[{index}].{name}");
        let frames = self.frame_count as u32;
        match self.six_way {
            None if settings.is_six_way() => {
                let expected =
                    "\"normals\", or six-way maps in the material, as `haze sprite bake --six-way` makes them";
                return Err(FieldError::new(field("settings.lighting"), "\"six_way\"", expected));
            }
            Some((size, count)) if (size, count) != (self.sprite_size as u32, 2 * frames) => {
                let problem = format!("the number of frames is {count}, each of {size} texels");
                let expected = format!("{}, two for each of the sprite, of {} texels", 2 * frames, self.sprite_size);
                return Err(FieldError::from_problem(field("material.six_way"), problem, expected));
            }
            _ => {}
        }
        let Some(detail) = &self.detail else {
            let expected = "another value, or a material with a detail map, as `haze sprite bake` makes it";
            if settings.technique.is_depth_sprite() {
                let value = format!("{:?}", settings.technique.name());
                return Err(FieldError::new(field("settings.technique"), value, expected));
            }
            if settings.sprite.motion > 0.0 {
                return Err(FieldError::new(field("settings.sprite.motion"), settings.sprite.motion, expected));
            }
            return Ok(());
        };
        if detail.frame_count != frames {
            let problem = format!("the number of frames is {}", detail.frame_count);
            let expected = format!("{frames}, as many as the sprite has");
            return Err(FieldError::from_problem(field("material.detail"), problem, expected));
        }
        Ok(())
    }
}
