// Divergence-free noise: a flow that swirls and does not bunch up.

#import "lib/hash.wgsl"

// Root mean square of each component of the curl below, so that the noise has 1.
const SWIRL_RMS: f32 = 0.02286;

// Simplex coordinates of a point, in which the corners of the simplices are integers.
fn skewed(position: vec3f) -> vec3f {
    return position + (position.x + position.y + position.z) / 3.0;
}

// Three numbers from -1 to 1, of 10 bits each.
fn unpack_signed(word: u32) -> vec3f {
    return vec3f((vec3u(word) >> vec3u(22u, 12u, 2u)) & vec3u(1023u)) * (2.0 / 1023.0) - 1.0;
}

// Curl of the vector potential (0.5 - d·d)^4 G·d of a corner, at a distance d from it. G is a random matrix whose rows
// take each other's places as the phase (cos, sin) turns.
fn corner_curl(corner: vec3i, d: vec3f, phase: vec2f, seed: u32) -> vec3f {
    let near = max(0.5 - dot(d, d), 0.0);
    let hash = pcg3d(vec3u(corner) + vec3u(seed, seed ^ 0x9e3779b9u, 0u));
    let a = unpack_signed(hash.x);
    let b = unpack_signed(hash.y);
    let c = unpack_signed(hash.z);
    let x = a * phase.x + b * phase.y;
    let y = b * phase.x + c * phase.y;
    let z = c * phase.x + a * phase.y;
    let potential = vec3f(dot(x, d), dot(y, d), dot(z, d));
    let curl = vec3f(z.y - y.z, x.z - z.x, y.x - x.y);
    let cube = near * near * near;
    return cube * (near * curl - 8.0 * cross(d, potential));
}

// Divergence-free noise at simplex coordinates, whose corners have the numbers of a lattice that begins at `first`.
// (Bridson, Hourihan and Nordenstam, "Curl-noise for procedural fluid flow", 2007, on simplices)
fn swirl_noise(at: vec3f, first: vec3i, phase: vec2f, seed: u32) -> vec3f {
    let cell = floor(at);
    let f = at - cell;
    let origin = vec3i(cell) + first;
    // From the first corner, in world space.
    let d = f - (f.x + f.y + f.z) / 6.0;
    // The corners between lie along the largest coordinate, then the next.
    let x = vec3i(vec3<bool>(f.x >= f.y, f.y > f.x, f.z > f.x));
    let y = vec3i(vec3<bool>(f.x >= f.z, f.y >= f.z, f.z > f.y));
    let rank = x + y;
    let second = vec3i(rank == vec3i(2i));
    let third = vec3i(rank >= vec3i(1i));
    var sum = corner_curl(origin, d, phase, seed);
    sum += corner_curl(origin + second, d - vec3f(second) + 1.0 / 6.0, phase, seed);
    sum += corner_curl(origin + third, d - vec3f(third) + 1.0 / 3.0, phase, seed);
    sum += corner_curl(origin + 1i, d - 0.5, phase, seed);
    return sum / SWIRL_RMS;
}
