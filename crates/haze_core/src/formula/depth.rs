//! Scene depth as linear view depth, metres. WGSL: `shaders/lib/depth.wgsl`.

use glam::{IVec2, Mat4, Vec4};

use crate::error::FieldError;
use crate::settings::DepthDownsample;

/// View depth of pixels without a surface, metres. Finite, so that depth differences stay finite.
pub const SKY_VIEW_DEPTH: f32 = 1.0e6;

/// Encoding of distance in a depth buffer. It is derived from the projection, so the two cannot disagree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthConvention {
    /// View depth of the near plane, metres. Positive for a perspective view; any sign for an orthographic one.
    pub near: f32,
    /// View depth of the far plane, metres; infinite for an infinite projection.
    pub far: f32,
    /// True if the near plane is stored as 1 and the far plane as 0.
    pub reversed: bool,
    /// True if depth is linear in distance.
    pub orthographic: bool,
}

/// Rounding can put an infinite far plane at a large negative distance. Beyond this many times the near plane's
/// distance, it counts as infinite.
const FARTHEST: f64 = 1.0e6;

impl DepthConvention {
    /// Derives the convention from a projection with w = −z (perspective) or w = 1 (orthographic).
    ///
    /// # Errors
    /// Fails if the near plane is not in front of the far plane, or if the near plane of a perspective is not in front
    /// of the viewer.
    pub fn from_clip_from_view(clip_from_view: &Mat4) -> Result<Self, FieldError> {
        let orthographic = clip_from_view.z_axis.w == 0.0;
        // In f64, because the far plane depends on the last bits of a matrix entry close to 1.
        let scale = f64::from(clip_from_view.z_axis.z);
        let offset = f64::from(clip_from_view.w_axis.z);
        let view_depth_at = |ndc_depth: f64| {
            if orthographic { (offset - ndc_depth) / scale } else { offset / (ndc_depth + scale) }
        };
        let at_zero = view_depth_at(0.0);
        let at_one = view_depth_at(1.0);
        let reversed = if orthographic { at_zero > at_one } else { at_zero.abs() > at_one.abs() };
        let (near, far) = if reversed { (at_one, at_zero) } else { (at_zero, at_one) };
        // Rounding may leave a far plane at infinity or just beyond, which is at a large negative distance.
        let is_infinite = far.is_infinite() || (!orthographic && far < -FARTHEST * near);
        let far = if is_infinite { f64::INFINITY } else { far };
        if !(near.is_finite() && near < far && (orthographic || near > 0.0)) {
            let expected = "a projection whose depth runs from a near to a far plane in front of the viewer";
            return Err(FieldError::new("view.clip_from_view", clip_from_view, expected));
        }
        Ok(Self { near: near as f32, far: far as f32, reversed, orthographic })
    }
}

/// Coefficients of [`view_depth_from_ndc_depth`] for a depth buffer with values 0..1.
///
/// The projection stores depth d at view depth z, with near plane n and far plane f:
/// - standard: d = f·(z − n) / (z·(f − n)), so z = n·f / (f − d·(f − n)); NV prints (f + n), which is wrong
/// - reversed: d' = 1 − d, so z = n·f / (n + d'·(f − n))
/// - infinite: the limit f → ∞, so z = n / (1 − d), or n / d' when reversed
/// - orthographic: z = n + d·(f − n), or f − d'·(f − n) when reversed
pub fn depth_coefficients(convention: &DepthConvention) -> Vec4 {
    let n = f64::from(convention.near);
    let f = f64::from(convention.far);
    let [a, b, c, d] = match (convention.orthographic, convention.reversed) {
        (false, false) if f.is_infinite() => [n, 0.0, 1.0, -1.0],
        (false, true) if f.is_infinite() => [n, 0.0, 0.0, 1.0],
        // Divided by f, which keeps all four near 1.
        (false, false) => [n, 0.0, 1.0, -(f - n) / f],
        (false, true) => [n, 0.0, n / f, (f - n) / f],
        (true, false) => [n, f - n, 1.0, 0.0],
        (true, true) => [f, -(f - n), 1.0, 0.0],
    };
    Vec4::new(a as f32, b as f32, c as f32, d as f32)
}

