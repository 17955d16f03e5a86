//! Lights, as the host gives them: world space, linear colour, metres.

use glam::{Mat4, Vec3};

use crate::fields::{FieldVisitor, Fields};
use crate::gpu_types::LightUniform;

/// Most lights in one frame. 128 lights of 64 bytes are half of the 16 KiB that WebGL2 promises a uniform block.
pub const MAX_LIGHTS: usize = 128;

/// Where a light shines from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// From `position`, every way.
    #[default]
    Point,
    /// From `position`, in a cone round `direction`.
    Spot,
    /// From infinitely far, along `direction`. `position` and `range` are not used.
    Directional,
}

/// One light.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Light {
    /// Where it shines from.
    pub kind: LightKind,
    /// World space, metres. Point and spot.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub position: Vec3,
    /// The way the light travels, world space; need not be unit length. Spot and directional.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub direction: Vec3,
    /// Linear RGB, usually 0..=1.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub colour: Vec3,
    /// Multiplies `colour`. Point and spot: at one metre. Directional: everywhere.
    pub intensity: f32,
    /// Metres at which a point or spot light has faded to nothing. Smaller is cheaper: systems beyond it skip the light.
    pub range: f32,
    /// Radius of the glowing body, metres: softens the falloff close by and lets the body show past its own fixture.
    pub radius: f32,
    /// Half angle of the spot's bright core, degrees.
    pub inner_angle: f32,
    /// Half angle at which the spot has faded to nothing, degrees; at least `inner_angle`.
    pub outer_angle: f32,
    /// Multiplies this light's specular scatter quad. 0 draws none.
    pub specular_scatter: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            kind: LightKind::Point,
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            colour: Vec3::ONE,
            intensity: 1.0,
            range: 20.0,
            radius: 0.1,
            inner_angle: 20.0,
            outer_angle: 35.0,
            specular_scatter: 1.0,
        }
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

impl Fields for Light {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.vector("position", &mut self.position, -1.0e5..=1.0e5, "m");
        visitor.vector("direction", &mut self.direction, -1.0e3..=1.0e3, "");
        visitor.vector("colour", &mut self.colour, 0.0..=100.0, "");
        visitor.number("intensity", &mut self.intensity, 0.0..=1.0e5, "");
        visitor.number("range", &mut self.range, 0.01..=1.0e5, "m");
        visitor.number("radius", &mut self.radius, 0.001..=100.0, "m");
        visitor.number("inner_angle", &mut self.inner_angle, 0.0..=89.0, "degrees");
        visitor.number("outer_angle", &mut self.outer_angle, self.inner_angle..=89.9, "degrees");
        visitor.number("specular_scatter", &mut self.specular_scatter, 0.0..=100.0, "");
    }
}
