//! CPU ray caster for a scene from a file: renders the same color and depth as `scene_mesh.wgsl`.

use std::ops::RangeInclusive;

use glam::{Mat4, UVec2, Vec2, Vec3};
use haze_core::formula::depth::DepthConvention;
use haze_core::formula::lighting::sample_light;
use haze_core::frame::View;

use super::boxes::LIGHT_GAP;
use super::camera_rays::CameraRays;
use super::outline::SAMPLES;
use super::scene::Scene;
use super::shading::Lit;
use haze_author::backdrop::{Ray, RayHit, SceneMesh};

/// Distance beyond everything, metres. `MESH_SUN_DISTANCE` in scene_mesh.wgsl.
const SUN_DISTANCE: f32 = 1.0e6;
/// Alignment of normals, and ratio of depths, on one even surface.
const EVEN: (f32, f32) = (0.95, 1.05);
/// Cosine below which a slanted surface gets no coarser level of its texture.
const LEAST_FACING: f32 = 0.05;

/// Caster of a view; see the module's documentation.
pub(crate) struct MeshCaster<'a> {
    scene: &'a Scene,
    mesh: &'a SceneMesh,
    /// Metres per unit of the mesh.
    scale: f32,
    size: Vec2,
    clip_from_world: Mat4,
    rays: CameraRays,
    /// View depths of the near and the far plane, metres.
    planes: RangeInclusive<f32>,
    /// Height of a pixel at view depth 1.
    pixel_size: f32,
}

/// Sample of a pixel: a point of a surface, or the sky.
struct Sample {
    /// Reflectance; 1 for the sky.
    paint: Vec3,
    lit: Lit,
    surface: Option<SampleSurface>,
}

struct SampleSurface {
    world: Vec3,
    normal: Vec3,
    view_depth: f32,
}

impl<'a> MeshCaster<'a> {
    /// Caster of the scene's mesh; `None` if it is made of boxes.
    pub fn new(scene: &'a Scene, view: &View) -> Option<Self> {
        let rays = CameraRays::new(view);
        Some(Self {
            mesh: scene.backdrop.mesh()?,
            scene,
            scale: scene.environment.scene_scale,
            size: view.size.as_vec2(),
            clip_from_world: view.clip_from_view * view.view_from_world,
            pixel_size: rays.up.length() * 2.0 / view.size.y.max(1) as f32,
            rays,
            planes: DepthConvention::from_clip_from_view(&view.clip_from_view)
                .map_or(0.0..=f32::INFINITY, |depth| depth.near..=depth.far),
        })
    }

    /// Depth 0..1 at a position in the image, pixels.
    pub fn depth(&self, pixel: Vec2) -> f32 {
        let ray = self.ray(pixel);
        let Some(hit) = self.hit(ray) else { return 1.0 };
        let clip = self.clip_from_world * (self.rays.eye + ray * hit.distance).extend(1.0);
        (clip.z / clip.w).clamp(0.0, 1.0)
    }

    /// Vector to view depth 1 through a position in the image, pixels.
    fn ray(&self, pixel: Vec2) -> Vec3 {
        self.rays.at_unit_depth(pixel / self.size)
    }

    /// Nearest surface between the planes. Its distance is a view depth, because the ray leads to view depth 1.
    fn hit(&self, ray: Vec3) -> Option<RayHit> {
        self.mesh.nearest(Ray { origin: self.rays.eye / self.scale, direction: ray / self.scale }, self.planes.clone())
    }

    fn sample(&self, pixel: Vec2) -> Sample {
        let ray = self.ray(pixel);
        let Some(hit) = self.hit(ray) else {
            return Sample { paint: Vec3::ONE, lit: Lit::even(self.scene.sky(ray.normalize())), surface: None };
        };
        let point = self.mesh.surface_point(&hit, ray);
        let view_depth = hit.distance;
        let facing = point.normal.dot(ray.normalize()).abs().max(LEAST_FACING);
        let sample = 0.5 * self.pixel_size * view_depth / facing.sqrt();
        let level = (point.texel_density / self.scale * sample).max(1.0e-6).log2();
        let texel =
            self.mesh.texture(hit.triangle).map_or(Vec3::ONE, |texture| texture.sample(point.uv, level).truncate());
        let world = self.rays.eye + ray * view_depth;
        Sample {
            paint: point.color * texel,
            lit: Lit::even(self.scene.ambient_light(point.normal)),
            surface: Some(SampleSurface { world, normal: point.normal, view_depth }),
        }
    }

    /// Averages samples of a group, as [`RayCaster`](super::ray_caster) does. `through` as in [`Scene::irradiance`].
    pub fn color(&self, at: UVec2, is_in_group: [bool; 4], through: &impl Fn(u32) -> Vec3) -> Vec3 {
        let mut samples = SAMPLES.map(|sample| self.sample(at.as_vec2() + sample));
        if samples.iter().any(|sample| sample.surface.is_some()) {
            self.add_lights(&mut samples, is_in_group, through);
        }
        let mut sum = Vec3::ZERO;
        let mut weights = 0.0;
        for (Sample { paint, lit, .. }, is_in_group) in samples.into_iter().zip(is_in_group) {
            if !is_in_group {
                continue;
            }
            let weight = 1.0 / (1.0 + (paint * lit.full).max_element());
            sum += paint * lit.shaded * weight;
            weights += weight;
        }
        sum / weights
    }

    fn add_lights(&self, samples: &mut [Sample; 4], is_in_group: [bool; 4], through: &impl Fn(u32) -> Vec3) {
        // On one even surface, two samples that agree tell of the other two.
        let is_even = is_even(samples);
        for (index, light) in (0..).zip(&self.scene.lights) {
            let mut visible = [true; 4];
            for (turn, i) in [0, 3, 1, 2].into_iter().enumerate() {
                let Sample { lit, surface: Some(surface), .. } = &mut samples[i] else { continue };
                if !is_in_group[i] {
                    continue;
                }
                let sample = sample_light(light, surface.world);
                let facing = surface.normal.dot(sample.direction);
                visible[i] = if turn > 1 && is_even && visible[0] == visible[3] {
                    visible[0]
                } else if facing <= 0.0 || sample.attenuation <= 0.0 {
                    true
                } else {
                    // Above the rounding of depth.
                    let origin = surface.world + surface.normal * (2.0e-3 + 1.0e-4 * surface.view_depth);
                    let distance = match light.directional > 0.5 {
                        true => SUN_DISTANCE,
                        false => (light.position - surface.world).length() - LIGHT_GAP,
                    };
                    let ray = Ray { origin: origin / self.scale, direction: sample.direction };
                    !self.mesh.is_blocked(ray, distance / self.scale)
                };
                if visible[i] {
                    let direct = light.color * (facing.max(0.0) * sample.attenuation);
                    lit.full += direct;
                    lit.shaded += direct * through(index);
                }
            }
        }
    }
}

fn is_even(samples: &[Sample; 4]) -> bool {
    let [Some(first), others @ ..] = samples.each_ref().map(|sample| sample.surface.as_ref()) else { return false };
    let depths =
        samples.iter().map(|sample| sample.surface.as_ref().map_or(f32::INFINITY, |surface| surface.view_depth));
    let (nearest, farthest) = depths.fold((f32::INFINITY, 0.0_f32), |(a, b), depth| (a.min(depth), b.max(depth)));
    let is_aligned = |other: Option<&SampleSurface>| other.is_some_and(|other| first.normal.dot(other.normal) > EVEN.0);
    farthest < nearest * EVEN.1 && others.into_iter().all(is_aligned)
}
