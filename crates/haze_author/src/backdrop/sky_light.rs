//! Light of an environment on matte surfaces: spherical harmonics up to the second order.
//!
//! Source: Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps", 2001.

use glam::Vec3;
use haze_core::formula::ambient::hemisphere_light;

/// Light that a white matte surface shows, by its normal. A shader evaluates the same polynomial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkyLight {
    /// Coefficients of 1, y, z, x, xy, yz, 3y²−1, xz, z²−x² of the normal: y is the axis of the harmonics.
    pub coefficients: [Vec3; 9],
}

/// Squares of the factors of the harmonics, times the fraction of each order in matte light: 1, 2/3, 1/4.
const FACTORS: [f32; 9] = {
    const FIRST: f32 = 2.0 / 3.0 * 0.488_602_5 * 0.488_602_5;
    const MIXED: f32 = 0.25 * 1.092_548_4 * 1.092_548_4;
    const AXIAL: f32 = 0.25 * 0.315_391_57 * 0.315_391_57;
    const CROSS: f32 = 0.25 * 0.546_274_2 * 0.546_274_2;
    [0.282_094_8 * 0.282_094_8, FIRST, FIRST, FIRST, MIXED, MIXED, AXIAL, MIXED, CROSS]
};

/// Values of the polynomials of [`SkyLight::coefficients`].
fn polynomials(Vec3 { x, y, z }: Vec3) -> [f32; 9] {
    [1.0, y, z, x, x * y, y * z, 3.0 * y * y - 1.0, x * z, z * z - x * x]
}

impl SkyLight {
    /// Light of an even sky above and an even ground below, as surfaces that face them show it.
    pub fn of_hemispheres(sky: Vec3, ground: Vec3) -> Self {
        let mut light = Self::default();
        light.coefficients[0] = 0.5 * (sky + ground);
        light.coefficients[1] = 0.5 * (sky - ground);
        light
    }

    /// Adds light that comes from around a direction. `solid_angle`: its part of the sphere, steradians.
    pub fn add(&mut self, direction: Vec3, radiance: Vec3, solid_angle: f32) {
        let terms = polynomials(direction).into_iter().zip(FACTORS);
        for (sum, (value, factor)) in self.coefficients.iter_mut().zip(terms) {
            *sum += radiance * (value * factor * solid_angle);
        }
    }

    /// The same light, brighter.
    pub fn scaled(self, factor: f32) -> Self {
        Self { coefficients: self.coefficients.map(|color| color * factor) }
    }

    /// Light that a white matte surface with this unit normal shows. Not below 0, where a strong light from one side would
    /// take the polynomial.
    pub fn on(&self, normal: Vec3) -> Vec3 {
        let terms = self.coefficients.into_iter().zip(polynomials(normal));
        terms.map(|(color, value)| color * value).sum::<Vec3>().max(Vec3::ZERO)
    }

    /// Light of the hemispheres above and below, for smoke: see [`hemisphere_light`].
    pub fn hemispheres(&self) -> [Vec3; 2] {
        hemisphere_light(self.coefficients[0], self.coefficients[1])
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::*;

    /// Even steps in latitude and longitude, with their solid angles.
    fn sphere() -> impl Iterator<Item = (Vec3, f32)> {
        const ROWS: u32 = 200;
        (0..ROWS).flat_map(|row| {
            let (sin, cos) = ((row as f32 + 0.5) / ROWS as f32 * PI).sin_cos();
            (0..2 * ROWS).map(move |column| {
                let (across, along) = ((column as f32 + 0.5) / ROWS as f32 * PI).sin_cos();
                (Vec3::new(sin * along, cos, sin * across), sin * (PI / ROWS as f32).powi(2))
            })
        })
    }

    #[test]
    fn matte_surfaces_show_what_an_integral_over_the_cosine_gives() {
        // Of the second order at most, for which nine coefficients are exact.
        let radiance =
            |d: Vec3| Vec3::new(1.0, 0.8 + d.y * 0.5 + d.x * 0.3, 1.0 + d.x * d.y + 0.5 * d.z * d.z - 0.2 * d.x * d.z);
        let mut light = SkyLight::default();
        sphere().for_each(|(direction, angle)| light.add(direction, radiance(direction), angle));
        for normal in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.6, 0.64)] {
            let integral: Vec3 = sphere()
                .map(|(direction, angle)| radiance(direction) * (direction.dot(normal).max(0.0) * angle / PI))
                .sum();
            let shown = light.on(normal);
            assert!(shown.abs_diff_eq(integral, 2e-3), "{normal}: {shown} and {integral}");
        }
        assert!((light.on(Vec3::X).x - 1.0).abs() < 1e-3, "even light on white is that light");
    }

    #[test]
    fn hemispheres_come_back() {
        let sky = Vec3::new(0.2, 0.4, 0.9);
        let ground = Vec3::new(0.3, 0.2, 0.1);
        let light = SkyLight::of_hemispheres(sky, ground);
        let [up, down] = light.hemispheres();
        assert!(up.abs_diff_eq(sky, 1e-6) && down.abs_diff_eq(ground, 1e-6));
        assert!(light.on(Vec3::Y).abs_diff_eq(sky, 1e-6) && light.on(Vec3::X).abs_diff_eq(0.5 * (sky + ground), 1e-6));
    }
}
