//! Decoded images of a particle system: ramps, sprite flipbook, detail map, six-way maps and noise.

use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3};

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

/// A round puff under neutral ramps, computed: to begin with, and beside images of one's own. It has neither a detail map nor
/// six-way maps, and its noise is even. The built-in images look better.
impl Default for MaterialAssets {
    fn default() -> Self {
        let gray = |value: fn(f32) -> f32| row(|u| Vec3::splat(value(u)));
        let lit = gray(|u| u);
        Self {
            sprite: round_puff(),
            detail: None,
            six_way: None,
            noise: NoiseVolume::even(),
            diffuse_ramp: lit.clone(),
            backlight_ramp: lit.clone(),
            // exp(−optical depth) of u = 1 − 2^(−optical depth).
            shadow_ramp: gray(|u| (1.0 - u).powf(std::f32::consts::LOG2_E)),
            soft_scatter_ramp: lit.clone(),
            specular_ramp: gray(|u| (1.0 - u).powi(2)),
            motif: lit_sphere(),
            age_ramp: gray(|_| 1.0),
            heat_ramp: gray(|u| 1.0 - u),
            fire_ramp: row(|u| Vec3::new(u, u.powi(2), u.powi(4))),
            coverage_ramp: lit,
        }
    }
}

/// Ramp of one row.
fn row(color: impl Fn(f32) -> Vec3) -> Ramp {
    const WIDTH: u32 = 64;
    Ramp::from_linear(UVec2::new(WIDTH, 1), (0..WIDTH).map(|x| color(x as f32 / (WIDTH - 1) as f32)))
}

/// Normal of a unit sphere at a texel of a square image whose row 0 is the top one. z is 0 outside the sphere.
fn sphere_normal(size: u32, x: u32, y: u32) -> Vec3 {
    let coordinate = |texel: u32| (texel as f32 + 0.5) / size as f32 * 2.0 - 1.0;
    let position = Vec2::new(coordinate(x), -coordinate(y));
    position.extend((1.0 - position.length_squared()).max(0.0).sqrt())
}

fn round_puff() -> Sprite {
    const SIZE: u32 = 256;
    let texel = |index: u32| {
        let normal = sphere_normal(SIZE, index % SIZE, index / SIZE);
        let alpha = normal.z.powi(4);
        let code = |value: f32| (255.0 * value).round() as u8;
        let [x, y, z] = (0.5 * normal.normalize_or(Vec3::Z) + 0.5).to_array().map(code);
        [x, y, z, code(alpha)]
    };
    Sprite::with_levels(SIZE, 1, (0..SIZE * SIZE).map(texel).collect())
}

/// Sphere with a light above it, in front of the image.
fn lit_sphere() -> Ramp {
    const SIZE: u32 = 64;
    let light = Vec3::new(0.0, 1.0, 1.0).normalize();
    // Row 0 of a ramp is the bottom one.
    let color = |index: u32| {
        let normal = sphere_normal(SIZE, index % SIZE, SIZE - 1 - index / SIZE);
        Vec3::splat(0.5 * normal.normalize_or(Vec3::Z).dot(light) + 0.5)
    };
    Ramp::from_linear(UVec2::splat(SIZE), (0..SIZE * SIZE).map(color))
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
    pub sprite_detail: SpriteDetail,
    /// Density of the sprite, for shadow.
    pub density: SpriteDensity,
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

#[cfg(test)]
mod tests {
    use glam::Vec4Swizzles;

    use super::*;

    #[test]
    fn the_default_puff_is_round_and_its_normals_face_outwards() {
        let puff = MaterialAssets::default().sprite;
        let last = puff.size() - 1;
        let middle = last / 2;
        assert!(puff.texel(0, 0, middle, middle).w > 0.99);
        for (x, y) in [(0, 0), (last, 0), (0, last), (last, last), (0, middle), (middle, last)] {
            assert!(puff.texel(0, 0, x, y).w < 0.01, "{x} {y}");
        }
        let normal = |x, y| puff.texel(0, 0, x, y).xyz() * 2.0 - 1.0;
        assert!(normal(3 * last / 4, middle).x > 0.4 && normal(middle, last / 4).y > 0.4);
    }

    #[test]
    fn default_ramps_follow_what_they_stand_for() {
        let assets = MaterialAssets::default();
        let at = |ramp: &Ramp, u: f32| ramp.texel(UVec2::new((u * (ramp.size().x - 1) as f32) as u32, 0)).y;
        assert!(at(&assets.diffuse_ramp, 1.0) > at(&assets.diffuse_ramp, 0.0));
        assert!(at(&assets.shadow_ramp, 0.0) > 0.99 && at(&assets.shadow_ramp, 1.0) < 0.01);
        assert!(at(&assets.fire_ramp, 0.0) < 1e-6 && at(&assets.heat_ramp, 0.0) > at(&assets.heat_ramp, 1.0));
        // An optical depth of 1: half of the ramp's width.
        assert!((at(&assets.shadow_ramp, 0.5) - (-1.0_f32).exp()).abs() < 0.02);
        let motif = &assets.motif;
        assert!(motif.texel(UVec2::new(32, 60)).x > motif.texel(UVec2::new(32, 4)).x);
        assert!(assets.info().validate(0, &Settings::default()).is_ok());
    }
}
