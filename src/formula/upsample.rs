//! From the reduced target to full resolution. `shaders/lib/upsample.wgsl`.

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4, vec3};

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
/// guided: bilinear, where [`is_smooth`]; else a [`GuidedFit`].
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

/// What there is at a pixel if smoke is linear in place and depth, by least squares over the texels around it. Places are
/// from the pixel: x and y in texels, z the texel's depth less the pixel's. (He, Sun and Tang, "Guided image filtering",
/// 2010, with the scene's depth as the guide)
#[derive(Clone, Copy, Debug)]
pub struct GuidedFit {
    /// Sum of the weights; those below are times weight.
    pub total: f32,
    /// Sum of places.
    pub place: Vec3,
    /// x², y², z².
    pub squares: Vec3,
    /// xy, xz, yz.
    pub products: Vec3,
    /// Sum of what texels hold.
    pub value: Vec4,
    /// The same times x.
    pub x_value: Vec4,
    /// The same times y.
    pub y_value: Vec4,
    /// The same times z.
    pub z_value: Vec4,
    /// Least of what texels hold.
    pub low: Vec4,
    /// Most of what texels hold.
    pub high: Vec4,
    /// Least z.
    pub nearest: f32,
    /// Most z.
    pub farthest: f32,
}

impl Default for GuidedFit {
    fn default() -> Self {
        Self {
            total: 0.0,
            place: Vec3::ZERO,
            squares: Vec3::ZERO,
            products: Vec3::ZERO,
            value: Vec4::ZERO,
            x_value: Vec4::ZERO,
            y_value: Vec4::ZERO,
            z_value: Vec4::ZERO,
            low: Vec4::INFINITY,
            high: Vec4::NEG_INFINITY,
            nearest: f32::INFINITY,
            farthest: f32::NEG_INFINITY,
        }
    }
}

/// Texels count by distance, two of them away to nothing, and by depth: [`SAME_SURFACE`] is two sigma out.
pub fn guided_weight(place: Vec3, depth: f32) -> f32 {
    let tent = (1.0 - place.xy().abs() * 0.5).max(Vec2::ZERO);
    let sigmas = place.z * (2.0 / (SAME_SURFACE * depth.max(1.0e-6)));
    tent.x * tent.x * tent.y * tent.y * ((-0.5 * sigmas * sigmas).exp() + 1.0e-4)
}

/// The fit with one texel more.
pub fn with_texel(fit: &GuidedFit, place: Vec3, weight: f32, value: Vec4) -> GuidedFit {
    let w = place * weight;
    GuidedFit {
        total: fit.total + weight,
        place: fit.place + w,
        squares: fit.squares + w * place,
        products: fit.products + w.xxy() * place.yzz(),
        value: fit.value + value * weight,
        x_value: fit.x_value + value * w.x,
        y_value: fit.y_value + value * w.y,
        z_value: fit.z_value + value * w.z,
        low: fit.low.min(value),
        high: fit.high.max(value),
        nearest: fit.nearest.min(place.z),
        farthest: fit.farthest.max(place.z),
    }
}

/// What the fit says of the pixel, clamped to what the texels hold. `fade`: metres that a soft fade is long.
pub fn fitted_value(fit: &GuidedFit, fade: f32) -> Vec4 {
    let mean = fit.place / fit.total;
    let value = fit.value / fit.total;
    let held = 0.05 * fade;
    let square = fit.squares / fit.total - mean * mean + vec3(0.02, 0.02, held * held);
    let product = fit.products / fit.total - mean.xxy() * mean.yzz();
    let a = vec3(square.x, product.x, product.y);
    let b = vec3(product.x, square.y, product.z);
    let c = vec3(product.y, product.z, square.z);
    let at = vec3(0.0, 0.0, 0.0_f32.clamp(fit.nearest, fit.farthest)) - mean;
    let way = vec3(b.cross(c).dot(at), c.cross(a).dot(at), a.cross(b).dot(at)) / a.dot(b.cross(c));
    let fitted = value
        + (fit.x_value / fit.total - value * mean.x) * way.x
        + (fit.y_value / fit.total - value * mean.y) * way.y
        + (fit.z_value / fit.total - value * mean.z) * way.z;
    fitted.clamp(fit.low, fit.high)
}
