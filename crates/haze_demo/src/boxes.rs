//! The boxes that a scene is made of.

use glam::Vec3;

/// Most boxes of one scene: the length of the uniform array in scene.wgsl.
pub(crate) const MAX_BOXES: usize = 96;

/// How far out on the normal boxes are looked for that take light of the sky away, metres. `AMBIENT_REACH` in scene.wgsl.
pub(crate) const AMBIENT_REACH: f32 = 0.7;
/// How far a shadow of the sun reaches, metres. `SUN_DISTANCE` in scene.wgsl.
pub(crate) const SUN_DISTANCE: f32 = 60.0;
/// Width of the sun's disc over its distance. `SUN_SPREAD` in scene.wgsl.
pub(crate) const SUN_SPREAD: f32 = 0.02;
/// Most that the edge of a shadow is widened so that it does not show its pixels, metres. `WIDEST_PIXEL` in scene.wgsl.
pub(crate) const WIDEST_PIXEL: f32 = 0.1;

/// One box, turned about the vertical. `Box` in scene.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct SceneBox {
    pub centre: Vec3,
    /// Cosine of the turn.
    pub cos: f32,
    pub half_size: Vec3,
    /// Sine of the turn.
    pub sin: f32,
    /// Linear; radiance for [`Surface::Glow`].
    pub colour: Vec3,
    /// A [`Surface`].
    pub surface: u32,
}

impl SceneBox {
    /// A vector in the box's own frame.
    pub fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(v.x * self.cos + v.z * self.sin, v.y, v.z * self.cos - v.x * self.sin)
    }

    /// A vector of the box's own frame in the world.
    pub fn to_world(self, v: Vec3) -> Vec3 {
        Vec3::new(v.x * self.cos - v.z * self.sin, v.y, v.z * self.cos + v.x * self.sin)
    }
}

/// The procedural material of a box. The numbers are those of scene.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    Plain = 0,
    Slabs = 1,
    Brick = 2,
    Wood = 3,
    Plaster = 4,
    /// Shines, casts no shadow.
    Glow = 5,
    /// The colour itself, without a stain.
    Even = 6,
}

/// Distances along a ray at which it enters and leaves a box, in the box's frame.
pub(crate) fn box_interval(b: &SceneBox, origin: Vec3, direction: Vec3) -> (f32, f32) {
    let tiny = Vec3::splat(1.0e-6);
    let inverse = Vec3::select(direction.abs().cmplt(tiny), tiny, direction).recip();
    let middle = -origin * inverse;
    let reach = inverse.abs() * b.half_size;
    ((middle - reach).max_element(), (middle + reach).min_element())
}

/// Distance of a point, in the box's frame, from a box; negative inside.
pub(crate) fn box_distance(b: &SceneBox, p: Vec3) -> f32 {
    let q = p.abs() - b.half_size;
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
}
