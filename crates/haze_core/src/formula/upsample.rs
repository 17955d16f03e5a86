//! Upsampling of the reduced target to full resolution. WGSL: `shaders/lib/upsample.wgsl`.

use glam::{Mat4, Vec2, Vec3, Vec3Swizzles, Vec4, vec3};

use super::curve::smoothstep_unit;
use crate::settings::Upsample;

/// Depths that differ by less than this fraction of the pixel's depth count as one surface.
pub const SURFACE_DEPTH_TOLERANCE: f32 = 0.1;

/// Depths that differ by less than this fraction of a soft fade's length show about the same amount of smoke.
pub const SMOKE_DEPTH_TOLERANCE: f32 = 0.4;

/// Fraction of a soft fade's length: the unit of slopes over depth, and the standard deviation of depth that damps them.
pub const SLOPE_LENGTH: f32 = 0.05;

/// True if smoke hardly changes between two depths. `fade` is the length of a soft fade, metres.
pub fn is_shallow(nearest: f32, farthest: f32, fade: f32) -> bool {
    farthest - nearest < SMOKE_DEPTH_TOLERANCE * fade
}

/// True if smoke hardly depends on depth here, so that bilinear weights suffice.
pub fn bilinear_suffices(depths: Vec4, depth: f32, fade: f32) -> bool {
    is_shallow(depths.min_element().min(depth), depths.max_element().max(depth), fade)
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
    pub position: Vec3,
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
            position: Vec3::ZERO,
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
pub fn guided_weight(position: Vec3, depth: f32) -> f32 {
    let tent = (1.0 - position.xy().abs() * 0.5).max(Vec2::ZERO);
    let sigmas = position.z * (2.0 / (SURFACE_DEPTH_TOLERANCE * depth.max(1.0e-6)));
    tent.x * tent.x * tent.y * tent.y * ((-0.5 * sigmas * sigmas).exp() + 1.0e-4)
}

/// Returns the fit with one more texel.
pub fn add_texel(fit: &GuidedFit, position: Vec3, weight: f32, value: Vec4) -> GuidedFit {
    let w = position * weight;
    GuidedFit {
        total: fit.total + weight,
        position: fit.position + w,
        squares: fit.squares + w * position,
        products: fit.products + w.xxy() * position.yzz(),
        value: fit.value + value * weight,
        x_value: fit.x_value + value * w.x,
        y_value: fit.y_value + value * w.y,
        z_value: fit.z_value + value * w.z,
        low: fit.low.min(value),
        high: fit.high.max(value),
        nearest: fit.nearest.min(position.z),
        farthest: fit.farthest.max(position.z),
    }
}

/// Value of the fit at the pixel, clamped to the values of the texels. `fade` is the length of a soft fade, metres.
pub fn fitted_value(fit: &GuidedFit, fade: f32) -> Vec4 {
    let mean = fit.position / fit.total;
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

/// Least-squares line through the values of a texel and its neighbours over depth. z: depth minus the middle texel's.
/// The fields are weighted sums.
#[derive(Clone, Copy, Debug, Default)]
pub struct DepthLine {
    /// Sum of the weights.
    pub total: f32,
    /// Sum of z.
    pub z: f32,
    /// Sum of z².
    pub z_square: f32,
    /// Sum of the values.
    pub value: Vec4,
    /// Sum of the values times z.
    pub z_value: Vec4,
}

/// Returns the line with one more texel.
pub fn add_to_line(line: &DepthLine, z: f32, weight: f32, value: Vec4) -> DepthLine {
    let w = z * weight;
    DepthLine {
        total: line.total + weight,
        z: line.z + w,
        z_square: line.z_square + w * z,
        value: line.value + value * weight,
        z_value: line.z_value + value * w,
    }
}

/// Change of the line over [`SLOPE_LENGTH`] of a soft fade, metres. Damped where the depths hardly determine it: at most
/// half the range of the values, so that it fits into their format.
pub fn depth_slope(line: &DepthLine, fade: f32) -> Vec4 {
    let z = line.z / line.total;
    let value = line.value / line.total;
    let held = SLOPE_LENGTH * fade;
    (line.z_value / line.total - value * z) * held / (line.z_square / line.total - z * z + held * held)
}

/// Weights of the four texels around a pixel, as in [`upsample_weights`]: bilinear times a Gaussian of the depth
/// difference; [`SURFACE_DEPTH_TOLERANCE`] is two sigma. Never zero by depth, and not normalised: the sum is
/// the fraction of the texels that saw the pixel's surface.
pub fn surface_weights(fraction: Vec2, depths: Vec4, depth: f32) -> Vec4 {
    let sigmas = (depths - depth) * (2.0 / (SURFACE_DEPTH_TOLERANCE * depth.max(1.0e-6)));
    let gaussian = Vec4::from(sigmas.to_array().map(|s| (-0.5 * s * s).exp()));
    upsample_weights(Upsample::Bilinear, fraction, depths, depth) * (gaussian + 1.0e-4)
}

/// Fraction of a value by which [`carried_value`] may lead it out of the range of the texels before it is clamped. At 0, a
/// channel at the end of its range would stop all others; light and amount are apart by at most this fraction.
const SMALL_CHANGE: f32 = 0.05;

/// Mean of four texels, in columns, each carried along its slope to the pixel's depth, as far as all channels stay within the
/// range of the texels. A texel's slope is [`depth_slope`].
pub fn carried_value(weights: Vec4, values: Mat4, slopes: Mat4, depths: Vec4, depth: f32, fade: f32) -> Vec4 {
    let way = (depth.clamp(depths.min_element(), depths.max_element()) - depths) / (SLOPE_LENGTH * fade);
    let total = weights.element_sum();
    let low = values.x_axis.min(values.y_axis).min(values.z_axis.min(values.w_axis));
    let high = values.x_axis.max(values.y_axis).max(values.z_axis.max(values.w_axis));
    let mean = (values * weights / total).clamp(low, high);
    let change = slopes * (weights * way) / total;
    // All channels stop where the first one leaves the range. One by one, they would leave light without amount, or the reverse.
    // A channel at the end of its range, such as full opacity, does not stop the others by a change that is small.
    let room = (Vec4::select(change.cmpgt(Vec4::ZERO), high, low) - mean).abs() + mean * SMALL_CHANGE;
    let steps = Vec4::select(change.abs().cmpgt(room), room / change.abs(), Vec4::ONE);
    (mean + change * steps.min_element()).clamp(low, high)
}

/// Fraction of the mean over the four texels around a pixel in its value; the rest is a mean over sixteen. `seen`: sum of
/// [`surface_weights`].
pub fn four_texels_weight(seen: f32) -> f32 {
    smoothstep_unit((seen - 0.02) / 0.18)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_stays_with_its_amount_where_a_slope_leads_out_of_the_range() {
        // Four texels of light 0.8 times their amount, and slopes of noise: more amount behind, less light.
        let amounts = [0.1, 0.9, 0.5, 0.5];
        let texels = amounts.map(|amount| Vec4::new(0.8 * amount, 0.8 * amount, 0.8 * amount, amount));
        let values = Mat4::from_cols(texels[0], texels[1], texels[2], texels[3]);
        let slope = Vec4::new(-0.02, -0.02, -0.02, 0.05);
        let slopes = Mat4::from_cols(slope, slope, slope, slope);
        let depths = Vec4::new(4.0, 4.0, 4.0, 6.0);
        let carried = carried_value(Vec4::splat(0.25), values, slopes, depths, 6.0, 1.0);
        // Channel by channel, light would fall to 0.08 and the amount rise to 0.9: black smoke.
        assert!((carried.w - 0.9).abs() < 1e-6 && (carried.x - 0.23).abs() < 1e-6, "{carried}");
    }

    #[test]
    fn light_of_opaque_smoke_is_carried() {
        let lights = [0.2, 0.8, 0.4, 0.4];
        let texels = lights.map(|light| Vec4::new(light, light, light, 1.0));
        let values = Mat4::from_cols(texels[0], texels[1], texels[2], texels[3]);
        // Noise of the opacity, which is full on all sides.
        let slope = Vec4::new(0.01, 0.01, 0.01, 0.001);
        let slopes = Mat4::from_cols(slope, slope, slope, slope);
        let depths = Vec4::new(4.0, 4.0, 4.0, 6.0);
        let carried = carried_value(Vec4::splat(0.25), values, slopes, depths, 6.0, 1.0);
        assert!((carried.x - 0.75).abs() < 1e-5 && (carried.w - 1.0).abs() < 1e-6, "{carried}");
    }
}
