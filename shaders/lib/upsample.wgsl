// From the reduced target to full resolution: the weights of the four texels round a pixel.

const UPSAMPLE_NEAREST_DEPTH: u32 = 0u;
const UPSAMPLE_JOINT_BILATERAL: u32 = 1u;
const UPSAMPLE_BILINEAR: u32 = 2u;

// Depths that differ by less than this share of the pixel's own count as one surface: a floor seen at a grazing angle
// stays smooth, a fence a metre before a wall does not.
const SAME_SURFACE: f32 = 0.1;

// Weights of the texels (0,0) (1,0) (0,1) (1,1). `fraction` is the pixel's place between them, `depths` their view
// depths, `depth` the pixel's own.
// nearest_depth: bilinear if all four lie on the pixel's surface, else the closest alone. (Jansen and Bavoil, "Fast
// rendering of opacity-mapped particles using DirectX 11 tessellation and mixed resolutions", 2011)
// joint_bilateral: bilinear times a Gaussian of the depth difference. (Kopf et al., "Joint bilateral upsampling", 2007)
fn upsample_weights(mode: u32, fraction: vec2f, depths: vec4f, depth: f32) -> vec4f {
    let g = 1.0 - fraction;
    let bilinear = vec4f(g.x * g.y, fraction.x * g.y, g.x * fraction.y, fraction.x * fraction.y);
    if mode == UPSAMPLE_BILINEAR {
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
