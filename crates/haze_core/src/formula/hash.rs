//! Integer hashes, the same in WGSL bit for bit, and random numbers from them. WGSL: `shaders/lib/hash.wgsl`.

use glam::{UVec3, Vec2, Vec3};

/// Hashes three words to three random words. (Jarzynski and Olano, "Hash functions for GPU rendering", 2020, pcg3d)
pub fn pcg3d(v: UVec3) -> UVec3 {
    let [mut x, mut y, mut z] = v.to_array().map(|c| c.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |x: &mut u32, y: &mut u32, z: &mut u32| {
        *x = x.wrapping_add(y.wrapping_mul(*z));
        *y = y.wrapping_add(z.wrapping_mul(*x));
        *z = z.wrapping_add(x.wrapping_mul(*y));
    };
    mix(&mut x, &mut y, &mut z);
    [x, y, z] = [x, y, z].map(|c| c ^ (c >> 16));
    mix(&mut x, &mut y, &mut z);
    UVec3::new(x, y, z)
}

/// Maps the upper 24 bits of a random word to 0..1, exactly in f32.
pub fn unit(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Uniformly distributed direction. Uses y and z only, so that x is free for a distance.
pub fn unit_sphere(random: Vec3) -> Vec3 {
    let z = random.z * 2.0 - 1.0;
    let xy = Vec2::from_angle(random.y * std::f32::consts::TAU) * (1.0 - z * z).sqrt();
    Vec3::new(xy.x, z, xy.y)
}

/// Three random numbers 0..1 for a birth and a salt.
pub fn birth_random(index: u32, salt: u32, seed: u32) -> Vec3 {
    let hash = pcg3d(UVec3::new(index, salt, seed));
    Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z))
}
