//! Curves of up to eight points over the life of a particle, or over an emission. WGSL: `shaders/lib/curve.wgsl`.

use glam::{Vec2, Vec4, Vec4Swizzles};

use super::saturate;
use crate::settings::MAX_CURVE_POINTS;

/// Points (x, value) of a curve, two in each vector. The last is repeated.
pub type CurvePoints = [Vec4; MAX_CURVE_POINTS / 2];

/// Point of a curve.
pub fn curve_point(curve: &CurvePoints, index: usize) -> Vec2 {
    let pair = curve[index / 2];
    if index % 2 == 1 { pair.zw() } else { pair.xy() }
}

/// Value of a curve at an age.
pub fn curve_value(curve: &CurvePoints, age: f32) -> f32 {
    let mut last = curve_point(curve, 0);
    let mut value = last.y;
    for index in 1..MAX_CURVE_POINTS {
        let next = curve_point(curve, index);
        value += (next.y - last.y) * saturate((age - last.x) / (next.x - last.x).max(1.0e-6));
        last = next;
    }
    value
}

/// Integral of a curve from birth to an age.
pub fn curve_integral(curve: &CurvePoints, age: f32) -> f32 {
    let mut last = curve_point(curve, 0);
    let mut sum = age.min(last.x) * last.y;
    for index in 1..MAX_CURVE_POINTS {
        let next = curve_point(curve, index);
        let width = next.x - last.x;
        let part = (age - last.x).clamp(0.0, width);
        sum += part * (last.y + 0.5 * (next.y - last.y) * part / width.max(1.0e-6));
        last = next;
    }
    sum + (age - last.x).max(0.0) * last.y
}

/// Smoothstep: 0..1 with zero slope at both ends.
pub fn smoothstep_unit(x: f32) -> f32 {
    let s = x.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Curve;

    #[test]
    fn values_lie_on_straight_lines() {
        let curve: Curve = "0.2:1,0.6:3,1:0".parse().unwrap();
        for (age, expected) in [(0.0, 1.0), (0.2, 1.0), (0.4, 2.0), (0.6, 3.0), (0.8, 1.5), (1.0, 0.0)] {
            let value = curve_value(&curve.packed(), age);
            assert!((value - expected).abs() < 1e-6, "{age}: {value}");
        }
        assert!((curve_integral(&curve.packed(), 1.0) - (0.2 + 0.8 + 0.6)).abs() < 1e-6);
        assert!((curve_integral(&Curve::constant(2.0).packed(), 0.3) - 0.6).abs() < 1e-6);
    }
}
