//! Layout of the stops' handles: handles never overlap, even if stops are close together.

use std::ops::Range;

/// Number of handles if not all fit. Small, so that handles stay near their stops.
const FEW: usize = 9;

/// Returns the stops with handles out of `count`: all, or if not all fit, a few around the selected one.
pub fn visible_handles(count: usize, selected: usize, room: usize) -> Range<usize> {
    let room = if count <= room { count } else { room.clamp(1, FEW) };
    let start = selected.saturating_sub(room / 2).min(count.saturating_sub(room));
    start..count.min(start + room)
}

/// Returns sorted positions from 0 to `width` that are at least `gap` apart and as close as possible to the `wanted`
/// ones, which must be sorted. If they do not all fit, the last ones exceed `width`.
pub fn spread(wanted: &[f32], width: f32, gap: f32) -> Vec<f32> {
    // After subtracting index times gap, positions only have to be sorted: the least-squares solution by the pool
    // adjacent violators algorithm replaces unsorted runs by their mean.
    let mut runs: Vec<(f32, usize)> = Vec::new();
    for (index, position) in wanted.iter().enumerate() {
        let mut run = (position - index as f32 * gap, 1);
        while let Some(before) = runs.pop_if(|before| before.0 > run.0) {
            let count = before.1 + run.1;
            run = ((before.0 * before.1 as f32 + run.0 * run.1 as f32) / count as f32, count);
        }
        runs.push(run);
    }
    let most = (width - wanted.len().saturating_sub(1) as f32 * gap).max(0.0);
    let positions =
        runs.into_iter().flat_map(|(position, count)| std::iter::repeat_n(position.clamp(0.0, most), count));
    positions.enumerate().map(|(index, position)| position + index as f32 * gap).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn handles_are_at_their_stops_if_there_is_room() {
        assert_eq!(spread(&[0.0, 30.0, 100.0], 100.0, 10.0), [0.0, 30.0, 100.0]);
        assert_eq!(spread(&[50.0, 50.0, 50.0], 100.0, 10.0), [40.0, 50.0, 60.0]);
        assert_eq!(spread(&[100.0, 100.0], 100.0, 10.0), [90.0, 100.0]);
        assert!(spread(&[], 100.0, 10.0).is_empty());
    }

    #[test]
    fn the_selected_stop_always_has_a_handle() {
        assert_eq!(visible_handles(5, 4, 20), 0..5);
        assert_eq!(visible_handles(20, 4, 20), 0..20);
        assert_eq!(visible_handles(100, 50, 20), 46..55);
        assert_eq!(visible_handles(100, 0, 20), 0..9);
        assert_eq!(visible_handles(100, 99, 20), 91..100);
        assert_eq!(visible_handles(100, 50, 4), 48..52);
        assert_eq!(visible_handles(3, 2, 0), 2..3);
        assert_eq!(visible_handles(0, 0, 5), 0..0);
    }

    proptest! {
        #[test]
        fn handles_are_at_least_a_gap_apart(mut wanted in prop::collection::vec(0.0f32..=200.0, 1..20)) {
            wanted.sort_by(f32::total_cmp);
            let positions = spread(&wanted, 200.0, 10.0);
            prop_assert_eq!(positions.len(), wanted.len());
            prop_assert!(positions.windows(2).all(|pair| pair[1] - pair[0] > 9.99));
            prop_assert!(positions[0] >= 0.0 && positions[positions.len() - 1] <= 200.01);
        }
    }
}
