//! CPU version of `shaders/shadow_march.wgsl`.

use glam::{IVec3, UVec3, Vec3, Vec4};
use half::f16;

use crate::optical_depths::{cell_index, trilinear};
use haze::formula::ambient::{SKY_DIRECTIONS, SKY_STEPS};
use haze::formula::shadow::{MAX_OPTICAL_DEPTH, SHADOW_STEPS, shadow_ray};
use haze::view_setup::SmokeShadow;

/// Marches from every cell of a density grid to every light with shadow. `density`: optical depths across the cells.
pub fn march_to_lights(density: &[f32], shadow: &SmokeShadow) -> Vec<Vec3> {
    let towards = |origin, light: Vec4| optical_depth_towards(density, shadow, light, origin, SHADOW_STEPS);
    let march = |origin| Vec3::from(shadow.march.lights.map(|light| stored(towards(origin, light))));
    cell_centres(shadow.grid.size).map(march).collect()
}

/// Marches from every cell of a density grid to sky and ground: openness to them in x and y.
pub fn march_to_sky(density: &[f32], shadow: &SmokeShadow) -> Vec<Vec3> {
    let openness = |origin: Vec3, side: f32| {
        let directions = shadow.march.sky.map(|direction| (direction.truncate() * side).extend(1.0));
        let depths = directions.map(|to| optical_depth_towards(density, shadow, to, origin, SKY_STEPS));
        stored(depths.map(|depth| (-depth).exp2()).iter().sum::<f32>() / SKY_DIRECTIONS as f32)
    };
    let march = |origin| Vec3::new(openness(origin, 1.0), openness(origin, -1.0), 0.0);
    cell_centres(shadow.grid.size).map(march).collect()
}

fn cell_centres(size: UVec3) -> impl Iterator<Item = Vec3> {
    let cell = move |index: u32| UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y));
    (0..size.element_product()).map(move |index| cell(index).as_vec3() + 0.5)
}

fn optical_depth_towards(density: &[f32], shadow: &SmokeShadow, light: Vec4, origin: Vec3, steps: u32) -> f32 {
    let load =
        |cell: IVec3| cell_index(shadow.grid.size, cell).and_then(|index| density.get(index).copied()).unwrap_or(0.0);
    let ray = shadow_ray(light, origin, shadow.march.size);
    let step = ray.w / steps as f32;
    let places = (0..steps).map(|i| origin + ray.truncate() * ((i as f32 + 0.5) * step));
    let depth: f32 = places.map(|place| trilinear(place, load)).sum();
    (depth * step).min(MAX_OPTICAL_DEPTH)
}

/// Value as a half float holds it.
fn stored(value: f32) -> f32 {
    f16::from_f32(value).to_f32()
}
