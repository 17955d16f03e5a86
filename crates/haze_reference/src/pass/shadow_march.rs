//! CPU version of `shaders/shadow_march.wgsl`.

use glam::{UVec3, Vec3, Vec4};
use half::f16;
use haze_core::formula::ambient::{SKY_DIRECTIONS, SKY_STEPS};
use haze_core::formula::shadow::{LIGHTS_PER_BLOCK, MAX_OPTICAL_DEPTH, SHADOW_STEPS, light_disc_offset, shadow_ray};
use haze_core::view_setup::SmokeShadow;

use crate::optical_depths::trilinear;

/// Marches from every cell of a density grid to the lights of a block. `density`: optical depths across the cells.
pub fn march_to_lights(density: &[f32], shadow: &SmokeShadow, block: u32) -> Vec<Vec3> {
    let block = block as usize;
    let lights = &shadow.march.lights[block * LIGHTS_PER_BLOCK..][..LIGHTS_PER_BLOCK];
    let radii = shadow.march.radii[block];
    let march = |origin| {
        let towards = |slot: usize| {
            stored(optical_depth_towards(density, shadow, lights[slot], radii[slot], origin, SHADOW_STEPS))
        };
        Vec3::from([0, 1, 2].map(towards))
    };
    cell_centers(shadow.grid.size).map(march).collect()
}

/// Marches from every cell of a density grid to sky and ground: openness to them in x and y.
pub fn march_to_sky(density: &[f32], shadow: &SmokeShadow) -> Vec<Vec3> {
    let openness = |origin: Vec3, side: f32| {
        let directions = shadow.march.sky.map(|direction| (direction.truncate() * side).extend(1.0));
        let depths = directions.map(|to| optical_depth_towards(density, shadow, to, 0.0, origin, SKY_STEPS));
        stored(depths.map(|depth| (-depth).exp2()).iter().sum::<f32>() / SKY_DIRECTIONS as f32)
    };
    let march = |origin| Vec3::new(openness(origin, 1.0), openness(origin, -1.0), 0.0);
    cell_centers(shadow.grid.size).map(march).collect()
}

fn cell_centers(size: UVec3) -> impl Iterator<Item = Vec3> {
    let cell = move |index: u32| UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y));
    (0..size.element_product()).map(move |index| cell(index).as_vec3() + 0.5)
}

/// `light`: as in [`shadow_ray`]. `radius`: of the light, cells.
fn optical_depth_towards(
    density: &[f32],
    shadow: &SmokeShadow,
    light: Vec4,
    radius: f32,
    origin: Vec3,
    steps: u32,
) -> f32 {
    let ray = shadow_ray(light, origin, shadow.march.extent);
    let step = ray.w / steps as f32;
    // The steps fill the cone between the point and the light's disc.
    let slope = radius / light.truncate().distance(origin).max(1.0e-4);
    let position = |i: u32| {
        let along = (i as f32 + 0.5) * step;
        let on_line = origin + ray.truncate() * along;
        if slope > 0.0 { on_line + light_disc_offset(i, ray.truncate()) * (along * slope) } else { on_line }
    };
    let depth: f32 = (0..steps).map(|i| trilinear(shadow.grid.size, density, position(i))).sum();
    (depth * step).min(MAX_OPTICAL_DEPTH)
}

/// Value as a half float holds it.
fn stored(value: f32) -> f32 {
    f16::from_f32(value).to_f32()
}
