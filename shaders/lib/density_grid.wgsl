// Coarse grid of the smoke's extinction. Lengths are in cells, extinctions are optical depths across one cell.

// Steps of the fixed-point numbers that are added up: the sum is the same in any order.
const DENSITY_STEPS: f32 = 65536.0;
// Largest optical depth that one sprite adds to a cell.
const MAX_CELL_DEPTH: f32 = 16384.0;

// Mean optical depth over the square of a sprite, -ln(1 - amount · alpha) averaged over its texels: exact for small
// amounts, where it is `mean_alpha` · amount, and for amount 1, which defines `peak_alpha`.
fn mean_optical_depth(amount: f32, mean_alpha: f32, peak_alpha: f32) -> f32 {
    let peak = max(peak_alpha, 1.0e-3);
    return mean_alpha * -log(1.0 - saturate(amount) * peak) / peak;
}

// Integral from -1 to q of the bump 15/16·(1 - q²)²: 0 at -1 and 1 at 1.
fn bump_integral(q: f32) -> f32 {
    let x = clamp(q, -1.0, 1.0);
    let square = x * x;
    return 0.5 + 0.9375 * x * (1.0 - square * (2.0 / 3.0 - square * 0.2));
}

// Radius of a sprite's bump: its own, and at least that at which a lookup hardly depends on its position between cells.
fn bump_radius(radius: f32) -> f32 {
    return max(radius, 1.5);
}

// Optical depth that a sprite adds to a cell: its mean over the cell, exactly. The sprite is a product of bumps along the
// three axes, as wide as its square; the sum over all cells is the `depth` over the area of its square.
//
// `low`: lower corner of the cell, relative to the sprite's center. `depth`: mean_optical_depth().
fn cell_optical_depth(low: vec3f, radius: f32, depth: f32) -> f32 {
    let reach = bump_radius(radius);
    let near = low / reach;
    let far = (low + 1.0) / reach;
    let x = bump_integral(far.x) - bump_integral(near.x);
    let y = bump_integral(far.y) - bump_integral(near.y);
    let z = bump_integral(far.z) - bump_integral(near.z);
    return min(4.0 * depth * radius * radius * (x * y * z), MAX_CELL_DEPTH);
}

// Optical depth as a whole number of steps.
fn density_steps(optical_depth: f32) -> u32 {
    return u32(max(optical_depth, 0.0) * DENSITY_STEPS + 0.5);
}

// Optical depth from a sum of steps, in two words.
fn optical_depth_of_steps(low: u32, high: u32) -> f32 {
    return f32(high) * 65536.0 + f32(low) / DENSITY_STEPS;
}
