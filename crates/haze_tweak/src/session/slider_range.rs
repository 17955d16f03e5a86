//! Ranges of sliders.

use std::ops::RangeInclusive;

/// Widest range that suits a linear slider, and the largest ratio of its high end to its low end.
const MAX_LINEAR_WIDTH: f32 = 40.0;
const MAX_LINEAR_RATIO: f32 = 100.0;
/// End of the slider for a range without bounds. Larger values can be typed.
const UNBOUNDED_END: f32 = 1000.0;

/// Usual range of a number, if it is narrower than the valid one. The slider covers it linearly.
pub type UsualRange = Option<(f32, f32)>;

/// Returns the range of a number's slider, and true if it is too wide to be linear. Angles are always linear.
pub fn slider_range(range: &RangeInclusive<f32>, unit: &str, value: f32) -> (RangeInclusive<f32>, bool) {
    let low = *range.start();
    let high = *range.end();
    let shown_high = if high > UNBOUNDED_END { UNBOUNDED_END.max(value.abs() * 2.0).min(high) } else { high };
    let shown_low = if low < -UNBOUNDED_END { -UNBOUNDED_END.max(value.abs() * 2.0) } else { low };
    let is_wide = shown_high - shown_low > MAX_LINEAR_WIDTH || low > 0.0 && high > MAX_LINEAR_RATIO * low;
    let needs_log_slider = is_wide && unit != "degrees";
    (shown_low..=shown_high, needs_log_slider)
}

/// Returns true if the slider of an integer is too wide to be linear.
pub fn needs_log_slider(range: &RangeInclusive<u32>) -> bool {
    *range.end() as f32 > MAX_LINEAR_RATIO * (*range.start()).max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_linear_and_other_wide_ranges_logarithmic() {
        assert_eq!(slider_range(&(-180.0..=180.0), "degrees", 0.0), (-180.0..=180.0, false));
        assert_eq!(slider_range(&(1.0..=150.0), "degrees", 45.0), (1.0..=150.0, false));
        assert_eq!(slider_range(&(0.0..=100.0), "m", 1.0), (0.0..=100.0, true));
    }
}
