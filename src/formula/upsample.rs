//! Upsampling of the reduced target to full resolution. WGSL: `shaders/lib/upsample.wgsl`.

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4, vec3};

use crate::settings::Upsample;

/// Depths that differ by less than this share of the pixel's depth count as one surface.
pub const SURFACE_DEPTH_TOLERANCE: f32 = 0.1;

/// Depths that differ by less than this share of a soft fade's length show about the same amount of smoke.
pub const SMOKE_DEPTH_TOLERANCE: f32 = 0.4;

/// True if smoke hardly depends on depth here, so that bilinear weights suffice. `fade` is the length of a soft fade,
/// metres.
pub fn bilinear_suffices(depths: Vec4, depth: f32, fade: f32) -> bool {
    depths.max_element().max(depth) - depths.min_element().min(depth) < SMOKE_DEPTH_TOLERANCE * fade
}

/// Weights of the texels (0,0) (1,0) (0,1) (1,1) around a pixel at `fraction` between them. `depths` are the texels'
/// view depths, `depth` is the pixel's.
///
/// - nearest_depth: bilinear if all four are on the pixel's surface, else the closest texel alone. (Jansen and Bavoil,
///   2011)
/// - joint_bilateral: bilinear times a Gaussian of the depth difference. (Kopf et al., 2007)
/// - guided: bilinear, for pixels where [`bilinear_suffices`] holds; the others use a [`GuidedFit`].
pub fn upsample_weights(mode: Upsample, fraction: Vec2, depths: Vec4, depth: f32) -> Vec4 {
    let g = 1.0 - fraction;
    let bilinear = Vec4::new(g.x * g.y, fraction.x * g.y, g.x * fraction.y, fraction.x * fraction.y);
    let difference = (depths - depth).abs();
    match mode {
        Upsample::Bilinear | Upsample::Guided => return bilinear,
        Upsample::JointBilateral => {
            let sigmas = difference * (2.0 / (SURFACE_DEPTH_TOLERANCE * depth.max(1.0e-6)));
            let weights = bilinear * Vec4::from(sigmas.to_array().map(|s| (-0.5 * s * s).exp()));
            let total = weights.element_sum();
            if total > 1.0e-3 {
                return weights / total;
            }
        }
        Upsample::NearestDepth => {
            if difference.max_element() <= SURFACE_DEPTH_TOLERANCE * depth {
                return bilinear;
            }
        }
    }
    let closest = difference.min_element();
    let index = difference.to_array().iter().position(|&d| d <= closest).unwrap_or(3);
    Vec4::AXES[index]
}

/// Least-squares fit over the texels around a pixel, for smoke that is linear in position and depth. Positions are
/// relative to the pixel: x and y in texels, z the texel's depth minus the pixel's. (He, Sun and Tang, "Guided image
/// filtering", 2010, with the scene's depth as the guide)
#[derive(Clone, Copy, Debug)]
pub struct GuidedFit {
    /// Sum of the weights. All sums below are weighted.
    pub total: f32,
    /// Sum of the positions.
    pub place: Vec3,
    /// Sums of x², y², z².
    pub squares: Vec3,
    /// Sums of xy, xz, yz.
    pub products: Vec3,
    /// Sum of the texels' values.
    pub value: Vec4,
    /// Sum of the values times x.
    pub x_value: Vec4,
    /// Sum of the values times y.
    pub y_value: Vec4,
    /// Sum of the values times z.
    pub z_value: Vec4,
    /// Smallest value of the texels, by channel.
    pub low: Vec4,
    /// Largest value of the texels, by channel.
    pub high: Vec4,
    /// Smallest z.
    pub nearest: f32,
    /// Largest z.
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

/// Weight of a texel. It falls to zero two texels away, and with depth as a Gaussian of which
/// [`SURFACE_DEPTH_TOLERANCE`] is two sigma.
pub fn guided_weight(place: Vec3, depth: f32) -> f32 {
    let tent = (1.0 - place.xy().abs() * 0.5).max(Vec2::ZERO);
    let sigmas = place.z * (2.0 / (SURFACE_DEPTH_TOLERANCE * depth.max(1.0e-6)));
    tent.x * tent.x * tent.y * tent.y * ((-0.5 * sigmas * sigmas).exp() + 1.0e-4)
}

/// Returns the fit with one more texel.
pub fn add_texel(fit: &GuidedFit, place: Vec3, weight: f32, value: Vec4) -> GuidedFit {
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

/// Value of the fit at the pixel, clamped to the values of the texels. `fade` is the length of a soft fade, metres.
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
