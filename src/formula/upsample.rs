//! From the reduced target to full resolution. `shaders/lib/upsample.wgsl`.

use glam::{Mat3, Vec2, Vec3, Vec4, vec3};

use crate::settings::Upsample;

/// Depths that differ by less than this share of the pixel's own count as one surface.
pub const SAME_SURFACE: f32 = 0.1;

/// Depths within this share of the length of a soft fade let as much smoke be seen.
pub const SAME_SMOKE: f32 = 0.4;

/// True where smoke hardly depends on depth: bilinear weights do. `fade`: metres that a soft fade is long.
pub fn is_smooth(depths: Vec4, depth: f32, fade: f32) -> bool {
    depths.max_element().max(depth) - depths.min_element().min(depth) < SAME_SMOKE * fade
}

/// Weights of the texels (0,0) (1,0) (0,1) (1,1) round a pixel at `fraction` between them.
///
/// nearest_depth: bilinear if all four lie on the pixel's surface, else the closest alone. (Jansen and Bavoil, 2011)
/// joint_bilateral: bilinear times a Gaussian of the depth difference. (Kopf et al., 2007)
/// guided: bilinear, where [`is_smooth`]; else [`guided_weights`].
pub fn upsample_weights(mode: Upsample, fraction: Vec2, depths: Vec4, depth: f32) -> Vec4 {
    let g = 1.0 - fraction;
    let bilinear = Vec4::new(g.x * g.y, fraction.x * g.y, g.x * fraction.y, fraction.x * fraction.y);
    let difference = (depths - depth).abs();
    match mode {
        Upsample::Bilinear | Upsample::Guided => return bilinear,
        Upsample::JointBilateral => {
            let sigmas = difference * (2.0 / (SAME_SURFACE * depth.max(1.0e-6)));
            let weights = bilinear * Vec4::from(sigmas.to_array().map(|s| (-0.5 * s * s).exp()));
            let total = weights.element_sum();
            if total > 1.0e-3 {
                return weights / total;
            }
        }
        Upsample::NearestDepth => {
            if difference.max_element() <= SAME_SURFACE * depth {
                return bilinear;
            }
        }
    }
    let closest = difference.min_element();
    let index = difference.to_array().iter().position(|&d| d <= closest).unwrap_or(3);
    Vec4::AXES[index]
}

/// Weights of the texels (−1..2, −1..2), a row in each vector, of which [`upsample_weights`] has the middle four: what there
/// is at the pixel if smoke is linear in place and depth. Texels count by distance and by depth; the fit is theirs by least
/// squares, so weights may be negative, and what they give must be clamped to what the texels hold. (He, Sun and Tang,
/// "Guided image filtering", 2010, with the scene's depth as the guide)
pub fn guided_weights(fraction: Vec2, depths: &[Vec4; 4], depth: f32, fade: f32) -> [Vec4; 4] {
    let (x, y) = (GRID - fraction.x, GRID - fraction.y);
    let tent = |distance: Vec4| (1.0 - distance.abs() * 0.5).max(Vec4::ZERO);
    let (tent_x, tent_y) = (tent(x), tent(y));
    let sigma = 0.5 * SAME_SURFACE * depth.max(1.0e-6);
    let weights: [Vec4; 4] = std::array::from_fn(|row| {
        let sigmas = (depths[row] - depth) / sigma;
        let alike = Vec4::from(sigmas.to_array().map(|s| (-0.5 * s * s).exp() + 1.0e-4));
        tent_x * tent_x * (tent_y[row] * tent_y[row]) * alike
    });
    let total: f32 = weights.iter().map(|w| w.element_sum()).sum();
    let weights = weights.map(|w| w / total);
    let sum = |f: &dyn Fn(usize) -> Vec3| (0..4).map(f).sum::<Vec3>();
    let mean = sum(&|row| {
        let w = weights[row];
        vec3(w.dot(x), w.element_sum() * y[row], w.dot(depths[row]))
    });
    // Each texel's distance from the mean.
    let (dx, dy, dz) = (x - mean.x, y - mean.y, depths.map(|d| d - mean.z));
    let held = 0.05 * fade;
    let diagonal = vec3(0.02, 0.02, held * held)
        + sum(&|row| {
            let w = weights[row];
            vec3(w.dot(dx * dx), w.element_sum() * dy[row] * dy[row], w.dot(dz[row] * dz[row]))
        });
    let mixed = sum(&|row| {
        let w = weights[row];
        vec3(w.dot(dx) * dy[row], w.dot(dx * dz[row]), w.dot(dz[row]) * dy[row])
    });
    let covariance = Mat3::from_cols(
        vec3(diagonal.x, mixed.x, mixed.y),
        vec3(mixed.x, diagonal.y, mixed.z),
        vec3(mixed.y, mixed.z, diagonal.z),
    );
    let nearest = depths.iter().map(|d| d.min_element()).fold(f32::INFINITY, f32::min);
    let farthest = depths.iter().map(|d| d.max_element()).fold(f32::NEG_INFINITY, f32::max);
    let slopes = covariance.inverse() * (vec3(0.0, 0.0, depth.clamp(nearest, farthest)) - mean);
    std::array::from_fn(|row| weights[row] * (1.0 + slopes.x * dx + slopes.y * dy[row] + slopes.z * dz[row]))
}

/// Places of the texels along one side.
const GRID: Vec4 = Vec4::new(-1.0, 0.0, 1.0, 2.0);
