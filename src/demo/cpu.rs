//! The demo scene by ray casting: colour and depth as the GPU would leave them.

use glam::{Mat4, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use super::layout::SceneBox;
use super::scene::Scene;
use super::shading::box_interval;
use crate::assets::picture::Picture;
use crate::frame::View;

/// Renders linear colour, four samples a pixel, and depth 0..1 at pixel centres.
pub(crate) fn render(scene: &Scene, view: &View) -> (Picture<Vec4>, Picture<f32>) {
    let caster = Caster {
        scene,
        size: view.size.as_vec2(),
        clip_from_world: view.clip_from_view * view.view_from_world,
        world_from_clip: (view.clip_from_view * view.view_from_world).inverse(),
        eye: view.view_from_world.inverse().transform_point3(Vec3::ZERO),
    };
    let mut colour = Picture::new(view.size, Vec4::ZERO);
    colour.for_each(|at, texel| *texel = caster.colour(at).extend(1.0));
    let mut depth = Picture::new(view.size, 1.0);
    depth.for_each(|at, texel| *texel = caster.depth(at));
    (colour, depth)
}

struct Caster<'a> {
    scene: &'a Scene,
    size: Vec2,
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    eye: Vec3,
}

struct Hit<'a> {
    surface: &'a SceneBox,
    world: Vec3,
    local: Vec3,
    local_normal: Vec3,
}

impl Caster<'_> {
    fn direction(&self, pixel: Vec2) -> Vec3 {
        let uv = pixel / self.size;
        let far = self.world_from_clip * Vec4::new(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 1.0, 1.0);
        (far.xyz() / far.w - self.eye).normalize()
    }

    fn hit(&self, direction: Vec3) -> Option<Hit<'_>> {
        let mut nearest = f32::INFINITY;
        let mut hit = None;
        for b in &self.scene.boxes {
            let (origin, local) = (b.to_local(self.eye - b.centre), b.to_local(direction));
            let (enter, leave) = box_interval(b, origin, local);
            if enter < leave && enter > 0.0 && enter < nearest {
                nearest = enter;
                hit = Some((b, origin + local * enter));
            }
        }
        let (surface, local) = hit?;
        // The face whose plane the point lies on.
        let depth = (local.abs() - surface.half_size).to_array();
        let axis = if depth[0] >= depth[1] && depth[0] >= depth[2] {
            Vec3::X
        } else if depth[1] >= depth[2] {
            Vec3::Y
        } else {
            Vec3::Z
        };
        let local_normal = axis * local.dot(axis).signum();
        Some(Hit { surface, world: self.eye + direction * nearest, local, local_normal })
    }

    /// Four samples, weighted so that one bright sample does not outshine the edge.
    fn colour(&self, at: UVec2) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let mut weights = 0.0;
        for offset in [Vec2::new(0.25, 0.25), Vec2::new(0.75, 0.25), Vec2::new(0.25, 0.75), Vec2::new(0.75, 0.75)] {
            let direction = self.direction(at.as_vec2() + offset);
            let colour = match self.hit(direction) {
                Some(hit) => self.scene.shade(hit.surface, hit.world, hit.local, hit.local_normal),
                None => self.scene.sky(direction),
            };
            let weight = 1.0 / (1.0 + colour.max_element());
            sum += colour * weight;
            weights += weight;
        }
        sum / weights
    }

    fn depth(&self, at: UVec2) -> f32 {
        let Some(hit) = self.hit(self.direction(at.as_vec2() + 0.5)) else { return 1.0 };
        let clip = self.clip_from_world * hit.world.extend(1.0);
        (clip.z / clip.w).clamp(0.0, 1.0)
    }
}
