//! Lights, as the host gives them: world space, linear colour, metres.

use glam::{Mat4, Vec3};

use crate::formula::uniforms::LightUniform;
use crate::settings::{choice, settings};

/// Most lights in one frame. 128 lights of 64 bytes are half of the 16 KiB that WebGL2 promises a uniform block.
pub const MAX_LIGHTS: usize = 128;

choice! {
    /// Where a light shines from.
    LightKind {
        /// From `position`, every way.
        #[default]
        Point = "point",
        /// From `position`, in a cone round `direction`.
        Spot = "spot",
        /// From infinitely far, along `direction`. `position` and `range` are not used.
        Directional = "directional",
    }
}

settings! {
    /// One light.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Light {
        /// Where it shines from.
        kind: LightKind = LightKind::Point, choice;
        /// World space, metres: behind the smoke it glows through, beside it it gives it shape. Point and spot.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// The way the light travels, world space; need not be unit length. Spot and directional.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        direction: Vec3 = Vec3::NEG_Y, vector(-1.0e3..=1.0e3, "");
        /// Linear RGB, usually 0..=1: tints what the ramps answer.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        colour: Vec3 = Vec3::ONE, colour(0.0..=100.0);
        /// Multiplies `colour`. Point and spot: at one metre. Directional: everywhere. In any unit, the scene's: a sun of 120 000
        /// lux is as good as one of 1. What is brighter than half floats can hold is drawn as bright as they can.
        intensity: f32 = 1.0, number(0.0..=1.0e9, "");
        /// Metres at which a point or spot light has faded to nothing; infinite: never. Smaller is cheaper: systems beyond it skip
        /// the light.
        range: f32 = 20.0, number(0.01..=f32::INFINITY, "m");
        /// Radius of the glowing body, metres: softens the falloff close by and lets the body show past its own fixture.
        radius: f32 = 0.1, number(0.0..=1.0e4, "m");
        /// Half angle of the spot's bright core, degrees.
        inner_angle: f32 = 20.0, number(0.0..=89.0, "degrees");
        /// Half angle at which the spot has faded to nothing, degrees; at least `inner_angle`. Between them light falls by the
        /// square of how far the cosine has gone.
        outer_angle: f32 = 35.0, number(|this| this.inner_angle..=89.9, "degrees");
        /// Multiplies this light's glow through the smoke, its specular scatter quad. 0 draws none.
        specular_scatter: f32 = 1.0, number(0.0..=100.0, "");
    }
}

impl Light {
    /// The light as the shaders see it, in the space that `space_from_world` (rigid) leads to.
    pub fn uniform(&self, space_from_world: &Mat4) -> LightUniform {
        let directional = self.kind == LightKind::Directional;
        // Cone fade: cos = cos(inner) gives 1, cos(outer) gives 0.
        let (spot_scale, spot_offset) = if self.kind == LightKind::Spot {
            let (inner, outer) = (self.inner_angle.to_radians().cos(), self.outer_angle.to_radians().cos());
            let scale = 1.0 / (inner - outer).max(1.0e-4);
            (scale, -outer * scale)
        } else {
            (0.0, 1.0)
        };
        LightUniform {
            position: space_from_world.transform_point3(self.position),
            inverse_range: if directional { 0.0 } else { 1.0 / self.range },
            direction: space_from_world.transform_vector3(self.direction).normalize_or(Vec3::NEG_Y),
            directional: if directional { 1.0 } else { 0.0 },
            colour: self.colour * self.intensity,
            specular_scatter: self.specular_scatter,
            spot_scale,
            spot_offset,
            radius: self.radius,
            padding: 0.0,
        }
    }
}
