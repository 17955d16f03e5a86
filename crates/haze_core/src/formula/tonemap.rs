//! Tonemap of the demo program: linear HDR to sRGB code. The library never tonemaps a host's image. WGSL:
//! `shaders/lib/tonemap.wgsl`.

use glam::{Mat3, UVec2, Vec3, vec3};

use super::color::srgb_from_linear;
use super::hash::{pcg3d, unit};
use crate::settings::Tonemap;

/// ACES tonemap curve, linear HDR to linear 0..1. (Hill, "BakingLab", 2016: a fit of the reference and output
/// transforms)
pub fn aces_fitted(color: Vec3) -> Vec3 {
    const INPUT: Mat3 = Mat3::from_cols(
        vec3(0.597_19, 0.076, 0.028_4),
        vec3(0.354_58, 0.908_34, 0.133_83),
        vec3(0.048_23, 0.015_66, 0.837_77),
    );
    const OUTPUT: Mat3 = Mat3::from_cols(
        vec3(1.604_75, -0.102_08, -0.003_27),
        vec3(-0.531_08, 1.108_13, -0.072_76),
        vec3(-0.073_67, -0.006_05, 1.076_02),
    );
    let v = INPUT * color.max(Vec3::ZERO);
    let fitted = (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    (OUTPUT * fitted).clamp(Vec3::ZERO, Vec3::ONE)
}

/// ACES between the darkest and the brightest channel, and the hue of the light between them; linear HDR to linear 0..1.
/// (Adobe, "Digital Negative specification", 2012: a tone curve that keeps hues)
pub fn aces_keeping_hue(color: Vec3) -> Vec3 {
    let light = color.max(Vec3::ZERO);
    let fitted = aces_fitted(light);
    let least = light.min_element();
    let range = light.max_element() - least;
    let dark = fitted.min_element();
    dark + (light - least) * ((fitted.max_element() - dark) / range.max(1.0e-6))
}

/// AgX, linear HDR to linear 0..1: light pales slowly on its way to white. (Sobotta, "AgX", 2022; fit of the curve by Wrensch,
/// "Minimal AgX implementation", 2023)
pub fn agx(color: Vec3) -> Vec3 {
    const INSET: Mat3 = Mat3::from_cols(
        vec3(0.842_479, 0.042_328_2, 0.042_375_7),
        vec3(0.078_433_6, 0.878_469, 0.078_433_6),
        vec3(0.079_223_7, 0.079_166_1, 0.879_143),
    );
    const OUTSET: Mat3 = Mat3::from_cols(
        vec3(1.196_88, -0.052_896_9, -0.052_971_6),
        vec3(-0.098_020_9, 1.151_9, -0.098_043_5),
        vec3(-0.099_029_7, -0.098_961_2, 1.151_07),
    );
    // The curve covers 16.5 stops around middle gray.
    let stops = (INSET * color.max(Vec3::ZERO)).max(Vec3::splat(1.0e-10)).map(f32::log2);
    let x = ((stops + 12.473_93) / 16.5).clamp(Vec3::ZERO, Vec3::ONE);
    let x2 = x * x;
    let x4 = x2 * x2;
    let code = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.429_8 * x2 + 0.119_1 * x - 0.002_32;
    (OUTSET * code).clamp(Vec3::ZERO, Vec3::ONE).powf(2.2)
}

/// PBR Neutral, linear HDR to linear 0..1: keeps colors up to four fifths of white as they are, and mixes brighter ones with
/// white. (Khronos Group, "PBR Neutral tone mapper", 2024)
pub fn pbr_neutral(color: Vec3) -> Vec3 {
    let positive = color.max(Vec3::ZERO);
    let least = positive.min_element();
    // Takes off the reflection of a clear surface, which a renderer adds to a painted color.
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let painted = positive - offset;
    let peak = painted.max_element();
    let start = 0.76;
    if peak < start {
        return painted;
    }
    let room = 1.0 - start;
    let shown_peak = 1.0 - room * room / (peak + room - start);
    let whiteness = 1.0 - 1.0 / (0.15 * (peak - shown_peak) + 1.0);
    (painted * (shown_peak / peak)).lerp(Vec3::splat(shown_peak), whiteness)
}

/// sRGB code of tonemapped light. `exposure` multiplies the light first.
pub fn tonemapped(color: Vec3, curve: Tonemap, exposure: f32) -> Vec3 {
    let exposed = color * exposure;
    let shown = match curve {
        Tonemap::Aces => aces_fitted(exposed),
        Tonemap::KeepHue => aces_keeping_hue(exposed),
        Tonemap::Agx => agx(exposed),
        Tonemap::Neutral => pbr_neutral(exposed),
    };
    shown.map(srgb_from_linear)
}

/// From the light of an image to the colors of a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayTransform {
    /// Factor on the light; 0 for an image of data, which is shown as it is.
    pub exposure: f32,
    /// Ignored for data.
    pub tonemap: Tonemap,
}

