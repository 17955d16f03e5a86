// How much a sprite's normal counts where sprites are not sorted: the less, the more smoke is in front of it. After McGuire and
// Bavoil, "Weighted blended order-independent transparency", JCGT 2013, with the smoke's own depth as the measure.

// Half of a stretch as deep as the smoke lies before it and half behind: the knots are spread over all three.
const FRONT_KNOTS: f32 = 16.0;

// Optical depth of the smoke in front of a view depth. smoke_near and smoke_far lie at a quarter and three quarters of the knots.
fn optical_depth_in_front(knots: array<vec4f, 4>, view_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    let through = (view_depth - smoke_near) / max(smoke_far - smoke_near, 1.0e-4);
    let place = saturate(through * 0.5 + 0.25) * (FRONT_KNOTS - 1.0);
    let low = u32(min(place, FRONT_KNOTS - 2.0));
    let high = low + 1u;
    var values = knots;
    return mix(values[low / 4u][low % 4u], values[high / 4u][high % 4u], place - f32(low));
}

// e^(-depth_weight · optical depth), at most 1: sums of thousands of sprites are within f16. Never so small that the amount of
// a lone sprite times it would be lost to f16.
fn order_weight(depth_weight: f32, optical_depth: f32) -> f32 {
    return exp(-min(depth_weight * optical_depth, 8.0));
}
