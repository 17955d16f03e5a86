//! Density grid of a frame on the CPU: for the reference, and for devices without compute shaders. WGSL:
//! `shaders/density_splat.wgsl`.

use glam::{UVec3, Vec3};

use crate::formula::density_grid::{
    bump_radius, cell_optical_depth, density_steps, mean_optical_depth, optical_depth_of_steps,
};
use crate::formula::grain::{kept_fraction, sprite_erosion};
use crate::formula::uniforms::SystemUniform;
use crate::frame::Particle;

/// Adds the sprites of a system to a grid of `size` cells, x first, in fixed-point steps.
pub fn density_splat(system: &SystemUniform, particles: &[Particle], size: UVec3, density: &mut [u64]) {
    for particle in particles.iter().filter(|particle| particle.is_visible()) {
        let in_view = system.view_from_particles.transform_point3(particle.position);
        let center = system.grid_from_view.transform_point3(in_view);
        let radius = density_radius(system, particle);
        let depth = sprite_optical_depth(system, particle);
        add_sprite(size, density, center, radius, depth);
    }
}

/// Returns the optical depths across the cells of such a grid.
pub fn cell_optical_depths(density: &[u64]) -> impl Iterator<Item = f32> {
    density.iter().map(|&steps| optical_depth_of_steps(steps as u32, (steps >> 32) as u32))
}

/// Erosion of a particle's sprite.
pub fn erosion_of(system: &SystemUniform, particle: &Particle) -> f32 {
    sprite_erosion(system.grain_erosion, system.grain_dissolve, particle.age)
}

/// Half the side of the square that the density of a particle's sprite fills, in cells.
pub fn density_radius(system: &SystemUniform, particle: &Particle) -> f32 {
    particle.radius * system.size * system.density_reach * system.cells_per_metre
}

/// Mean optical depth over that square, as it casts shadow.
pub fn sprite_optical_depth(system: &SystemUniform, particle: &Particle) -> f32 {
    let amount = particle.shown_amount() * system.opacity;
    let kept = kept_fraction(system.eroded_fraction, erosion_of(system, particle));
    let depth = kept * mean_optical_depth(amount, system.mean_alpha, system.peak_alpha);
    system.shadow_density * depth / (system.density_reach * system.density_reach)
}

fn add_sprite(size: UVec3, density: &mut [u64], center: Vec3, radius: f32, depth: f32) {
    if radius.is_nan() || radius <= 0.0 {
        return;
    }
    let last = size.as_vec3() - 1.0;
    let reach = bump_radius(radius);
    let low = (center - reach).floor().clamp(Vec3::ZERO, last).as_uvec3();
    let high = (center + reach).floor().clamp(Vec3::ZERO, last).as_uvec3();
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            let row = ((z * size.y + y) * size.x) as usize;
            for x in low.x..=high.x {
                let cell = UVec3::new(x, y, z).as_vec3() - center;
                if let Some(sum) = density.get_mut(row + x as usize) {
                    *sum += u64::from(density_steps(cell_optical_depth(cell, radius, depth)));
                }
            }
        }
    }
}