impl DisplayTransform {
    /// Of images that hold data.
    pub const DATA: Self = Self { exposure: 0.0, tonemap: Tonemap::Aces };

    /// Returns the sRGB code of a texel.
    pub fn code(&self, texel: Vec3) -> Vec3 {
        if self.exposure == 0.0 { texel } else { tonemapped(texel, self.tonemap, self.exposure) }
    }
}

/// Dither to add before rounding to 8 bits, so that slow gradients do not band: triangular noise, within half a step
/// either way.
pub fn dither(at: UVec2) -> f32 {
    let hash = pcg3d(at.extend(0));
    (unit(hash.x) - unit(hash.y)) * (0.5 / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tonemap_curves_keep_black_and_white_and_are_monotonic() {
        for curve in [aces_fitted, aces_keeping_hue, agx, pbr_neutral] {
            assert!(curve(Vec3::ZERO).max_element() < 1e-3);
            assert!(curve(Vec3::splat(100.0)).min_element() > 0.97);
            let grays: Vec<_> = (0..200).map(|step| curve(Vec3::splat(0.02 * step as f32)).x).collect();
            assert!(grays.is_sorted());
        }
    }

    /// Hue on a circle of 360 degrees; red at 0, green at 120.
    fn hue(color: Vec3) -> f32 {
        let across = 3.0_f32.sqrt() * (color.y - color.z);
        across.atan2(2.0 * color.x - color.y - color.z).to_degrees()
    }

    #[test]
    fn bright_fire_keeps_its_hue_where_the_curve_says_so() {
        let orange = vec3(1.0, 0.3, 0.03);
        let cyan = vec3(0.02, 0.7, 1.0);
        let violet = vec3(0.5, 0.05, 1.0);
        let turn = |curve: fn(Vec3) -> Vec3, fire: Vec3| {
            let apart = hue(curve(fire * 8.0)) - hue(fire);
            (apart - 360.0 * (apart / 360.0).round()).abs()
        };
        for fire in [orange, cyan, violet] {
            assert!(turn(aces_keeping_hue, fire) < 0.5 && turn(pbr_neutral, fire) < 0.5, "{fire}");
        }
        // Hues that ACES turns are the reason for the others.
        assert!(turn(aces_fitted, orange) > 25.0 && turn(aces_fitted, violet) > 25.0);
    }

    #[test]
    fn a_kept_hue_has_the_contrast_of_aces() {
        for color in [vec3(0.2, 0.5, 0.1), vec3(3.0, 0.4, 0.1), vec3(0.3, 0.3, 0.3)] {
            let kept = aces_keeping_hue(color);
            let fitted = aces_fitted(color);
            assert!((kept.max_element() - fitted.max_element()).abs() < 1e-3, "{color}");
            assert!((kept.min_element() - fitted.min_element()).abs() < 1e-3, "{color}");
        }
    }
}
