// Formulas of the techniques, by which sprites meet the scene. docs/techniques.md compares them.

const TECHNIQUE_HARD: u32 = 0u;
const TECHNIQUE_SOFT: u32 = 1u;
const TECHNIQUE_SOFT_LINEAR: u32 = 2u;
const TECHNIQUE_DEPTH_SPRITE_HARD: u32 = 3u;
const TECHNIQUE_DEPTH_SPRITE_SOFT: u32 = 4u;
const TECHNIQUE_SPHERICAL_BILLBOARD: u32 = 5u;
const TECHNIQUE_DENSITY: u32 = 6u;
const TECHNIQUE_VOLUMETRIC_HARD: u32 = 7u;
const TECHNIQUE_VOLUMETRIC_SOFT: u32 = 8u;

// 1 in front of the scene or on it, 0 behind it: the result of the hardware's depth test. (NV 3)
fn hard_fade(distance: f32) -> f32 {
    return select(0.0, 1.0, distance >= 0.0);
}

// View depth of a texel that is displaced towards the viewer by `offset` radii, -1..1. (MS "2D particles with depth")
fn depth_sprite_depth(view_depth: f32, offset: f32, radius: f32) -> f32 {
    return view_depth - offset * radius;
}

// Part of a ray inside a sphere, clipped at the near plane and at the scene. All distances are along the ray, metres.
struct RayInterval {
    enter: f32,
    // The interval is empty if leave <= enter.
    leave: f32,
    // Vector from the center of the sphere to the nearest point of the ray's line.
    axis: vec3f,
}

// Intersects a ray of unit length with a sphere. `near` and `scene` are distances along the ray. Half the chord is w =
// sqrt(r² - q²). (BLOG 2)
fn ray_sphere(origin: vec3f, direction: vec3f, center: vec3f, radius: f32, near: f32, scene: f32) -> RayInterval {
    let to_center = center - origin;
    let middle = dot(to_center, direction);
    let axis = direction * middle - to_center;
    let half_chord = sqrt(max(radius * radius - dot(axis, axis), 0.0));
    return RayInterval(max(middle - half_chord, near), min(middle + half_chord, scene), axis);
}

// Umenhoffer's spherical billboard: a = 1 - exp(-density · (1 - q/r) · Δs), where Δs is the length of the ray inside
// the sphere, between near plane and scene. (BLOG 2)
fn spherical_billboard_amount(density: f32, axis_distance: f32, radius: f32, stretch: f32) -> f32 {
    let inwards = saturate(1.0 - axis_distance / max(radius, 1.0e-6));
    return 1.0 - exp(-density * inwards * max(stretch, 0.0));
}

// Thickness of the slab between near plane and scene, metres. The slab extends one radius in front of the sprite and
// one behind it.
fn density_thickness(view_depth: f32, radius: f32, near: f32, scene: f32) -> f32 {
    return max(min(scene, view_depth + radius) - max(near, view_depth - radius), 0.0);
}

// Fraction of that slab that lies beyond the near plane.
fn visible_slab_fraction(view_depth: f32, radius: f32, near: f32) -> f32 {
    return saturate((view_depth + radius - near) / max(2.0 * radius, 1.0e-6));
}

// Amount of a slab, with the sprite's alpha as density: a = 1 - exp(-density · thickness). (BLOG 3)
fn density_amount(density: f32, thickness: f32) -> f32 {
    return 1.0 - exp(-density * thickness);
}

// Falloff of a volume from its center. `position` is the position in the sphere, -1..1. (MS "March", step 3)
fn volumetric_falloff(position: vec3f) -> f32 {
    return saturate(1.0 - dot(position, position));
}

// Density of a volume, 0..1: noise that is eroded from the outside in. (MS "March", steps 1 and 3)
fn volumetric_density(noise: f32, falloff: f32) -> f32 {
    return saturate(2.0 * noise - 1.0 + falloff) * falloff;
}

// Position where a step of a march ends, as a fraction of the way through a sphere. `done` is the fraction of the steps. Steps
// are shortest in the middle, where a volume is densest: 7 of them reach the error of 8 equal ones.
fn march_boundary(done: f32) -> f32 {
    let from_middle = 2.0 * done - 1.0;
    let squared = from_middle * from_middle;
    return 0.5 + from_middle * (2.0 + squared * squared) / 6.0;
}

// View-space normal at a point of a volume: out of the sphere and down the noise's density. Normals that face away are
// turned sideways, so that steps and sprites behind each other never cancel. (MS "March", step 2)
fn volumetric_normal(position: vec3f, gradient: vec3f) -> vec3f {
    let normal = position + 2.0 * gradient;
    return normalize(vec3f(normal.xy, max(normal.z, 0.1)));
}

// Lower and upper bound of a sphere's projection on one axis, as position / depth, clipped at the near plane. `center`
// is (position on the axis, depth). (Mara and McGuire, "2D polyhedral bounds of a clipped, perspective-projected 3D
// sphere", JCGT 2013)
fn sphere_axis_bounds(center: vec2f, radius: f32, near: f32) -> vec2f {
    let clipped = center.y - radius < near;
    // Half the width of the disc that the near plane cuts out of the sphere.
    let cut = sqrt(max(radius * radius - (near - center.y) * (near - center.y), 0.0));
    var bounds = vec2f(center.x - cut, center.x + cut) / near;
    let tangent_squared = dot(center, center) - radius * radius;
    if tangent_squared > 0.0 {
        // Rotates the direction of the center to either tangent. The tangent points are at `cosine` times the distance
        // of the center.
        let distance = length(center);
        let cosine = sqrt(tangent_squared) / distance;
        let sine = radius / distance;
        let lower = vec2f(cosine * center.x - sine * center.y, cosine * center.y + sine * center.x);
        let upper = vec2f(cosine * center.x + sine * center.y, cosine * center.y - sine * center.x);
        if !clipped || lower.y * cosine > near {
            bounds.x = lower.x / lower.y;
        }
        if !clipped || upper.y * cosine > near {
            bounds.y = upper.x / upper.y;
        }
    }
    return bounds;
}