/// View depth = (c.x + c.y·d) / (c.z + c.w·d). Where the denominator vanishes, it is [`SKY_VIEW_DEPTH`].
pub fn view_depth_from_ndc_depth(ndc_depth: f32, coefficients: Vec4) -> f32 {
    let numerator = coefficients.x + coefficients.y * ndc_depth;
    let denominator = coefficients.z + coefficients.w * ndc_depth;
    if denominator * SKY_VIEW_DEPTH > numerator { numerator / denominator } else { SKY_VIEW_DEPTH }
}

/// View depth of a linear target's texel. Values from [`SKY_VIEW_DEPTH`] up are sky, and so is NaN.
pub fn view_depth_from_linear(texel: f32) -> f32 {
    if texel < SKY_VIEW_DEPTH { texel } else { SKY_VIEW_DEPTH }
}

/// The farther of two values of a depth buffer. `reversed`: it stores the near plane as 1.
pub fn farther_ndc_depth(reversed: bool, a: f32, b: f32) -> f32 {
    if reversed { a.min(b) } else { a.max(b) }
}

/// Depth of a reduced texel, 0..1. `coarse_copy`: one step of 16 bits farther, so that rounding hides no sprite.
pub fn stored_depth(view_depth: f32, depth_limit: f32, coarse_copy: bool) -> f32 {
    super::saturate(view_depth / depth_limit + if coarse_copy { 1.0 / 65535.0 } else { 0.0 })
}

/// True if the reduced texel keeps the farthest depth under it, false if it keeps the nearest.
pub fn depth_downsample_keeps_farthest(mode: DepthDownsample, texel: IVec2) -> bool {
    match mode {
        DepthDownsample::Checkerboard => (texel.x + texel.y) & 1 == 0,
        _ => mode == DepthDownsample::Max,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::camera::rh::proj::directx::{
        orthographic, perspective, perspective_infinite, perspective_infinite_reverse,
    };
    use glam::{Mat4, Vec3};

    /// Projections of every convention. Reversed means depth' = 1 − depth.
    fn projections() -> [Mat4; 6] {
        let reverse = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(0.0, 0.0, -1.0, 0.0), Vec4::new(0.0, 0.0, 1.0, 1.0));
        let standard = perspective(1.0, 1.5, 0.25, 60.0);
        let flat = orthographic(-4.0, 4.0, -3.0, 3.0, 0.25, 60.0);
        [
            standard,
            reverse * standard,
            perspective_infinite(1.0, 1.5, 0.25),
            perspective_infinite_reverse(1.0, 1.5, 0.25),
            flat,
            reverse * flat,
        ]
    }

    /// Largest relative error over 0.3..50 m when a depth buffer is read back with the coefficients that `f` returns.
    fn error(projection: &Mat4, f: impl Fn(&DepthConvention) -> Vec4) -> f32 {
        let coefficients = f(&DepthConvention::from_clip_from_view(projection).unwrap());
        let depths = (0..100).map(|i| 0.3 * (50.0_f32 / 0.3).powf(i as f32 / 99.0));
        let off = |z: f32| {
            let stored = projection.project_point3(Vec3::new(0.0, 0.0, -z)).z;
            (view_depth_from_ndc_depth(stored, coefficients) - z).abs() / z
        };
        depths.map(off).fold(0.0, f32::max)
    }

    #[test]
    fn every_depth_convention_round_trips() {
        for projection in projections() {
            // At 50 m a 0..1 buffer with a near plane at 0.25 m has steps of 6e-8 · 50² / 0.25 m, 1 part in 80 000.
            assert!(error(&projection, depth_coefficients) < 3e-5, "{projection}");
        }
    }

    #[test]
    fn formula_printed_by_nvidia_is_wrong() {
        // z = n·f / (f − d·(f + n)): the sign of n is wrong.
        let printed = |c: &DepthConvention| Vec4::new(c.near, 0.0, 1.0, -(c.far + c.near) / c.far);
        assert!(error(&projections()[0], printed) > 0.1);
    }

    #[test]
    fn cleared_depth_reads_as_sky() {
        for projection in [perspective_infinite(1.0, 1.5, 0.25), perspective_infinite_reverse(1.0, 1.5, 0.25)] {
            let convention = DepthConvention::from_clip_from_view(&projection).unwrap();
            let cleared = if convention.reversed { 0.0 } else { 1.0 };
            let coefficients = depth_coefficients(&convention);
            assert!(view_depth_from_ndc_depth(cleared, coefficients) >= 0.99 * SKY_VIEW_DEPTH);
            assert!(view_depth_from_ndc_depth(f32::NAN, coefficients).is_finite());
        }
    }
}
