// One sprite of a particle system, in the layout of `Particle` in crates/haze_core/src/frame/particle.rs.

struct Particle {
    // World space; radius in w.
    @location(0) position_radius: vec4f,
    // Rotation, amount, frame, age.
    @location(1) rotation_amount_frame_age: vec4f,
    // World space, metres per second.
    @location(2) velocity: vec3f,
    // Tint in rgb, heat in a.
    @location(3) tint_heat: vec4f,
}

// Vectors of four words per particle in a storage buffer. Words, because the bits of tint and heat may be those of a NaN,
// which a copy as float need not keep.
const PARTICLE_VECTORS: u32 = 3u;

fn particle_from_words(first: vec4u, second: vec4u, third: vec4u) -> Particle {
    return Particle(
        bitcast<vec4f>(first),
        bitcast<vec4f>(second),
        bitcast<vec3f>(third.xyz),
        unpack4x8unorm(third.w),
    );
}
