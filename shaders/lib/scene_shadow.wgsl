// Shadow of smoke on the scene. Lengths are in cells of the density grid.

// Place at which light comes to `origin` out of the grid of `size` cells, and 1 in w: the point itself inside of the grid,
// and outside, where its line to the light enters the grid. 0 in w if the line does not meet the grid before the light.
// `light`: its position, and 0 in w; or the direction to it, and 1 in w.
fn grid_entry(light: vec4f, origin: vec3f, size: vec3f) -> vec4f {
    let to_light = light.xyz - origin * (1.0 - light.w);
    let distance = sqrt(max(dot(to_light, to_light), 1.0e-8));
    let direction = to_light / distance;
    let steady = select(direction, vec3f(1.0e-6), abs(direction) < vec3f(1.0e-6));
    let low = -origin / steady;
    let high = (size - origin) / steady;
    let first = min(low, high);
    let last = max(low, high);
    let enter = max(max(first.x, max(first.y, first.z)), 0.0);
    let leave = min(last.x, min(last.y, last.z));
    let reach = select(min(leave, distance), leave, light.w > 0.5);
    return vec4f(origin + direction * enter, select(0.0, 1.0, enter < reach));
}

// Fraction of a light that falls through smoke onto the scene. `painted`: color of the shadow ramp for that optical depth and a
// light behind the smoke, which tints what is left of the light.
fn transmitted_light(optical_depth: f32, painted: vec3f) -> vec3f {
    let brightest = max(painted.r, max(painted.g, painted.b));
    let hue = select(vec3f(1.0), painted / max(brightest, 1.0e-6), brightest > 1.0e-4);
    return mix(vec3f(1.0), hue, saturate(1.0 - exp2(-optical_depth))) * exp(-optical_depth);
}
