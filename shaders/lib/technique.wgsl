// How a sprite keeps from cutting into the scene: the formulas of the techniques. docs/techniques.md compares them.

const TECHNIQUE_HARD: u32 = 0u;
const TECHNIQUE_SOFT: u32 = 1u;
const TECHNIQUE_SOFT_LINEAR: u32 = 2u;
const TECHNIQUE_DEPTH_SPRITE_HARD: u32 = 3u;
const TECHNIQUE_DEPTH_SPRITE_SOFT: u32 = 4u;
const TECHNIQUE_SPHERICAL_BILLBOARD: u32 = 5u;
const TECHNIQUE_DENSITY: u32 = 6u;
const TECHNIQUE_VOLUMETRIC_HARD: u32 = 7u;
const TECHNIQUE_VOLUMETRIC_SOFT: u32 = 8u;

// 1 in front of the scene or on it, 0 behind it: what the hardware's depth test does. (NV 3)
fn hard_fade(distance: f32) -> f32 {
    return select(0.0, 1.0, distance >= 0.0);
}

// View depth of a texel of a depth sprite: `offset` -1..1 is how far it stands out towards the viewer, in radii.
// (MS "2D particles with depth")
fn depth_sprite_depth(view_depth: f32, offset: f32, radius: f32) -> f32 {
    return view_depth - offset * radius;
}

// The stretch of a ray inside a sphere, cut at the near plane and at the scene. All distances along the ray, metres.
struct RayInterval {
    enter: f32,
    // leave <= enter: there is nothing.
    leave: f32,
    // From the middle of the sphere to the nearest point of the ray's line.
    axis: vec3f,
}

// `direction` is of unit length; `near` and `scene` are distances along the ray. w = sqrt(r² - q²), BLOG 2.
fn ray_sphere(origin: vec3f, direction: vec3f, centre: vec3f, radius: f32, near: f32, scene: f32) -> RayInterval {
    let to_centre = centre - origin;
    let middle = dot(to_centre, direction);
    let axis = direction * middle - to_centre;
    let half_chord = sqrt(max(radius * radius - dot(axis, axis), 0.0));
    return RayInterval(max(middle - half_chord, near), min(middle + half_chord, scene), axis);
}

// Umenhoffer's spherical billboard: a = 1 - exp(-density · (1 - q/r) · Δs), Δs the stretch inside the sphere that near
// plane and scene leave. (BLOG 2)
fn spherical_billboard_amount(density: f32, axis_distance: f32, radius: f32, stretch: f32) -> f32 {
    let inwards = saturate(1.0 - axis_distance / max(radius, 1.0e-6));
    return 1.0 - exp(-density * inwards * max(stretch, 0.0));
}

// How much of a slab, a radius before and behind the sprite, lies between near plane and scene, metres.
fn density_thickness(view_depth: f32, radius: f32, near: f32, scene: f32) -> f32 {
    return max(min(scene, view_depth + radius) - max(near, view_depth - radius), 0.0);
}

// The share of that slab which lies behind the near plane.
fn slab_share(view_depth: f32, radius: f32, near: f32) -> f32 {
    return saturate((view_depth + radius - near) / max(2.0 * radius, 1.0e-6));
}

// The sprite's alpha is a density: a = 1 - exp(-density · thickness). (BLOG 3)
fn density_amount(density: f32, thickness: f32) -> f32 {
    return 1.0 - exp(-density * thickness);
}

// Falloff of a volume from its middle; `place` is -1..1 in the sphere. (MS "March", step 3)
fn volumetric_falloff(place: vec3f) -> f32 {
    return saturate(1.0 - dot(place, place));
}

// Density of a volume, 0..1: the noise, eaten away from the outside in. (MS "March", steps 1 and 3)
fn volumetric_density(noise: f32, falloff: f32) -> f32 {
    return saturate(2.0 * noise - 1.0 + falloff) * falloff;
}

// Which way a place in a volume faces, in view space: out of the sphere and down the noise's density. What faces away is
// turned side-on, so that steps and sprites behind each other never cancel. (MS "March", step 2)
fn volumetric_normal(place: vec3f, gradient: vec3f) -> vec3f {
    let normal = place + 2.0 * gradient;
    return normalize(vec3f(normal.xy, max(normal.z, 0.1)));
}

// Lower and upper bound of a sphere's picture on one axis, as position / depth, cut at the near plane; `centre` is
// (position on the axis, depth). (Mara and McGuire, "2D polyhedral bounds of a clipped, perspective-projected 3D
// sphere", JCGT 2013)
fn sphere_axis_bounds(centre: vec2f, radius: f32, near: f32) -> vec2f {
    let clipped = centre.y - radius < near;
    // The disc that the near plane cuts out of the sphere.
    let cut = sqrt(max(radius * radius - (near - centre.y) * (near - centre.y), 0.0));
    var bounds = vec2f(centre.x - cut, centre.x + cut) / near;
    let tangent_squared = dot(centre, centre) - radius * radius;
    if tangent_squared > 0.0 {
        // The direction of the middle, turned to either tangent; the tangent points lie `cosine` of the way out.
        let distance = length(centre);
        let cosine = sqrt(tangent_squared) / distance;
        let sine = radius / distance;
        let lower = vec2f(cosine * centre.x - sine * centre.y, cosine * centre.y + sine * centre.x);
        let upper = vec2f(cosine * centre.x + sine * centre.y, cosine * centre.y - sine * centre.x);
        if !clipped || lower.y * cosine > near {
            bounds.x = lower.x / lower.y;
        }
        if !clipped || upper.y * cosine > near {
            bounds.y = upper.x / upper.y;
        }
    }
    return bounds;
}
