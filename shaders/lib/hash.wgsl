// Integer hashes.

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
