// Depth of smoke at a pixel, from accumulated moments. Depths are fractions of a system's range of view depths.

// Number of samples that represent the smoke at a pixel.
const DEPTH_SAMPLES: u32 = 4u;

// Depth of a sprite, and the mean of its square: a sprite is as deep as wide. `radius`: half the side of the square that its
// density fills, metres.
fn depth_moments(view_depth: f32, radius: f32, near: f32, far: f32) -> vec2f {
    let range = max(far - near, 1.0e-4);
    let depth = saturate((view_depth - near) / range);
    let reach = radius / range;
    // The variance of the bump of the density grid.
    return vec2f(depth, depth * depth + reach * reach / 7.0);
}

// View depth of a sample of the smoke at a pixel, metres: as if it were spread evenly, as far as its moments are. `moments`:
// mean depth, and mean of its square.
fn depth_of_sample(index: u32, moments: vec2f, near: f32, far: f32) -> f32 {
    let deviation = sqrt(max(moments.y - moments.x * moments.x, 0.0));
    // Even between ±√3 standard deviations.
    let offset = ((f32(index) + 0.5) * (2.0 / f32(DEPTH_SAMPLES)) - 1.0) * 1.7320508;
    return near + (far - near) * saturate(moments.x + deviation * offset);
}
