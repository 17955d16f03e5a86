//! CPU ray caster for the demo scene: renders the same color and depth as the GPU.

use std::ops::RangeInclusive;

use glam::{Mat4, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::depth::{DepthConvention, SKY_VIEW_DEPTH, view_depth_from_ndc_depth};
use haze_core::frame::View;

use super::boxes::{SceneBox, Surface, box_interval};
use super::camera_rays::CameraRays;
use super::mesh_caster::MeshCaster;
use super::occluders::{BoxMask, indices};
use super::outline::{SAMPLES, SampleGroups};
use super::scene::{Scene, coefficients};
use super::shading::{Lit, albedo};

/// Renders the depths of four samples per pixel.
pub(crate) fn render_depth(scene: &Scene, view: &View) -> Image<SampleGroups> {
    let coefficients = coefficients(view);
    let mut groups = Image::new(view.size, SampleGroups::new([1.0; 4], coefficients));
    if let Some(caster) = MeshCaster::new(scene, view) {
        groups.for_each(|at, texel| {
            *texel = SampleGroups::new(SAMPLES.map(|sample| caster.depth(at.as_vec2() + sample)), coefficients);
        });
        return groups;
    }
    let caster = RayCaster::new(scene, view);
    groups.for_each(|at, texel| {
        *texel = SampleGroups::new(SAMPLES.map(|sample| caster.depth(at.as_vec2() + sample)), coefficients);
    });
    groups
}

/// Linear color of a scene without smoke.
pub(crate) struct SceneColor {
    /// Surfaces behind outlines. Alpha is 0: that of smoke is added to it.
    pub behind: Image<Vec4>,
    /// Objects in front at outlines, with their fraction of the pixel in alpha.
    pub front: Image<Vec4>,
}

/// Renders linear color with four samples per pixel. `groups`: those of [`render_depth`]. `through`: fraction of a light, by
/// its index, that reaches a point of the world through the smoke.
pub(crate) fn render_color(
    scene: &Scene,
    view: &View,
    groups: &Image<SampleGroups>,
    through: impl Fn(Vec3, u32) -> Vec3 + Sync,
) -> SceneColor {
    let caster = RayCaster::new(scene, view);
    let mesh = MeshCaster::new(scene, view);
    let coefficients = coefficients(view);
    let color = |at: UVec2, is_in_group: [bool; 4], view_depth: f32| {
        let world = caster.rays.eye + caster.rays.at_unit_depth((at.as_vec2() + 0.5) / caster.size) * view_depth;
        let is_sky = view_depth >= SKY_VIEW_DEPTH;
        let through = |light| if is_sky { Vec3::ONE } else { through(world, light) };
        match &mesh {
            Some(mesh) => mesh.color(at, is_in_group, &through),
            None => caster.color(at, is_in_group, &through),
        }
    };
    let mut behind = Image::new(view.size, Vec4::ZERO);
    behind.for_each(|at, texel| {
        let groups = groups.load(at.as_ivec2());
        let view_depth = view_depth_from_ndc_depth(groups.back, coefficients);
        *texel = color(at, groups.is_back(), view_depth).extend(0.0);
    });
    let mut front = Image::new(view.size, Vec4::ZERO);
    front.for_each(|at, texel| {
        let groups = groups.load(at.as_ivec2());
        let fraction = groups.front_fraction();
        if fraction > 0.0 {
            *texel = color(at, groups.is_front, groups.front_depth).extend(fraction);
        }
    });
    SceneColor { behind, front }
}

struct RayCaster<'a> {
    scene: &'a Scene,
    size: Vec2,
    clip_from_world: Mat4,
    rays: CameraRays,
    /// View depths from the near to the far plane, metres.
    visible_depth: RangeInclusive<f32>,
    /// Boxes that may be visible in each tile of the image.
    tiles: Image<BoxMask>,
}

/// Side of a tile, pixels.
const TILE_SIZE: u32 = 16;

