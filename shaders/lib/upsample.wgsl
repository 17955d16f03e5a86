// Upsampling of the reduced target to full resolution.

const UPSAMPLE_GUIDED: u32 = 0u;
const UPSAMPLE_JOINT_BILATERAL: u32 = 1u;
const UPSAMPLE_NEAREST_DEPTH: u32 = 2u;
const UPSAMPLE_BILINEAR: u32 = 3u;

// Depths that differ by less than this fraction of the pixel's depth count as one surface: a floor at a grazing angle
// stays smooth, a fence one metre in front of a wall stays separate.
const SURFACE_DEPTH_TOLERANCE: f32 = 0.1;

// Depths that differ by less than this fraction of a soft fade's length show about the same amount of smoke.
const SMOKE_DEPTH_TOLERANCE: f32 = 0.4;

// Fraction of a soft fade's length: the unit of slopes over depth, and the standard deviation of depth that damps them.
const SLOPE_LENGTH: f32 = 0.05;

// True if smoke hardly changes between two depths. `fade` is the length of a soft fade, metres.
fn is_shallow(nearest: f32, farthest: f32, fade: f32) -> bool {
    return farthest - nearest < SMOKE_DEPTH_TOLERANCE * fade;
}

// True if smoke hardly depends on depth here, so that bilinear weights suffice.
fn bilinear_suffices(depths: vec4f, depth: f32, fade: f32) -> bool {
    let low = min(min(min(depths.x, depths.y), min(depths.z, depths.w)), depth);
    let high = max(max(max(depths.x, depths.y), max(depths.z, depths.w)), depth);
    return is_shallow(low, high, fade);
}

// Weights of the texels (0,0) (1,0) (0,1) (1,1). `fraction` is the pixel's position between them, `depths` are their
// view depths, `depth` is the pixel's.
// - nearest_depth: bilinear if all four are on the pixel's surface, else the closest texel alone. (Jansen and Bavoil,
//   "Fast rendering of opacity-mapped particles using DirectX 11 tessellation and mixed resolutions", 2011)
// - joint_bilateral: bilinear times a Gaussian of the depth difference. (Kopf et al., "Joint bilateral upsampling",
//   2007)
// - guided: bilinear, for pixels where bilinear_suffices() holds; the others use a GuidedFit.
fn upsample_weights(mode: u32, fraction: vec2f, depths: vec4f, depth: f32) -> vec4f {
    let g = 1.0 - fraction;
    let bilinear = vec4f(g.x * g.y, fraction.x * g.y, g.x * fraction.y, fraction.x * fraction.y);
    if mode == UPSAMPLE_BILINEAR || mode == UPSAMPLE_GUIDED {
        return bilinear;
    }
    let difference = abs(depths - depth);
    if mode == UPSAMPLE_JOINT_BILATERAL {
        // A depth difference of SURFACE_DEPTH_TOLERANCE is two sigma.
        let sigmas = difference * (2.0 / (SURFACE_DEPTH_TOLERANCE * max(depth, 1.0e-6)));
        let weights = bilinear * exp(-0.5 * sigmas * sigmas);
        let total = weights.x + weights.y + weights.z + weights.w;
        // If no texel is near the pixel's surface, the closest one is used below.
        if total > 1.0e-3 {
            return weights / total;
        }
    } else if all(difference <= vec4f(SURFACE_DEPTH_TOLERANCE * depth)) {
        return bilinear;
    }
    let closest = min(min(difference.x, difference.y), min(difference.z, difference.w));
    if difference.x == closest { return vec4f(1.0, 0.0, 0.0, 0.0); }
    if difference.y == closest { return vec4f(0.0, 1.0, 0.0, 0.0); }
    if difference.z == closest { return vec4f(0.0, 0.0, 1.0, 0.0); }
    return vec4f(0.0, 0.0, 0.0, 1.0);
}

// Least-squares fit, linear in position and depth, to the texels around a pixel. Positions are relative to the pixel: x and y
// in texels, z is the texel's depth minus the pixel's. The fields are weighted sums, to which texels are added one by one:
// no array is needed, and the code is that of a single texel, also for GPUs that execute branches which they do not take.
// (He, Sun and Tang, "Guided image filtering", 2010, with the scene's depth as the guide)
struct GuidedFit {
    total: f32,
    position: vec3f,
    // x², y², z².
    squares: vec3f,
    // xy, xz, yz.
    products: vec3f,
    value: vec4f,
    x_value: vec4f,
    y_value: vec4f,
    z_value: vec4f,
    // Range of the texels' values, and of their depth differences.
    low: vec4f,
    high: vec4f,
    nearest: f32,
    farthest: f32,
}

// Weight of a texel. It falls to zero two texels away, and with depth as a Gaussian of which SURFACE_DEPTH_TOLERANCE is
// two sigma.
fn guided_weight(position: vec3f, depth: f32) -> f32 {
    let tent = max(1.0 - abs(position.xy) * 0.5, vec2f(0.0));
    let sigmas = position.z * (2.0 / (SURFACE_DEPTH_TOLERANCE * max(depth, 1.0e-6)));
    // Never zero by depth, because a pixel may be on a surface that no texel has seen: 1e-4 is the Gaussian at 4.3 sigma.
    return tent.x * tent.x * tent.y * tent.y * (exp(-0.5 * sigmas * sigmas) + 1.0e-4);
}

