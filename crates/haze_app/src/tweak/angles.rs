//! Directions of light as angles.

use glam::Vec3;

/// Where light comes from, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// About the vertical: 0 is from +z, 90 from +x.
    pub azimuth: f32,
    /// Above the horizon.
    pub elevation: f32,
}

/// Highest and lowest: straight down has no azimuth, and a light that went there would forget its own.
pub const STEEPEST: f32 = 89.9;

/// Where light comes from that travels in a direction.
pub fn to_angles(direction: Vec3) -> Angles {
    let from = -direction.normalize_or(Vec3::NEG_Y);
    let level = from.x.hypot(from.z);
    Angles { azimuth: from.x.atan2(from.z).to_degrees(), elevation: from.y.atan2(level).to_degrees() }
}

/// The direction in which such light travels, of unit length.
pub fn from_angles(angles: Angles) -> Vec3 {
    let elevation = angles.elevation.clamp(-STEEPEST, STEEPEST).to_radians();
    let (sine, cosine) = angles.azimuth.to_radians().sin_cos();
    -Vec3::new(sine * elevation.cos(), elevation.sin(), cosine * elevation.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back_and_elevation_never_turns_azimuth() {
        for azimuth in [-170.0, -90.0, 0.0, 12.5, 90.0, 179.0] {
            for elevation in [-90.0, -60.0, 0.0, 45.0, 89.0, 90.0, 120.0] {
                let back = to_angles(from_angles(Angles { azimuth, elevation }));
                assert!((back.azimuth - azimuth).abs() < 0.05, "{azimuth} {elevation}: {back:?}");
                assert!((back.elevation - elevation.clamp(-STEEPEST, STEEPEST)).abs() < 0.05, "{elevation}: {back:?}");
            }
        }
        assert!(from_angles(Angles { azimuth: 90.0, elevation: 0.0 }).distance(Vec3::NEG_X) < 1e-6);
        assert!((to_angles(Vec3::NEG_Y).elevation - 90.0).abs() < 1e-4);
    }
}
