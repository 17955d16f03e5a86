// Grain: noise that is finer than the texels of a sprite. It eats the thin parts of the sprite, and tilts its normals.

#import "lib/noise_volume.wgsl"

// Axes of the plane through the noise that a sprite shows. It is oblique, so that the noise does not repeat side by side.
// One loop of the flipbook moves the plane by one tile along each axis, which is across it: the noise changes in place,
// and loops too.
const GRAIN_RIGHT: vec3f = vec3f(0.80409, -0.52483, -0.27926);
const GRAIN_DOWN: vec3f = vec3f(0.14178, 0.62548, -0.76725);

// Density that half of the noise is above.
const MIDDLE_DENSITY: f32 = 0.5;

// Fraction of an octave that a target can show. `fineness`: texels of the noise per texel of the target.
fn octave_fraction(fineness: f32) -> f32 {
    return saturate(1.5 / max(fineness, 1.0e-6) - 0.5);
}

// Noise at a position on a sprite: the tilt of the normal (xy, y up), and the density above the middle (z). `phase`: fraction
// of the flipbook's loop that has passed. `tiles`: of the noise, across the sprite. `fineness`: of the first octave, as above.
fn sample_grain(
    noise: texture_3d<f32>,
    repeat_sampler: sampler,
    uv: vec2f,
    phase: f32,
    tiles: f32,
    fineness: f32,
    octaves: u32,
) -> vec3f {
    var sum = vec4f(0.0);
    var total = 0.0;
    var position = (GRAIN_RIGHT * uv.x + GRAIN_DOWN * uv.y) * tiles + phase;
    var weight = 1.0;
    var fine = fineness;
    for (var octave = 0u; octave < octaves; octave++) {
        let fraction = weight * octave_fraction(fine);
        // On GPUs this saves the lookups of octaves that do not show.
        if fraction > 0.0 {
            sum += sample_noise_volume(noise, repeat_sampler, position) * fraction;
            total += fraction;
        }
        position *= 3.0;
        fine *= 3.0;
        weight *= 0.5;
    }
    // The texels' offset of 1/2 along all axes is perpendicular to the plane.
    let gradient = 2.0 * sum.xyz;
    return vec3f(dot(gradient, GRAIN_RIGHT), -dot(gradient, GRAIN_DOWN), sum.w - MIDDLE_DENSITY * total);
}

// Erosion of a sprite at an age.
fn sprite_erosion(erosion: f32, dissolve: f32, age: f32) -> f32 {
    return saturate(erosion + dissolve * saturate(age));
}

// Amount of a sprite's image after erosion: the higher it is, the more noise it withstands. `density`: of sample_grain().
fn eroded(amount: f32, density: f32, erosion: f32) -> f32 {
    let threshold = erosion * saturate(MIDDLE_DENSITY - density);
    return saturate((amount - threshold) / max(1.0 - threshold, 0.01));
}

// Fraction of a sprite's density that erosion keeps. `eroded_fraction`: the same at an erosion of 1.
fn kept_fraction(eroded_fraction: f32, erosion: f32) -> f32 {
    return 1.0 - (1.0 - eroded_fraction) * erosion;
}

// Normal with a tilt, at most of unit length.
fn tilted_normal(normal: vec3f, tilt: vec2f) -> vec3f {
    let turned = normal + vec3f(tilt, 0.0);
    return turned * inverseSqrt(max(dot(turned, turned), 1.0));
}