fn add_texel(fit: GuidedFit, position: vec3f, weight: f32, value: vec4f) -> GuidedFit {
    let w = position * weight;
    return GuidedFit(
        fit.total + weight,
        fit.position + w,
        fit.squares + w * position,
        fit.products + w.xxy * position.yzz,
        fit.value + value * weight,
        fit.x_value + value * w.x,
        fit.y_value + value * w.y,
        fit.z_value + value * w.z,
        select(min(fit.low, value), value, fit.total == 0.0),
        select(max(fit.high, value), value, fit.total == 0.0),
        min(fit.nearest, position.z),
        max(fit.farthest, position.z),
    );
}

// Value of the fit at the pixel. `fade` is the length of a soft fade, metres.
fn fitted_value(fit: GuidedFit, fade: f32) -> vec4f {
    let mean = fit.position / fit.total;
    let value = fit.value / fit.total;
    // Covariances. The added terms damp slopes that the texels hardly determine: the positions of the sixteen texels have a
    // variance of 1/3, and 0.02 is 6 % of that.
    let held = 0.05 * fade;
    let square = fit.squares / fit.total - mean * mean + vec3f(0.02, 0.02, held * held);
    let product = fit.products / fit.total - mean.xxy * mean.yzz;
    let a = vec3f(square.x, product.x, product.y);
    let b = vec3f(product.x, square.y, product.z);
    let c = vec3f(product.y, product.z, square.z);
    // Depth of the pixel, clamped to the range of its texels.
    let at = vec3f(0.0, 0.0, clamp(0.0, fit.nearest, fit.farthest)) - mean;
    let way = vec3f(dot(cross(b, c), at), dot(cross(c, a), at), dot(cross(a, b), at)) / dot(a, cross(b, c));
    let fitted = value
        + (fit.x_value / fit.total - value * mean.x) * way.x
        + (fit.y_value / fit.total - value * mean.y) * way.y
        + (fit.z_value / fit.total - value * mean.z) * way.z;
    // A line extends beyond its points, smoke does not.
    return clamp(fitted, fit.low, fit.high);
}

// Least-squares line through the values of a texel and its neighbours over depth. z: depth minus the middle texel's.
// The fields are weighted sums.
struct DepthLine {
    total: f32,
    z: f32,
    z_square: f32,
    value: vec4f,
    z_value: vec4f,
}

fn add_to_line(line: DepthLine, z: f32, weight: f32, value: vec4f) -> DepthLine {
    let w = z * weight;
    return DepthLine(
        line.total + weight,
        line.z + w,
        line.z_square + w * z,
        line.value + value * weight,
        line.z_value + value * w,
    );
}

// Change of the line over SLOPE_LENGTH of a soft fade, metres. Damped where the depths hardly determine it: at most half
// the range of the values, so that it fits into their format.
fn depth_slope(line: DepthLine, fade: f32) -> vec4f {
    let z = line.z / line.total;
    let value = line.value / line.total;
    let held = SLOPE_LENGTH * fade;
    return (line.z_value / line.total - value * z) * held / (line.z_square / line.total - z * z + held * held);
}

// Weights of the four texels around a pixel, as in upsample_weights(): bilinear times a Gaussian of the depth
// difference; SURFACE_DEPTH_TOLERANCE is two sigma. Never zero by depth, and not normalised: the sum is the
// fraction of the texels that saw the pixel's surface.
fn surface_weights(fraction: vec2f, depths: vec4f, depth: f32) -> vec4f {
    let sigmas = (depths - depth) * (2.0 / (SURFACE_DEPTH_TOLERANCE * max(depth, 1.0e-6)));
    return upsample_weights(UPSAMPLE_BILINEAR, fraction, depths, depth) * (exp(-0.5 * sigmas * sigmas) + 1.0e-4);
}

// Fraction of a value by which carried_value() may lead it out of the range of the texels before it is clamped. At 0, a channel
// at the end of its range would stop all others; light and amount are apart by at most this fraction.
const SMALL_CHANGE: f32 = 0.05;

// Mean of four texels, in columns, each carried along its slope to the pixel's depth, as far as all channels stay within the
// range of the texels. A texel's slope is depth_slope().
fn carried_value(weights: vec4f, values: mat4x4f, slopes: mat4x4f, depths: vec4f, depth: f32, fade: f32) -> vec4f {
    let nearest = min(min(depths.x, depths.y), min(depths.z, depths.w));
    let farthest = max(max(depths.x, depths.y), max(depths.z, depths.w));
    let way = (clamp(depth, nearest, farthest) - depths) / (SLOPE_LENGTH * fade);
    let total = dot(weights, vec4f(1.0));
    let low = min(min(values[0], values[1]), min(values[2], values[3]));
    let high = max(max(values[0], values[1]), max(values[2], values[3]));
    let mean = clamp(values * weights / total, low, high);
    let change = slopes * (weights * way) / total;
    // All channels stop where the first one leaves the range. One by one, they would leave light without amount, or the reverse.
    // A channel at the end of its range, such as full opacity, does not stop the others by a change that is small.
    let room = abs(select(low, high, change > vec4f(0.0)) - mean) + mean * SMALL_CHANGE;
    let steps = select(vec4f(1.0), room / abs(change), abs(change) > room);
    return clamp(mean + change * min(min(steps.x, steps.y), min(steps.z, steps.w)), low, high);
}

// Fraction of the mean over the four texels around a pixel in its value; the rest is a mean over sixteen. `seen`: sum of
// surface_weights(). From 0.2 on, as with one texel of a fifth of the bilinear weight on the pixel's surface, the four suffice;
// below a tenth of that, no texel saw the surface.
fn four_texels_weight(seen: f32) -> f32 {
    return smoothstep(0.02, 0.2, seen);
}
