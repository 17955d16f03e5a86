//! Ranges of sliders.

use std::ops::RangeInclusive;

/// Widest range that suits a linear slider, and the largest ratio of its high end to its low end.
const WIDEST_LINEAR: f32 = 40.0;
const MOST_LINEAR: f32 = 100.0;
/// End of the slider for a range without bounds. Larger values can be typed.
const FAR: f32 = 1000.0;

/// Usual range of a number, if it is narrower than the valid one. The slider covers it linearly.
pub type UsualRange = Option<(f32, f32)>;

/// Returns the range of a number's slider, and true if it is too wide to be linear.
pub fn reach(range: &RangeInclusive<f32>, value: f32) -> (RangeInclusive<f32>, bool) {
    let (low, high) = (*range.start(), *range.end());
    let shown_high = if high > FAR { FAR.max(value.abs() * 2.0).min(high) } else { high };
    let shown_low = if low < -FAR { -FAR.max(value.abs() * 2.0) } else { low };
    let is_wide = shown_high - shown_low > WIDEST_LINEAR || low > 0.0 && high > MOST_LINEAR * low;
    (shown_low..=shown_high, is_wide)
}

/// Returns true if the slider of an integer is too wide to be linear.
pub fn is_wide(range: &RangeInclusive<u32>) -> bool {
    *range.end() as f32 > MOST_LINEAR * (*range.start()).max(1) as f32
}
