// Integer hashes, and random numbers from them.

// Hashes three words to three random words. (Jarzynski and Olano, "Hash functions for GPU rendering", 2020, pcg3d)
fn pcg3d(words: vec3u) -> vec3u {
    var v = words * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v = v ^ (v >> vec3u(16u));
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Maps the upper 24 bits of a random word to 0..1, exactly in f32.
fn unit(word: u32) -> f32 {
    return f32(word >> 8u) * (1.0 / 16777216.0);
}

const TURN: f32 = 6.283185307179586;

// Returns a uniformly distributed direction. Uses y and z, so that x is free for a distance.
fn unit_sphere(random: vec3f) -> vec3f {
    let z = random.z * 2.0 - 1.0;
    let angle = random.y * TURN;
    let level = vec2f(cos(angle), sin(angle)) * sqrt(1.0 - z * z);
    return vec3f(level.x, z, level.y);
}

// Returns three random numbers, 0..1, for a birth and a salt.
fn birth_random(index: u32, salt: u32, seed: u32) -> vec3f {
    let hash = pcg3d(vec3u(index, salt, seed));
    return vec3f(unit(hash.x), unit(hash.y), unit(hash.z));
}
