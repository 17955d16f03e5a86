//! Boxes of the demo scene.

use glam::Vec3;

/// Maximum number of boxes: the length of the uniform array in scene.wgsl.
pub(crate) const MAX_BOXES: usize = 96;

/// Distance along the normal up to which boxes occlude the sky, metres. `AMBIENT_REACH` in scene.wgsl.
pub(crate) const AMBIENT_REACH: f32 = 0.7;
/// Maximum length of a sun shadow, metres. `SUN_DISTANCE` in scene.wgsl.
pub(crate) const SUN_DISTANCE: f32 = 60.0;
/// Width of the sun's disc divided by its distance. `SUN_SPREAD` in scene.wgsl.
pub(crate) const SUN_SPREAD: f32 = 0.02;
/// Maximum width of the antialiased edge of a hard shadow, metres. `WIDEST_PIXEL` in scene.wgsl.
pub(crate) const WIDEST_PIXEL: f32 = 0.1;
/// Distance before a light at which a shadow ray ends, metres: far above the rounding of coordinates, so that a light may
/// stand in a surface, and small enough that its fixture casts shadows. `LIGHT_GAP` in scene.wgsl.
pub(crate) const LIGHT_GAP: f32 = 0.02;
/// Height of an underside that lies on the ground, metres: above the rounding of its corners. `UNDERSIDE_GAP` in
/// scene_boxes.wgsl.
const UNDERSIDE_GAP: f32 = 1.0e-4;

/// A box, rotated about the vertical axis. `Box` in scene.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct SceneBox {
    pub center: Vec3,
    /// Cosine of the rotation.
    pub cos: f32,
    pub half_size: Vec3,
    /// Sine of the rotation.
    pub sin: f32,
    /// Linear reflectance; radiance for [`Surface::Glow`].
    pub color: Vec3,
    /// A [`Surface`].
    pub surface: u32,
}

impl SceneBox {
    /// True if it stands on the ground, which is at height 0. Its underside lies in the plane of the ground's surface, whose
    /// inside would show through it from below: it is not drawn. `stands_on_ground` in scene_boxes.wgsl.
    pub fn stands_on_ground(self) -> bool {
        (self.center.y - self.half_size.y).abs() < UNDERSIDE_GAP
    }

    /// Rotates a world vector into the box's frame.
    pub fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(v.x * self.cos + v.z * self.sin, v.y, v.z * self.cos - v.x * self.sin)
    }

    /// Rotates a vector of the box's frame into the world.
    pub fn to_world(self, v: Vec3) -> Vec3 {
        Vec3::new(v.x * self.cos - v.z * self.sin, v.y, v.z * self.cos + v.x * self.sin)
    }
}

/// Procedural material of a box. The numbers equal the `SURFACE_` constants in scene.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    Plain = 0,
    Slabs = 1,
    Brick = 2,
    Wood = 3,
    Plaster = 4,
    /// Emissive, casts no shadow.
    Glow = 5,
    /// Uniform color without procedural stains.
    Even = 6,
}

/// Returns the distances at which a ray, in the box's frame, enters and leaves the box. Enter > leave on a miss.
pub(crate) fn box_interval(b: &SceneBox, origin: Vec3, direction: Vec3) -> (f32, f32) {
    let tiny = Vec3::splat(1.0e-6);
    let inverse = Vec3::select(direction.abs().cmplt(tiny), tiny, direction).recip();
    let middle = -origin * inverse;
    let reach = inverse.abs() * b.half_size;
    ((middle - reach).max_element(), (middle + reach).min_element())
}

/// Returns the signed distance of a point, in the box's frame, to the box; negative inside.
pub(crate) fn box_distance(b: &SceneBox, p: Vec3) -> f32 {
    let q = p.abs() - b.half_size;
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
}
