// From the reduced target to full resolution: the weights of the texels round a pixel.

const UPSAMPLE_GUIDED: u32 = 0u;
const UPSAMPLE_JOINT_BILATERAL: u32 = 1u;
const UPSAMPLE_NEAREST_DEPTH: u32 = 2u;
const UPSAMPLE_BILINEAR: u32 = 3u;

// Depths that differ by less than this share of the pixel's own count as one surface: a floor seen at a grazing angle
// stays smooth, a fence a metre before a wall does not.
const SAME_SURFACE: f32 = 0.1;

// Depths within this share of the length of a soft fade let as much smoke be seen.
const SAME_SMOKE: f32 = 0.4;

// True where smoke hardly depends on depth: bilinear weights do. `fade`: metres that a soft fade is long.
fn is_smooth(depths: vec4f, depth: f32, fade: f32) -> bool {
    let low = min(min(min(depths.x, depths.y), min(depths.z, depths.w)), depth);
    let high = max(max(max(depths.x, depths.y), max(depths.z, depths.w)), depth);
    return high - low < SAME_SMOKE * fade;
}

// Weights of the texels (0,0) (1,0) (0,1) (1,1). `fraction` is the pixel's place between them, `depths` their view
// depths, `depth` the pixel's own.
// nearest_depth: bilinear if all four lie on the pixel's surface, else the closest alone. (Jansen and Bavoil, "Fast
// rendering of opacity-mapped particles using DirectX 11 tessellation and mixed resolutions", 2011)
// joint_bilateral: bilinear times a Gaussian of the depth difference. (Kopf et al., "Joint bilateral upsampling", 2007)
// guided: bilinear, where is_smooth; else guided_weights.
fn upsample_weights(mode: u32, fraction: vec2f, depths: vec4f, depth: f32) -> vec4f {
    let g = 1.0 - fraction;
    let bilinear = vec4f(g.x * g.y, fraction.x * g.y, g.x * fraction.y, fraction.x * fraction.y);
    if mode == UPSAMPLE_BILINEAR || mode == UPSAMPLE_GUIDED {
        return bilinear;
    }
    let difference = abs(depths - depth);
    if mode == UPSAMPLE_JOINT_BILATERAL {
        // A depth SAME_SURFACE away is two sigma out.
        let sigmas = difference * (2.0 / (SAME_SURFACE * max(depth, 1.0e-6)));
        let weights = bilinear * exp(-0.5 * sigmas * sigmas);
        let total = weights.x + weights.y + weights.z + weights.w;
        // No texel near the pixel's surface: the closest stands in, as below.
        if total > 1.0e-3 {
            return weights / total;
        }
    } else if all(difference <= vec4f(SAME_SURFACE * depth)) {
        return bilinear;
    }
    let closest = min(min(difference.x, difference.y), min(difference.z, difference.w));
    if difference.x == closest { return vec4f(1.0, 0.0, 0.0, 0.0); }
    if difference.y == closest { return vec4f(0.0, 1.0, 0.0, 0.0); }
    if difference.z == closest { return vec4f(0.0, 0.0, 1.0, 0.0); }
    return vec4f(0.0, 0.0, 0.0, 1.0);
}

// Weights of the texels (-1..2, -1..2), a row in each vector, of which upsample_weights has the middle four: what there is
// at the pixel if smoke is linear in place and depth. Texels count by distance and by depth; the fit is theirs by least
// squares, so weights may be negative, and what they give must be clamped to what the texels hold.
// (He, Sun and Tang, "Guided image filtering", 2010, with the scene's depth as the guide)
fn guided_weights(fraction: vec2f, depths: array<vec4f, 4>, depth: f32, fade: f32) -> array<vec4f, 4> {
    let x = vec4f(-1.0, 0.0, 1.0, 2.0) - fraction.x;
    let y = vec4f(-1.0, 0.0, 1.0, 2.0) - fraction.y;
    // Tents two texels wide, squared: smooth where a texel comes in or goes.
    let tent_x = max(1.0 - abs(x) * 0.5, vec4f(0.0));
    let tent_y = max(1.0 - abs(y) * 0.5, vec4f(0.0));
    let sigma = 0.5 * SAME_SURFACE * max(depth, 1.0e-6);
    var weights = depths;
    var total = 0.0;
    var mean = vec3f(0.0);
    var nearest = depths[0].x;
    var farthest = depths[0].x;
    for (var row = 0u; row < 4u; row++) {
        let d = depths[row];
        let sigmas = (d - depth) / sigma;
        // Never nothing: a pixel may lie on a surface that no texel has seen.
        weights[row] = tent_x * tent_x * (tent_y[row] * tent_y[row]) * (exp(-0.5 * sigmas * sigmas) + 1.0e-4);
        let sum = dot(weights[row], vec4f(1.0));
        total += sum;
        mean += vec3f(dot(weights[row], x), sum * y[row], dot(weights[row], d));
        nearest = min(nearest, min(min(d.x, d.y), min(d.z, d.w)));
        farthest = max(farthest, max(max(d.x, d.y), max(d.z, d.w)));
    }
    mean /= total;
    // Covariance of x, y and depth: its diagonal, and xy, x·depth, y·depth.
    var diagonal = vec3f(0.0);
    var mixed = vec3f(0.0);
    for (var row = 0u; row < 4u; row++) {
        let w = weights[row] / total;
        let dx = x - mean.x;
        let dy = y[row] - mean.y;
        let dz = depths[row] - mean.z;
        diagonal += vec3f(dot(w, dx * dx), dot(w, vec4f(1.0)) * dy * dy, dot(w, dz * dz));
        mixed += vec3f(dot(w, dx) * dy, dot(w, dx * dz), dot(w, dz) * dy);
    }
    // Slopes that little speaks for are held down.
    let held = 0.05 * fade;
    diagonal += vec3f(0.02, 0.02, held * held);
    let a = vec3f(diagonal.x, mixed.x, mixed.y);
    let b = vec3f(mixed.x, diagonal.y, mixed.z);
    let c = vec3f(mixed.y, mixed.z, diagonal.z);
    let at = vec3f(0.0, 0.0, clamp(depth, nearest, farthest)) - mean;
    let slopes = vec3f(dot(cross(b, c), at), dot(cross(c, a), at), dot(cross(a, b), at)) / dot(a, cross(b, c));
    for (var row = 0u; row < 4u; row++) {
        let line = slopes.x * (x - mean.x) + slopes.y * (y[row] - mean.y) + slopes.z * (depths[row] - mean.z);
        weights[row] *= (1.0 + line) / total;
    }
    return weights;
}
