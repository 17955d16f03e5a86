//! Shadow maps of the demo scene's lights: where they look, and their depths on the CPU. scene_renderer.rs draws them on
//! the GPU.

use glam::camera::rh::proj::directx::{orthographic, perspective};
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, UVec2, Vec3, vec3};
use haze_core::assets::image::Image;
use haze_core::frame::{Light, LightKind, ShadowProjection};

use super::boxes::{SceneBox, Surface, box_interval};
use super::scene::Scene;
use haze_author::backdrop::Ray;

/// Lights that get a map, from the first on.
const MAX_MAPS: usize = 8;
/// Half the side of the square that a sun's map covers, and the half depth, metres.
const SUN_REACH: f32 = 16.0;
/// Half the side of the square that a sun's map covers of a mesh at most, metres.
const MAX_MESH_REACH: f32 = 64.0;
/// Middle of the demo scene.
const MIDDLE: Vec3 = vec3(0.0, 2.0, -4.0);
/// Depth by which a surface must be before a point: a few centimetres of a sun's map.
const BIAS: f32 = 1.0e-3;
/// Near plane of a lamp's map, metres: behind the fixture's own glass.
const NEAR: f32 = 0.05;

/// Shadow map of a light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShadowView {
    light: usize,
    pub clip_from_world: Vec<Mat4>,
    /// Side of a layer, texels.
    pub size: u32,
}

impl ShadowView {
    pub fn projection(&self) -> ShadowProjection<'_> {
        let Self { light, clip_from_world, .. } = self;
        ShadowProjection { light: *light, clip_from_world, reversed: false, bias: BIAS }
    }

    /// Depths of a layer.
    pub fn layer(&self, scene: &Scene, clip_from_world: &Mat4) -> Image<f32> {
        let boxes: Vec<_> = casters(&scene.boxes).collect();
        let scale = scene.environment.scene_scale;
        let world_from_clip = clip_from_world.inverse();
        let mut depths = Image::new(UVec2::splat(self.size), 1.0);
        depths.for_each(|at, depth| {
            let uv = (at.as_vec2() + 0.5) / self.size as f32;
            let at_depth = |z| world_from_clip.project_point3(vec3(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, z));
            let near = at_depth(0.0);
            let ray = at_depth(1.0) - near;
            let enter = boxes.iter().filter_map(|b| {
                let (enter, leave) = box_interval(b, b.to_local(near - b.center), b.to_local(ray));
                // A box around the light shows its far side.
                (enter < leave).then_some(if enter > 0.0 { enter } else { leave }).filter(|distance| *distance > 0.0)
            });
            let in_mesh = Ray { origin: near / scale, direction: ray / scale };
            let of_mesh = scene.backdrop.mesh().and_then(|mesh| mesh.nearest(in_mesh, 0.0..=1.0));
            let nearest = enter.chain(of_mesh.map(|hit| hit.distance)).fold(f32::INFINITY, f32::min);
            if nearest < 1.0 {
                *depth = clip_from_world.project_point3(near + ray * nearest).z;
            }
        });
        depths
    }
}

/// Boxes that cast shadow: all but those that glow.
pub(crate) fn casters(boxes: &[SceneBox]) -> impl Iterator<Item = SceneBox> {
    boxes.iter().copied().filter(|b| b.surface != Surface::Glow as u32)
}

/// Shadow maps of the first lights. `bounds`: corners of the box around a mesh, which a sun's map covers up to
/// [`MAX_MESH_REACH`] from its middle.
pub(crate) fn shadow_views(lights: &[Light], bounds: Option<(Vec3, Vec3)>) -> Vec<ShadowView> {
    let (middle, reach, behind) = match bounds {
        Some((min, max)) => {
            let radius = (0.5 * (max - min).length()).max(1.0);
            // Large grounds: the smoke is rarely far from the origin.
            let middle = if radius > MAX_MESH_REACH { MIDDLE } else { 0.5 * (min + max) };
            (middle, radius.min(MAX_MESH_REACH), (middle - 0.5 * (min + max)).length() + radius)
        }
        None => (MIDDLE, SUN_REACH, 2.0 * SUN_REACH),
    };
    let view = |(light, of): (usize, &Light)| {
        let direction = of.direction.normalize_or(Vec3::NEG_Y);
        let looking = |eye, towards: Vec3| {
            let up = if towards.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
            look_at_mat4(eye, eye + towards, up)
        };
        let lamp = |fov: f32| perspective(fov, 1.0, NEAR, of.range.clamp(1.0, 100.0));
        let (clip_from_world, size) = match of.kind {
            LightKind::Directional => {
                let eye = middle - direction * behind;
                let projection = orthographic(-reach, reach, -reach, reach, 0.0, 2.0 * behind);
                (vec![projection * looking(eye, direction)], if bounds.is_some() { 1024 } else { 512 })
            }
            LightKind::Spot => {
                let fov = (2.0 * of.outer_angle.to_radians()).clamp(0.1, 3.0);
                (vec![lamp(fov) * looking(of.position, direction)], 256)
            }
            _ => {
                let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
                let face = |towards| lamp(std::f32::consts::FRAC_PI_2) * looking(of.position, towards);
                (faces.map(face).to_vec(), 128)
            }
        };
        ShadowView { light, clip_from_world, size }
    };
    lights.iter().enumerate().take(MAX_MAPS).map(view).collect()
}
