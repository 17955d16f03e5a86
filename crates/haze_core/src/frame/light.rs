//! Lights of a host: world space, linear color, metres.

use glam::{Mat4, Vec3};

use crate::formula::uniforms::LightUniform;
use crate::settings::{choice, settings};

/// Maximum number of lights in one frame. 128 lights of 64 bytes are half of the 16 KiB that WebGL2 guarantees for a
/// uniform block.
pub const MAX_LIGHTS: usize = 128;

choice! {
    /// Type of a light.
    LightKind {
        /// Shines from `position` in all directions.
        #[default]
        Point = "point",
        /// Shines from `position`, in a cone around `direction`.
        Spot = "spot",
        /// Shines along `direction`, from infinitely far. `position` and `range` are not used.
        Directional = "directional",
    }
}

choice! {
    /// Part that a light plays in the lighting of a shot. It names the light for people and tools; the image does not
    /// depend on it.
    LightRole {
        /// No part of its own.
        #[default]
        None = "none",
        /// Main light, which gives the smoke its shape. At most one light of a preset.
        Key = "key",
        /// Weak light that brightens the shadows of the key light.
        Fill = "fill",
        /// Light from behind, which draws the outline of the smoke.
        Rim = "rim",
        /// Light that is seen in the image: a lamp, a window, a fire.
        Practical = "practical",
    }
}

settings! {
    /// One light. A white, unshadowed texel of a diffuse ramp sends `color · intensity / distance²` to the viewer, or
    /// `color · intensity` under a directional light. Divided by π, candela or lux make it as bright as a white matte surface.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Light {
        /// Type of the light.
        kind: LightKind = LightKind::Point, choice;
        /// Position in world space, metres. Behind the smoke, the light glows through it; beside the smoke, it shows
        /// its shape. Point and spot.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::new(0.0, 2.0, 0.0), vector(-1.0e5..=1.0e5, "m");
        /// Direction in which the light travels, world space; need not be unit length. Spot and directional.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        direction: Vec3 = Vec3::NEG_Y, vector(-1.0e3..=1.0e3, "");
        /// Linear RGB, usually 0 to 1. Tints the light on smoke and scene.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        color: Vec3 = Vec3::ONE, color(0.0..=100.0);
        /// Multiplies `color`. Higher: brighter. Point and spot: at one metre. Directional: everywhere. Any unit that
        /// fits the scene: a sun of 120 000 lux works like one of 1. Light is limited to what half floats can hold.
        intensity: f32 = 1.0, number(0.0..=1.0e9, "");
        /// Distance at which a point or spot light has faded to nothing, metres; infinite: never. Lower is cheaper,
        /// because systems beyond it skip the light.
        range: f32 = 20.0, number(0.01..=f32::INFINITY, "m");
        /// Radius of the glowing body, metres. Higher: softer falloff close by, and the glow is visible past its own
        /// fixture.
        radius: f32 = 0.1, number(0.0..=1.0e4, "m");
        /// Half angle of the spot's bright core, degrees. Higher: a wider core.
        inner_angle: f32 = 20.0, number(0.0..=89.0, "degrees");
        /// Half angle at which the spot has faded to nothing, degrees; at least `inner_angle`. Higher: a softer edge.
        /// In between, light falls with the square of the cosine's progress.
        outer_angle: f32 = 35.0, number(|this| this.inner_angle..=89.9, "degrees");
        /// Multiplies the glow of this light through the smoke, its specular scatter quad. 0 draws none. A spot glows as
        /// brightly as it shines at the viewer.
        specular_scatter: f32 = 1.0, number(0.0..=100.0, "");
        /// Lets smoke shade this light, if it is one of the `shadow.lights` brightest. Off: the light shines through all smoke.
        smoke_shadow: bool = true, flag;
        /// Part that the light plays: key, fill, rim or practical. Names the light; the image stays as it is.
        role: LightRole = LightRole::None, choice;
    }
}

/// Least width of the edge of a spot's cone, as a fraction of 1 - cos of its outer angle.
const MIN_SPOT_EDGE: f32 = 1.0e-3;

impl Light {
    /// Returns the light as the shaders read it, in the space that `space_from_world` (rigid) leads to.
    pub fn uniform(&self, space_from_world: &Mat4) -> LightUniform {
        let directional = self.kind == LightKind::Directional;
        // Cone fade: 1 at the inner angle, 0 at the outer.
        let mut spot_scale = 0.0;
        let mut spot_offset = 1.0;
        if self.kind == LightKind::Spot {
            // 1 - cos, which loses its digits in narrow cones if it is subtracted.
            let below_one = |degrees: f32| 2.0 * (0.5 * degrees.to_radians()).sin().powi(2);
            let inner = below_one(self.inner_angle);
            let outer = below_one(self.outer_angle);
            spot_scale = 1.0 / (outer - inner).max(MIN_SPOT_EDGE * outer).max(MIN_SPOT_EDGE.powi(4));
            spot_offset = outer * spot_scale;
        }
        LightUniform {
            position: space_from_world.transform_point3(self.position),
            inverse_range: if directional { 0.0 } else { 1.0 / self.range },
            direction: space_from_world.transform_vector3(self.direction).normalize_or(Vec3::NEG_Y),
            directional: if directional { 1.0 } else { 0.0 },
            color: self.color * self.intensity,
            specular_scatter: self.specular_scatter,
            spot_scale,
            spot_offset,
            radius: self.radius,
            shadow_slot: 0.0,
        }
    }
}
