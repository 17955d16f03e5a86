//! Sampling of the tiling 3D noise of volumetric sprites. WGSL: `shaders/lib/noise_volume.wgsl`.

use glam::{IVec3, Vec3, Vec4, Vec4Swizzles};

use super::texture::Texture3d;

/// Texel at a position, which wraps around.
pub fn load_noise_volume(noise: &impl Texture3d, texel: IVec3) -> Vec4 {
    noise.load(texel.rem_euclid(IVec3::splat(noise.dimensions() as i32)).as_uvec3())
}

/// Samples the noise, which repeats with every unit of `coordinate`: rgb = inverse density gradient / 2 + 1/2, a = density.
pub fn sample_noise_volume(noise: &impl Texture3d, coordinate: Vec3) -> Vec4 {
    let size = noise.dimensions() as i32;
    let at = (coordinate - coordinate.floor()) * size as f32 - 0.5;
    let base = at.floor();
    let f = at - base;
    let load = |x, y, z| load_noise_volume(noise, base.as_ivec3() + IVec3::new(x, y, z));
    let slice = |z| {
        let row = |y| load(0, y, z).lerp(load(1, y, z), f.x);
        row(0).lerp(row(1), f.y)
    };
    slice(0).lerp(slice(1), f.z)
}

/// Sums octaves of the noise: inverse density gradient (−1..1) and density. Each has three times the frequency and half the weight of the one before; weights sum to
/// 1. (MS)
pub fn sample_noise_octaves(noise: &impl Texture3d, coordinate: Vec3, octaves: u32) -> Vec4 {
    let mut sum = Vec4::ZERO;
    let mut total = 0.0;
    let mut weight = 1.0;
    let mut position = coordinate;
    for _ in 0..octaves {
        sum += sample_noise_volume(noise, position) * weight;
        total += weight;
        weight *= 0.5;
        position *= 3.0;
    }
    let texel = sum / total;
    (texel.xyz() * 2.0 - 1.0).extend(texel.w)
}

/// Noise coordinate of a point. `from_eye` is its position relative to the eye, in world axes; `noise_offset` is the
/// position of the eye minus the rise of the noise. (MS "Animating the volume particles")
pub fn noise_coordinate(from_eye: Vec3, noise_size: f32, noise_offset: Vec3) -> Vec3 {
    (from_eye + noise_offset) / noise_size
}
