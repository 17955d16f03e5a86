//! Conversion between light directions and azimuth/elevation angles.

use glam::Vec3;

/// Direction that light comes from, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// Angle about the vertical axis: 0 is +z, 90 is +x.
    pub azimuth: f32,
    /// Angle above the horizon.
    pub elevation: f32,
}

/// Largest elevation up or down, degrees. A vertical direction has no azimuth, so a light at ±90 would lose its
/// azimuth.
pub const MAX_ELEVATION: f32 = 89.9;

/// Returns the angles that light comes from, given the direction it travels in.
pub fn to_angles(direction: Vec3) -> Angles {
    let from = -direction.normalize_or(Vec3::NEG_Y);
    let level = from.x.hypot(from.z);
    Angles { azimuth: from.x.atan2(from.z).to_degrees(), elevation: from.y.atan2(level).to_degrees() }
}

/// Returns the unit direction that light from these angles travels in. Clamps the elevation to ±[`MAX_ELEVATION`].
pub fn from_angles(angles: Angles) -> Vec3 {
    let elevation = angles.elevation.clamp(-MAX_ELEVATION, MAX_ELEVATION).to_radians();
    let (sine, cosine) = angles.azimuth.to_radians().sin_cos();
    -Vec3::new(sine * elevation.cos(), elevation.sin(), cosine * elevation.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_round_trip_and_steep_elevation_keeps_the_azimuth() {
        for azimuth in [-170.0, -90.0, 0.0, 12.5, 90.0, 179.0] {
            for elevation in [-90.0, -60.0, 0.0, 45.0, 89.0, 90.0, 120.0] {
                let back = to_angles(from_angles(Angles { azimuth, elevation }));
                assert!((back.azimuth - azimuth).abs() < 0.05, "{azimuth} {elevation}: {back:?}");
                assert!(
                    (back.elevation - elevation.clamp(-MAX_ELEVATION, MAX_ELEVATION)).abs() < 0.05,
                    "{elevation}: {back:?}"
                );
            }
        }
        assert!(from_angles(Angles { azimuth: 90.0, elevation: 0.0 }).distance(Vec3::NEG_X) < 1e-6);
        assert!((to_angles(Vec3::NEG_Y).elevation - 90.0).abs() < 1e-4);
    }
}
