//! CPU version of `shaders/density_splat.wgsl`.

use glam::{IVec3, UVec3, Vec3};

use crate::optical_depths::cell_index;
use crate::sprite::{density_radius, sprite_optical_depth};
use haze::formula::density_grid::{bump_radius, cell_optical_depth, density_steps, optical_depth_of_steps};
use haze::formula::uniforms::SystemUniform;
use haze::frame::Particle;

/// Adds the sprites of a system to a grid of `size` cells, in fixed-point steps.
pub fn density_splat(system: &SystemUniform, particles: &[Particle], size: UVec3, density: &mut [u64]) {
    for particle in particles.iter().filter(|particle| particle.is_visible()) {
        let in_view = system.view_from_particles.transform_point3(particle.position);
        let centre = system.grid_from_view.transform_point3(in_view);
        let (radius, depth) = (density_radius(system, particle), sprite_optical_depth(system, particle));
        add_sprite(size, density, centre, radius, depth);
    }
}

/// Optical depths across the cells.
pub fn density_from_steps(steps: &[u64]) -> Vec<f32> {
    steps.iter().map(|&steps| optical_depth_of_steps(steps as u32, (steps >> 32) as u32)).collect()
}

fn add_sprite(size: UVec3, density: &mut [u64], centre: Vec3, radius: f32, depth: f32) {
    if radius.is_nan() || radius <= 0.0 {
        return;
    }
    let (last, reach) = (size.as_vec3() - 1.0, bump_radius(radius));
    let low = (centre - reach).floor().clamp(Vec3::ZERO, last).as_ivec3();
    let high = (centre + reach).floor().clamp(Vec3::ZERO, last).as_ivec3();
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let cell = IVec3::new(x, y, z);
                if let Some(sum) = cell_index(size, cell).and_then(|index| density.get_mut(index)) {
                    *sum += u64::from(density_steps(cell_optical_depth(cell.as_vec3() - centre, radius, depth)));
                }
            }
        }
    }
}
