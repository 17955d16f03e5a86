//! Baked diffuse light by normal: cubemap, motif and spherical harmonics. WGSL: `shaders/lib/diffuse_bake.wgsl`.

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};

use super::ramp::sample_ramp_2d;
use super::texture::Texture2d;
use crate::settings::{DiffuseMode, RampFilter};

/// Side and layer count of the texture that a mode bakes into; `None` for modes that bake nothing. A ramp's gradient is
/// broad, so 32 texels across 90 degrees resolve it. The motif gets twice that, because a sphere is foreshortened at
/// its rim.
pub fn baked_size_and_layers(mode: DiffuseMode) -> Option<(u32, u32)> {
    match mode {
        DiffuseMode::Cubemap => Some((32, 6)),
        DiffuseMode::Motif => Some((64, 1)),
        DiffuseMode::Ramp | DiffuseMode::PaintedMotif | DiffuseMode::SphericalHarmonics => None,
    }
}

/// Position on a face of a cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeCoordinate {
    /// Face 0..6: +x −x +y −y +z −z.
    pub face: i32,
    /// Position on the face, −1..1.
    pub position: Vec2,
}

/// Direction (not normalised) of a point on a face.
pub fn cube_direction(face: i32, position: Vec2) -> Vec3 {
    let Vec2 { x, y } = position;
    match face {
        0 => Vec3::new(1.0, y, -x),
        1 => Vec3::new(-1.0, y, x),
        2 => Vec3::new(x, 1.0, -y),
        3 => Vec3::new(x, -1.0, y),
        4 => Vec3::new(x, y, 1.0),
        _ => Vec3::new(-x, y, -1.0),
    }
}

/// Face and point that a direction hits. The direction need not be normalised.
pub fn cube_coordinate(direction: Vec3) -> CubeCoordinate {
    let size = direction.abs();
    let d = direction / size.max_element().max(1.0e-12);
    let (face, position) = if size.x >= size.y && size.x >= size.z {
        if d.x > 0.0 { (0, Vec2::new(-d.z, d.y)) } else { (1, Vec2::new(d.z, d.y)) }
    } else if size.y >= size.z {
        if d.y > 0.0 { (2, Vec2::new(d.x, -d.z)) } else { (3, Vec2::new(d.x, d.z)) }
    } else if d.z > 0.0 {
        (4, Vec2::new(d.x, d.y))
    } else {
        (5, Vec2::new(-d.x, d.y))
    };
    CubeCoordinate { face, position }
}

/// Normal seen at a point (−1..1) of an image of a sphere. Outside the disc it is the normal of the nearest rim point.
pub fn motif_normal(position: Vec2) -> Vec3 {
    let square = position.length_squared();
    if square >= 1.0 { (position / square.sqrt()).extend(0.0) } else { position.extend((1.0 - square).sqrt()) }
}

/// Position (−1..1) of a normal in an image of a sphere. Normals that face away map to the rim.
pub fn motif_position(normal: Vec3) -> Vec2 {
    if normal.z >= 0.0 {
        return normal.xy();
    }
    normal.xy() / normal.xy().length_squared().max(1.0e-12).sqrt()
}

/// Samples the baked light of one face or of the motif. `position` is −1..1; the first row is at −1.
pub fn sample_baked(baked: &impl Texture2d, position: Vec2) -> Vec3 {
    sample_ramp_2d(baked, RampFilter::Bilinear, position * 0.5 + 0.5)
}

/// The nine real spherical-harmonic basis functions up to L2 in a direction, in the order of the coefficients.
pub fn spherical_harmonics_basis(n: Vec3) -> [f32; 9] {
    [
        0.282_094_79,
        0.488_602_51 * n.y,
        0.488_602_51 * n.z,
        0.488_602_51 * n.x,
        1.092_548_4 * n.x * n.y,
        1.092_548_4 * n.y * n.z,
        0.315_391_57 * (3.0 * n.z * n.z - 1.0),
        1.092_548_4 * n.x * n.z,
        0.546_274_2 * (n.x * n.x - n.y * n.y),
    ]
}

/// Light on a normal from nine coefficients, clamped to 0 or more.
pub fn spherical_harmonics(coefficients: &[Vec4; 9], n: Vec3) -> Vec3 {
    let basis = spherical_harmonics_basis(n);
    let light: Vec3 = coefficients.iter().zip(basis).map(|(c, b)| c.xyz() * b).sum();
    light.max(Vec3::ZERO)
}

/// Zonal coefficients up to L2 of a function of cos θ: `z[l] = ∫ f(cos θ) Y_l0 dω`.
pub fn zonal_coefficients(f: impl Fn(f32) -> Vec3) -> [Vec3; 3] {
    const STEPS: usize = 256;
    let mut zonal = [Vec3::ZERO; 3];
    for step in 0..STEPS {
        let cos = (step as f32 + 0.5) / STEPS as f32 * 2.0 - 1.0;
        // dω = 2π d(cos θ)
        let weight = std::f32::consts::TAU * 2.0 / STEPS as f32;
        let legendre = [0.282_094_79, 0.488_602_51 * cos, 0.315_391_57 * (3.0 * cos * cos - 1.0)];
        for (z, l) in zonal.iter_mut().zip(legendre) {
            *z += f(cos) * l * weight;
        }
    }
    zonal
}

/// Adds one light to the nine coefficients, as seen through a ramp with these zonal coefficients. A zonal function
/// rotated to `direction` has c_lm = √(4π / (2l + 1)) · z_l · Y_lm(direction). (Sloan, "Stupid Spherical Harmonics
/// Tricks", 2008)
pub fn add_light(coefficients: &mut [Vec4; 9], zonal: &[Vec3; 3], direction: Vec3, color: Vec3) {
    const BAND: [usize; 9] = [0, 1, 1, 1, 2, 2, 2, 2, 2];
    for ((c, basis), band) in coefficients.iter_mut().zip(spherical_harmonics_basis(direction)).zip(BAND) {
        let turn = (4.0 * std::f32::consts::PI / (2 * band + 1) as f32).sqrt();
        *c += (zonal[band] * color * (turn * basis)).extend(0.0);
    }
}