fn boxes_by_tile(boxes: &[SceneBox], clip_from_world: &Mat4, size: UVec2) -> Image<BoxMask> {
    let tiles = UVec2::new(size.x.div_ceil(TILE_SIZE), size.y.div_ceil(TILE_SIZE));
    let mut masks = Image::new(tiles, [0; 4]);
    for (index, b) in boxes.iter().enumerate() {
        let corners = (0..8).map(|corner| {
            let side = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
            let world = b.center + b.to_world(Vec3::new(side(1), side(2), side(4)) * b.half_size);
            let clip = *clip_from_world * world.extend(1.0);
            let ndc = clip.xy() / clip.w;
            // A corner at or behind the eye has no projection: the box may cover any pixel.
            let is_in_front = clip.w > 1.0e-3;
            is_in_front.then(|| Vec2::new(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5) * size.as_vec2())
        });
        let corners: Option<Vec<_>> = corners.collect();
        let (min, max) = corners.map_or((Vec2::NEG_INFINITY, Vec2::INFINITY), |corners| {
            corners.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)))
        });
        // One more pixel on every side, for rounding.
        let first = ((min - 1.0) / TILE_SIZE as f32).clamp(Vec2::ZERO, tiles.as_vec2()).as_uvec2();
        let last = ((max + 1.0) / TILE_SIZE as f32).ceil().clamp(Vec2::ZERO, tiles.as_vec2()).as_uvec2();
        for y in first.y..last.y {
            for x in first.x..last.x {
                masks.texels[(y * tiles.x + x) as usize][index / 32] |= 1 << (index % 32);
            }
        }
    }
    masks
}

/// Intersection of a ray with the scene.
struct Hit<'a> {
    surface: &'a SceneBox,
    world: Vec3,
    local: Vec3,
    local_normal: Vec3,
}

impl Hit<'_> {
    fn is_on_same_face(&self, other: &Self) -> bool {
        std::ptr::eq(self.surface, other.surface) && self.local_normal == other.local_normal
    }
}

/// Normal of the face on which a point lies, both in the box's frame.
fn face_normal(b: &SceneBox, local: Vec3) -> Vec3 {
    let depth = (local.abs() - b.half_size).to_array();
    let axis = if depth[0] >= depth[1] && depth[0] >= depth[2] {
        Vec3::X
    } else if depth[1] >= depth[2] {
        Vec3::Y
    } else {
        Vec3::Z
    };
    axis * local.dot(axis).signum()
}

impl<'a> RayCaster<'a> {
    fn new(scene: &'a Scene, view: &View) -> Self {
        let clip_from_world = view.clip_from_view * view.view_from_world;
        Self {
            scene,
            size: view.size.as_vec2(),
            clip_from_world,
            rays: CameraRays::new(view),
            visible_depth: DepthConvention::from_clip_from_view(&view.clip_from_view)
                .map_or(0.0..=f32::INFINITY, |depth| depth.near..=depth.far),
            tiles: boxes_by_tile(&scene.boxes, &clip_from_world, view.size),
        }
    }

    fn direction(&self, pixel: Vec2) -> Vec3 {
        self.rays.at_unit_depth(pixel / self.size).normalize()
    }

