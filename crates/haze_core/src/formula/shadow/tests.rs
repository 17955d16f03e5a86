use glam::{UVec3, Vec3, Vec4, vec3};

use super::*;
use crate::formula::density_grid::{cell_optical_depth, density_steps, mean_optical_depth, optical_depth_of_steps};
use crate::settings::Settings;

/// A grid with one sprite in the middle, radius and depth.
struct Puff {
    size: f32,
    center: Vec3,
    radius: f32,
    depth: f32,
}

impl Puff {
    fn cells(&self) -> impl Iterator<Item = Vec3> + use<> {
        let side = self.size as u32;
        (0..side.pow(3)).map(move |i| UVec3::new(i % side, i / side % side, i / (side * side)).as_vec3())
    }

    fn density(&self, cell: Vec3) -> f32 {
        let inside = cell.cmpge(Vec3::ZERO).all() && cell.cmplt(Vec3::splat(self.size)).all();
        if inside { cell_optical_depth(cell - self.center, self.radius, self.depth) } else { 0.0 }
    }

    /// Optical depth from the center of a cell.
    fn march(&self, cell: Vec3, light: Vec4) -> f32 {
        let from = cell + 0.5;
        let ray = shadow_ray(light, from, Vec3::splat(self.size));
        let step = ray.w / SHADOW_STEPS as f32;
        let positions = (0..SHADOW_STEPS).map(|index| from + ray.truncate() * ((index as f32 + 0.5) * step));
        positions.map(|position| trilinear(position, |cell| self.density(cell))).sum::<f32>() * step
    }
}

