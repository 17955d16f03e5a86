// Sprites that are stretched along their motion, as a camera with an open shutter sees them.
//
// A stretch is a vector q along the motion on the screen. It stands for the matrix (I - q qᵀ)⁻¹, which scales by
// 1 / (1 - |q|²) along q and leaves the other axis as it is. Its inverse I - q qᵀ takes positions back to the sprite, and
// normals forward.

// Length of a stretched sprite, in lengths of the sprite at rest. `length`: of its path, metres.
fn stretch_ratio(length: f32, radius: f32, limit: f32) -> f32 {
    return min(1.0 + 0.5 * length / max(radius, 1.0e-6), limit);
}

// Velocity across the line of sight at a particle's depth. `center` and `velocity`: view space.
fn velocity_on_screen(center: vec3f, velocity: vec3f, orthographic: f32) -> vec2f {
    let approach = velocity.z * (1.0 - orthographic) / max(-center.z, 1.0e-3);
    return velocity.xy + center.xy * approach;
}

// Stretch of a sprite. `seconds`: time for which the shutter is open.
fn sprite_stretch(
    center: vec3f,
    velocity: vec3f,
    seconds: f32,
    radius: f32,
    limit: f32,
    orthographic: f32,
) -> vec2f {
    let across = velocity_on_screen(center, velocity, orthographic);
    let speed = length(across);
    // Beside the viewer, a particle that comes closer passes faster than it moves.
    let ratio = stretch_ratio(min(speed, length(velocity)) * seconds, radius, limit);
    return across * (sqrt(max(1.0 - 1.0 / ratio, 0.0)) / max(speed, 1.0e-6));
}

// Least radius of a stretched sprite, texels of the target. Thinner ones would flicker from texel to texel.
const MIN_RADIUS: f32 = 0.75;

// Fraction of its amount that a sprite keeps if its radius grows from `radius` to `wide`, so that it hides as much as before.
// `thin` and `stretch`: its stretch with either radius.
fn widened_fraction(radius: f32, wide: f32, thin: vec2f, stretch: vec2f) -> f32 {
    let ratio = radius / max(wide, 1.0e-9);
    return min(ratio * ratio * (1.0 - dot(stretch, stretch)) / max(1.0 - dot(thin, thin), 1.0e-4), 1.0);
}

// Position on a sprite at rest to its position on the stretched one, relative to the center.
fn stretched(position: vec2f, stretch: vec2f) -> vec2f {
    return position + stretch * (dot(stretch, position) / max(1.0 - dot(stretch, stretch), 1.0e-4));
}

// Inverse of stretched().
fn unstretched(position: vec2f, stretch: vec2f) -> vec2f {
    return position - stretch * dot(stretch, position);
}

// Normal on a stretched sprite, of the same length.
fn stretched_normal(normal: vec3f, stretch: vec2f) -> vec3f {
    let turned = vec3f(unstretched(normal.xy, stretch), normal.z);
    return turned * sqrt(dot(normal, normal) / max(dot(turned, turned), 1.0e-8));
}