    /// Returns the first hit between the near and the far plane, for a position in the image in pixels.
    fn hit(&self, pixel: Vec2) -> Option<Hit<'_>> {
        let at = pixel.as_uvec2();
        let at_unit_depth = self.rays.at_unit_depth(pixel / self.size);
        let direction = at_unit_depth.normalize();
        let length = at_unit_depth.length();
        let visible_range = self.visible_depth.start() * length..=self.visible_depth.end() * length;
        let mut nearest = f32::INFINITY;
        let mut hit = None;
        let boxes = &self.scene.boxes;
        for b in indices(self.tiles.load((at / TILE_SIZE).as_ivec2()), boxes.len()).map(|index| &boxes[index]) {
            let origin = b.to_local(self.rays.eye - b.center);
            let local = b.to_local(direction);
            let (enter, leave) = box_interval(b, origin, local);
            if enter >= leave {
                continue;
            }
            // If the near plane cuts a box open, its far side is visible.
            let is_drawn =
                |distance: f32| !b.stands_on_ground() || face_normal(b, origin + local * distance) != Vec3::NEG_Y;
            let distance =
                [enter, leave].into_iter().find(|distance| visible_range.contains(distance) && is_drawn(*distance));
            if let Some(distance) = distance.filter(|distance| *distance < nearest) {
                nearest = distance;
                hit = Some((b, origin + local * distance));
            }
        }
        let (surface, local) = hit?;
        let local_normal = face_normal(surface, local);
        Some(Hit { surface, world: self.rays.eye + direction * nearest, local, local_normal })
    }

    /// Averages samples of a group, weighted so that a single bright sample does not dominate an edge. Light is evaluated per
    /// sample if the pixel's lie on different faces, otherwise once at its center. `through` as in [`Scene::irradiance`].
    fn color(&self, at: UVec2, is_in_group: [bool; 4], through: &impl Fn(u32) -> Vec3) -> Vec3 {
        let directions = SAMPLES.map(|sample| self.direction(at.as_vec2() + sample));
        let hits = SAMPLES.map(|sample| self.hit(at.as_vec2() + sample));
        let is_one_face = hits[1..].iter().all(|hit| match (hit, &hits[0]) {
            (Some(hit), Some(first)) => hit.is_on_same_face(first),
            (None, None) => true,
            _ => false,
        });
        let center = self.direction(at.as_vec2() + 0.5);
        let pixel_angle = (self.direction(at.as_vec2() + Vec2::new(0.5, 1.5)) - center).length();
        let shared_light = is_one_face.then(|| self.light(&hits[0], center, pixel_angle, through));
        let mut sum = Vec3::ZERO;
        let mut weights = 0.0;
        for ((hit, direction), is_in_group) in hits.iter().zip(directions).zip(is_in_group) {
            if !is_in_group {
                continue;
            }
            let reflectance =
                hit.as_ref().map_or(Vec3::ONE, |hit| albedo(hit.surface, hit.local, hit.local_normal, hit.world));
            let lit = shared_light.unwrap_or_else(|| self.light(hit, direction, pixel_angle, through));
            let weight = 1.0 / (1.0 + (reflectance * lit.full).max_element());
            sum += reflectance * lit.shaded * weight;
            weights += weight;
        }
        sum / weights
    }

    /// Returns the light at the point where the ray meets the plane of the face that was hit; the sky's radiance
    /// without a hit.
    fn light(&self, hit: &Option<Hit<'_>>, direction: Vec3, pixel_angle: f32, through: &impl Fn(u32) -> Vec3) -> Lit {
        let Some(Hit { surface: b, local_normal: normal, .. }) = hit else {
            return Lit::even(self.scene.sky(direction));
        };
        if b.surface == Surface::Glow as u32 {
            return Lit::even(Vec3::ONE);
        }
        let origin = b.to_local(self.rays.eye - b.center);
        let distance = (normal.abs().dot(b.half_size) - normal.dot(origin)) / normal.dot(b.to_local(direction));
        let normal = b.to_world(*normal);
        let pixel = pixel_angle * distance / (-direction.dot(normal)).max(1.0e-3);
        self.scene.irradiance(self.rays.eye + direction * distance, normal, pixel, through)
    }

    /// Depth 0..1 at a position in the image, pixels.
    fn depth(&self, pixel: Vec2) -> f32 {
        let Some(hit) = self.hit(pixel) else { return 1.0 };
        let clip = self.clip_from_world * hit.world.extend(1.0);
        (clip.z / clip.w).clamp(0.0, 1.0)
    }
}
