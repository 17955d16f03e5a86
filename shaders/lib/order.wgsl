// Weight of a sprite's normal if sprites are not sorted: the weight decreases with the amount of smoke in front. After
// McGuire and Bavoil, "Weighted blended order-independent transparency", JCGT 2013, with the optical depth of the smoke
// instead of the distance.

// The knots cover twice the depth range of the smoke: a margin of half the range in front, the smoke, and the same
// margin behind.
const OPTICAL_DEPTH_KNOTS: f32 = 16.0;

// Returns the optical depth of the smoke in front of a view depth. smoke_near and smoke_far lie at a quarter and three
// quarters of the knots.
fn optical_depth_in_front(knots: array<vec4f, 4>, view_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    let through = (view_depth - smoke_near) / max(smoke_far - smoke_near, 1.0e-4);
    let position = saturate(through * 0.5 + 0.25) * (OPTICAL_DEPTH_KNOTS - 1.0);
    let low = u32(min(position, OPTICAL_DEPTH_KNOTS - 2.0));
    let high = low + 1u;
    var values = knots;
    return mix(values[low / 4u][low % 4u], values[high / 4u][high % 4u], position - f32(low));
}

// e^(-depth_weight · optical depth), at most 1, so that sums of thousands of sprites stay within f16. The exponent is
// limited, so that the weighted amount of a single sprite does not vanish in f16.
fn order_weight(depth_weight: f32, optical_depth: f32) -> f32 {
    return exp(-min(depth_weight * optical_depth, 8.0));
}
