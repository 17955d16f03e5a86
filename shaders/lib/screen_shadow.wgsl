// Shadow of smoke on an image that is lit already: its surfaces from their depth, and the fraction of their light that is
// left. View space.

// The shorter of two steps along the viewer's direction: the one that does not cross an edge.
fn smoother_step(a: vec3f, b: vec3f) -> vec3f {
    return select(b, a, abs(a.z) < abs(b.z));
}

// Normal of the scene at a pixel, towards the viewer, from the positions of the pixel and its four neighbours.
fn scene_normal(center: vec3f, left: vec3f, right: vec3f, above: vec3f, below: vec3f) -> vec3f {
    let across = smoother_step(center - left, right - center);
    let up = smoother_step(center - below, above - center);
    let normal = cross(across, up);
    return normal * inverseSqrt(max(dot(normal, normal), 1.0e-30));
}

// Fraction of the scene's light that is left. `full`: light of a white matte surface without smoke. `shaded`: through it.
fn fraction_of_light(full: vec3f, shaded: vec3f) -> vec3f {
    return (shaded + 1.0e-6) / (full + 1.0e-6);
}
