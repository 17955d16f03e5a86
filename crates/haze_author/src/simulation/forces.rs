//! Forces on the velocity: buoyancy, vorticity confinement, turbulence.

use glam::{UVec3, Vec3, Vec4};
use haze_core::assets::noise::curl_noise;
use haze_core::formula::saturate;

use super::domain::Domain;
use super::sim_recipe::Physics;
use crate::deterministic_math::cos_sin;

/// Least smoke or heat that turbulence acts on.
const MIN_GAS: f32 = 0.01;

/// Returns the velocity at the centers of cells.
pub fn center_velocities(domain: Domain, velocity: &[Vec<f32>; 3]) -> Vec<Vec4> {
    let grid = domain.grid;
    let strides = grid.strides();
    let mut centered = vec![Vec4::ZERO; grid.cells()];
    grid.for_rows(&mut centered, |first, row| {
        for (index, center) in (grid.index(first)..).zip(row) {
            let mean = |axis: usize| (velocity[axis][index] + velocity[axis][index + strides[axis]]) * 0.5;
            *center = Vec4::new(mean(0), mean(1), mean(2), 0.0);
        }
    });
    grid.extend_to_ghosts(&mut centered, None);
    centered
}

/// Returns the acceleration at the centers of cells. `gas` holds smoke, heat and fuel, `centered` the velocity.
pub fn accelerations(domain: Domain, physics: &Physics, time: f32, gas: &[Vec4], centered: &[Vec4]) -> Vec<Vec3> {
    let grid = domain.grid;
    let mut accelerations = vec![Vec3::ZERO; grid.cells()];
    let confinement = (physics.vorticity > 0.0).then(|| vorticities(domain, centered));
    let turns = time * physics.turbulence_rate * 0.25;
    let phase = cos_sin((turns - turns.floor()) * std::f32::consts::TAU);
    let [x, y, z] = grid.strides();
    grid.for_rows(&mut accelerations, |first, row| {
        for (column, acceleration) in (0_u32..).zip(row) {
            let cell = first + UVec3::X * column;
            let index = grid.index(cell);
            let [smoke, heat, _, _] = gas[index].to_array();
            acceleration.y = physics.buoyancy * heat - physics.weight * smoke;
            if let Some(vorticities) = &confinement {
                let strength = |index: usize| vorticities[index].w;
                let slope = Vec3::new(
                    strength(index + x) - strength(index - x),
                    strength(index + y) - strength(index - y),
                    strength(index + z) - strength(index - z),
                );
                let steepness = (slope.x * slope.x + slope.y * slope.y + slope.z * slope.z).sqrt();
                // f = strength * cell width * (N x vorticity), N towards stronger vorticity. (Fedkiw et al. 2001, 5)
                let towards = slope / steepness.max(1.0e-6);
                *acceleration +=
                    towards.cross(vorticities[index].truncate()) * (physics.vorticity * domain.cell_width());
            }
            let fraction = saturate(smoke + heat);
            if physics.turbulence > 0.0 && fraction > MIN_GAS {
                let at = domain.position(cell.as_vec3()) * physics.turbulence_frequency;
                *acceleration += curl_noise(at, phase, physics.seed) * (physics.turbulence * fraction);
            }
        }
    });
    accelerations
}

/// Returns the curl of the velocity at the centers of cells, and its length in w.
fn vorticities(domain: Domain, centered: &[Vec4]) -> Vec<Vec4> {
    let grid = domain.grid;
    let [x, y, z] = grid.strides();
    let scale = 0.5 / domain.cell_width();
    let mut vorticities = vec![Vec4::ZERO; grid.cells()];
    grid.for_rows(&mut vorticities, |first, row| {
        for (index, vorticity) in (grid.index(first)..).zip(row) {
            let along_x = centered[index + x] - centered[index - x];
            let along_y = centered[index + y] - centered[index - y];
            let along_z = centered[index + z] - centered[index - z];
            let curl = Vec3::new(along_y.z - along_z.y, along_z.x - along_x.z, along_x.y - along_y.x) * scale;
            *vorticity = curl.extend((curl.x * curl.x + curl.y * curl.y + curl.z * curl.z).sqrt());
        }
    });
    grid.extend_to_ghosts(&mut vorticities, None);
    vorticities
}

/// Adds accelerations at the centers of cells to one component on the faces between them.
pub fn accelerate_faces(domain: Domain, axis: usize, accelerations: &[Vec3], step: f32, keep: f32, faces: &mut [f32]) {
    let grid = domain.grid;
    let stride = grid.strides()[axis];
    grid.for_rows_within(grid.faces(axis), faces, |first, row| {
        for (index, value) in (grid.index(first)..).zip(row) {
            let mean = (accelerations[index - stride][axis] + accelerations[index][axis]) * 0.5;
            *value = (*value + mean * step) * keep;
        }
    });
}