fn trilinear(position: Vec3, load: impl Fn(Vec3) -> f32) -> f32 {
    let low = (position - 0.5).floor();
    let high_weight = position - 0.5 - low;
    let corners = (0..8).map(|corner| vec3((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32));
    let weight = |offset: Vec3| Vec3::select(offset.cmpeq(Vec3::ONE), high_weight, 1.0 - high_weight);
    corners.map(|offset| load(low + offset) * weight(offset).to_array().iter().product::<f32>()).sum()
}

#[test]
fn mass_of_a_sprite_is_the_same_on_every_grid() {
    for (radius, center) in [(0.2, 3.3), (0.9, 5.0), (3.0, 6.2), (5.5, 5.9)] {
        let puff = Puff { size: 12.0, center: Vec3::splat(center), radius, depth: 0.7 };
        let sum: f32 = puff.cells().map(|cell| puff.density(cell)).sum();
        // The bump of a small sprite is widened.
        let expected = 4.0 * 0.7 * radius * radius;
        assert!((sum / expected - 1.0).abs() < 1e-3, "{radius}: {sum}, expected {expected}");
    }
}

#[test]
fn puff_alone_has_no_shadow_on_itself() {
    let directions = [Vec3::X, Vec3::NEG_Y, Vec3::Z, vec3(1.0, 1.0, 0.0), vec3(-1.0, 1.0, 1.0)].map(Vec3::normalize);
    for radius in [0.5, 1.0, 2.0, 4.0, 7.0] {
        for offset in [0.0, 0.3, 0.5] {
            let puff = Puff { size: 17.0, center: vec3(8.5 + offset, 8.5, 8.5 - offset), radius, depth: 1.0 };
            let own = own_optical_depth(radius, puff.depth);
            let found =
                directions.map(|to_light| trilinear(puff.center, |cell| puff.march(cell, to_light.extend(1.0))));
            let mean = found.iter().sum::<f32>() / 5.0;
            // A bump a few cells wide is not the same in all directions and positions.
            assert!((mean - own).abs() < 0.2, "{radius} {offset}: {mean}, own {own}");
            assert!(found.iter().all(|depth| (depth - own).abs() < 0.25), "{radius} {offset}: {found:?}, own {own}");
        }
    }
}

#[test]
fn lamp_in_the_smoke_is_behind_less_of_it_than_the_sun() {
    let puff = Puff { size: 17.0, center: Vec3::splat(8.5), radius: 5.0, depth: 1.0 };
    let cell = vec3(2.0, 8.0, 8.0);
    let [sun, behind, within, beside] = [
        Vec3::X.extend(1.0),
        vec3(16.0, 8.5, 8.5).extend(0.0),
        vec3(8.5, 8.5, 8.5).extend(0.0),
        vec3(3.0, 8.5, 8.5).extend(0.0),
    ]
    .map(|light| puff.march(cell, light));
    assert!((sun - behind).abs() < 0.02 && (within / sun - 0.5).abs() < 0.1, "{sun} {behind} {within}");
    assert!(beside < 0.1 * sun, "{beside} {sun}");
}

#[test]
fn extreme_sprites_and_lights_give_finite_depths() {
    for (radius, amount) in [(1e-9, 1.0), (1e9, 1.0), (1.0, 0.0), (1.0, f32::NAN), (1.0, 1e30)] {
        let depth = mean_optical_depth(amount, 0.3, 0.98);
        let cell = cell_optical_depth(Vec3::splat(-0.5), radius, depth);
        let steps = density_steps(cell);
        let own = own_optical_depth(radius, depth);
        assert!(optical_depth_of_steps(steps, 0).is_finite() && own.is_finite() && own >= 0.0, "{radius} {amount}");
    }
    for light in [Vec4::ZERO, Vec3::splat(1e9).extend(0.0), Vec3::splat(4.5).extend(0.0)] {
        let ray = shadow_ray(light, Vec3::splat(4.5), Vec3::splat(9.0));
        assert!(ray.is_finite() && ray.w <= 16.0, "{light}: {ray}");
    }
    assert!((optical_depth_of_steps(0, 3) / (3.0 * 65536.0) - 1.0).abs() < 1e-6);
    let across = [0.0, 1.0, 1e30, f32::INFINITY, f32::NAN].map(|depth| shadow_position(depth, Vec3::X, Vec3::Z).x);
    assert!(across.iter().zip([0.0, 0.5, 1.0, 1.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{across:?}");
    for (slot, block, expected) in
        [(0.0, 0.0, 0.0), (1.0, 0.0, 5.0), (2.0, 0.0, 6.0), (3.0, 0.0, 7.0), (4.0, 1.0, 5.0), (15.0, 4.0, 7.0)]
    {
        let select_slot = select_slot(slot, vec3(5.0, 6.0, 7.0));
        let of_block = block_of_slot(slot);
        assert!((select_slot - expected).abs() < 1e-6 && (of_block - block).abs() < 1e-6, "{slot}");
    }
}

#[test]
fn the_steps_of_a_march_are_spread_evenly_over_the_disc_of_the_light() {
    for direction in [Vec3::Y, Vec3::NEG_X, vec3(0.3, -0.7, 0.6).normalize()] {
        let offsets: Vec<Vec3> = (0..SHADOW_STEPS).map(|step| light_disc_offset(step, direction)).collect();
        assert!(offsets.iter().all(|offset| offset.length() < 1.0 && offset.dot(direction).abs() < 1e-5));
        // The mean is the center; the mean square of the distance is a half.
        let count = SHADOW_STEPS as f32;
        let mean = offsets.iter().sum::<Vec3>() / count;
        let square = offsets.iter().map(|offset| offset.length_squared()).sum::<f32>() / count;
        assert!(mean.length() < 0.05 && (square - 0.5).abs() < 0.03, "{mean} {square}");
    }
}

#[test]
fn as_many_lights_can_be_set_as_can_cast_shadow() {
    let is_valid = |lights: usize| {
        let mut settings = Settings::default();
        settings.shadow.lights = lights as u32;
        settings.validate(String::new).is_ok()
    };
    assert!(is_valid(SHADOWED_LIGHTS) && !is_valid(SHADOWED_LIGHTS + 1));
}
