//! How far sliders go.

use std::ops::RangeInclusive;

/// Widest range that a linear slider can be aimed in, and how many times its low end the high end may be.
const WIDEST_LINEAR: f32 = 40.0;
const MOST_LINEAR: f32 = 100.0;
/// Where sliders of endless ranges end; more can be typed.
const FAR: f32 = 1000.0;

/// What is usual of a number, where that is less than what it may be: the slider goes from one to the other, straight.
pub type Usual = Option<(f32, f32)>;

/// What the slider of a number reaches, and whether that is too wide to be linear.
pub fn reach(range: &RangeInclusive<f32>, value: f32) -> (RangeInclusive<f32>, bool) {
    let (low, high) = (*range.start(), *range.end());
    let shown_high = if high > FAR { FAR.max(value.abs() * 2.0).min(high) } else { high };
    let shown_low = if low < -FAR { -FAR.max(value.abs() * 2.0) } else { low };
    let is_wide = shown_high - shown_low > WIDEST_LINEAR || low > 0.0 && high > MOST_LINEAR * low;
    (shown_low..=shown_high, is_wide)
}

/// Whether the slider of a whole number is too wide to be linear.
pub fn is_wide(range: &RangeInclusive<u32>) -> bool {
    *range.end() as f32 > MOST_LINEAR * (*range.start()).max(1) as f32
}
