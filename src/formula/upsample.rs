//! From the reduced target to full resolution. `shaders/lib/upsample.wgsl`.

use glam::{Vec2, Vec4};

use crate::settings::Upsample;

/// Depths that differ by less than this share of the pixel's own count as one surface.
pub const SAME_SURFACE: f32 = 0.1;

/// Weights of the texels (0,0) (1,0) (0,1) (1,1) round a pixel at `fraction` between them.
///
/// nearest_depth: bilinear if all four lie on the pixel's surface, else the closest alone. (Jansen and Bavoil, 2011)
/// joint_bilateral: bilinear times a Gaussian of the depth difference. (Kopf et al., 2007)
pub fn upsample_weights(mode: Upsample, fraction: Vec2, depths: Vec4, depth: f32) -> Vec4 {
    let g = 1.0 - fraction;
    let bilinear = Vec4::new(g.x * g.y, fraction.x * g.y, g.x * fraction.y, fraction.x * fraction.y);
    let difference = (depths - depth).abs();
    match mode {
        Upsample::Bilinear => return bilinear,
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
