// Gradient noise on a lattice of spacing 1, with lattice gradients that rotate.

#import "lib/hash.wgsl"

// Noise and its gradient at a point.
struct Noise {
    value: f32,
    gradient: vec3f,
}

// Gradient at a lattice point: two random vectors, the first weighted by cos, the second by sin.
fn lattice_gradient(at: vec3i, phase: vec2f, seed: u32) -> vec3f {
    let hash = pcg3d(vec3u(at) + vec3u(seed, seed ^ 0x9e3779b9u, 0u));
    let first = vec3f(hash >> vec3u(16u)) * (2.0 / 65535.0) - 1.0;
    let second = vec3f(hash & vec3u(0xffffu)) * (2.0 / 65535.0) - 1.0;
    return first * phase.x + second * phase.y;
}

// Gradient noise. `phase` is (cos, sin). (Perlin, "Improving noise", 2002; rotation: Perlin and Neyret, "Flow noise",
// 2001)
fn gradient_noise(position: vec3f, phase: vec2f, seed: u32) -> Noise {
    let cell = floor(position);
    let f = position - cell;
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let slope = f * f * 30.0 * (f * (f - 2.0) + 1.0);
    var noise = Noise(0.0, vec3f(0.0));
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let lattice = lattice_gradient(vec3i(cell) + vec3i(offset), phase, seed);
        let along = dot(lattice, f - vec3f(offset));
        // Weight of the corner along each axis, and its derivative.
        let is_far = offset == vec3u(1u);
        let w = select(1.0 - fade, fade, is_far);
        let s = select(-slope, slope, is_far);
        let weight = w.x * w.y * w.z;
        noise.value += weight * along;
        noise.gradient += lattice * weight + vec3f(s.x * w.y * w.z, w.x * s.y * w.z, w.x * w.y * s.z) * along;
    }
    return noise;
}

// Divergence-free flow: the curl of three noise fields. (Bridson, Hourihan and Nordenstam, "Curl-noise for procedural
// fluid flow", 2007)
fn curl_noise(position: vec3f, phase: vec2f, seed: u32) -> vec3f {
    let x = gradient_noise(position, phase, seed).gradient;
    let y = gradient_noise(position, phase, seed + 1u).gradient;
    let z = gradient_noise(position, phase, seed + 2u).gradient;
    return vec3f(z.y - y.z, x.z - z.x, y.x - x.y);
}
