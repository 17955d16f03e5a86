//! What can be done to the stops of a gradient. Nothing here draws.

use crate::assets::ramp::bake::{Curve, HexColour, RampStop};

/// Puts stops in the order of their places; those at one place stay in theirs.
pub fn sort(stops: &mut [RampStop]) {
    stops.sort_by(|a, b| a.at.total_cmp(&b.at));
}

/// Adds a stop that goes on as the one before it does; gives its index.
pub fn add(stops: &mut Vec<RampStop>, at: f32, colour: HexColour) -> usize {
    let index = stops.partition_point(|stop| stop.at <= at);
    let neighbour = stops.get(index.saturating_sub(1));
    let curve = neighbour.map_or(Curve::default(), |stop| stop.curve);
    stops.insert(index, RampStop { at, colour, curve });
    index
}

/// Puts a copy of a stop behind it; gives its index.
pub fn copy(stops: &mut Vec<RampStop>, index: usize) -> usize {
    match stops.get(index).cloned() {
        Some(stop) => {
            stops.insert(index + 1, stop);
            index + 1
        }
        None => index,
    }
}

/// The place for one more: half way from a stop to the next, or to the one before the last.
pub fn gap(stops: &[RampStop], index: usize) -> f32 {
    let at = |index: usize| stops.get(index).map(|stop| stop.at);
    let from = at(index).unwrap_or(0.0);
    let to = at(index + 1).unwrap_or(if from < 1.0 { 1.0 } else { at(index.wrapping_sub(1)).unwrap_or(0.0) });
    f32::midpoint(from, to)
}

/// Removes a stop, unless it is the last one; gives the index of the one to go on with.
pub fn remove(stops: &mut Vec<RampStop>, index: usize) -> usize {
    if stops.len() > 1 && index < stops.len() {
        stops.remove(index);
    }
    index.min(stops.len().saturating_sub(1))
}

/// Puts a stop elsewhere, clamped to the gradient; gives its new index. It passes others only where it goes beyond them: come to
/// the place of another it stays on its side, and makes a hard edge.
pub fn move_to(stops: &mut [RampStop], mut index: usize, at: f32) -> usize {
    let Some(stop) = stops.get_mut(index).filter(|_| at.is_finite()) else { return index };
    stop.at = at.clamp(0.0, 1.0);
    let at = stop.at;
    while index + 1 < stops.len() && stops[index + 1].at < at {
        stops.swap(index, index + 1);
        index += 1;
    }
    while index > 0 && stops[index - 1].at > at {
        stops.swap(index, index - 1);
        index -= 1;
    }
    index
}

/// The nearest border of equal parts, if it snaps to those.
pub fn snapped(at: f32, parts: Option<u32>) -> f32 {
    parts.map_or(at, |parts| (at * parts as f32).round() / parts as f32)
}

/// The place of another stop that is near, so that the two make a hard edge; else the same place.
pub fn beside(stops: &[RampStop], index: usize, at: f32) -> f32 {
    const NEAR: f32 = 0.02;
    let others = stops.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, stop)| stop.at);
    let near = others.filter(|other| (other - at).abs() <= NEAR);
    near.min_by(|a, b| (a - at).abs().total_cmp(&(b - at).abs())).unwrap_or(at)
}

/// The place some steps from another: thousandths, hundredths if it is `far`, and equal parts if it snaps to those.
pub fn nudged(at: f32, steps: f32, far: bool, parts: Option<u32>) -> f32 {
    // To where a step leads is rounded: a hundred steps and as many back end where they began.
    let round = |at: f32, unit: f32| (at * unit).round() / unit;
    match parts.map(|parts| parts as f32) {
        // The next border, however near it is.
        Some(parts) if steps > 0.0 => ((at * parts + 1.0e-3).floor() + steps) / parts,
        Some(parts) => ((at * parts - 1.0e-3).ceil() + steps) / parts,
        None => round(at + steps * if far { 0.01 } else { 0.001 }, 1.0e4),
    }
}

/// Turns the gradient round, so that what was at 0 is at 1. Curves go with the parts that they are of; a constant part keeps its
/// colour, which is that of its other end then.
pub fn flip(stops: &mut Vec<RampStop>) {
    sort(stops);
    let Some(last) = stops.last().cloned() else { return };
    // Whether a stop's colour is held up to the next.
    let is_held = |index: usize| {
        let (stop, next) = (&stops[index], stops.get(index + 1));
        stop.curve == Curve::Constant && next.is_some_and(|next| next.at > stop.at)
    };
    let mut flipped = Vec::with_capacity(stops.len() + 1);
    for (index, stop) in stops.iter().enumerate().rev() {
        let at = 1.0 - stop.at;
        let is_last = index + 1 == stops.len();
        let before = index.checked_sub(1).map(|before| (&stops[before], is_held(before)));
        if let Some((before, true)) = before {
            // What it comes to there, unless that is held already.
            if is_last {
                flipped.push(RampStop { at: 0.0, colour: stop.colour, curve: Curve::Constant });
            } else if !is_held(index) {
                flipped.push(RampStop { at, ..stop.clone() });
            }
            flipped.push(RampStop { at, colour: before.colour, curve: Curve::Constant });
        } else if before.is_some() || !is_held(index) {
            let curve = before.map_or(last.curve, |(before, _)| before.curve);
            flipped.push(RampStop { at, colour: stop.colour, curve });
        }
    }
    *stops = flipped;
}

/// Puts stops at even distances between the first and the last, or over the whole if those are at one place.
pub fn distribute(stops: &mut [RampStop]) {
    sort(stops);
    let (Some(first), Some(last)) = (stops.first(), stops.last()) else { return };
    let (from, to) = if first.at < last.at { (first.at, last.at) } else { (0.0, 1.0) };
    let parts = (stops.len() - 1).max(1) as f32;
    for (index, stop) in stops.iter_mut().enumerate() {
        let share = index as f32 / parts;
        stop.at = from * (1.0 - share) + to * share;
    }
}

/// Puts stops at even distances from 0 on, so that the parts to the right of each are of one width: for steps.
pub fn step_evenly(stops: &mut [RampStop]) {
    sort(stops);
    let parts = stops.len().max(1) as f32;
    for (index, stop) in stops.iter_mut().enumerate() {
        stop.at = index as f32 / parts;
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "places that are written out, and halves of them")]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::assets::ramp::bake::{RampRecipe, RampRow};

    fn stops(list: &[(f32, u8, Curve)]) -> Vec<RampStop> {
        list.iter().map(|&(at, grey, curve)| RampStop { curve, ..RampStop::new(at, HexColour([grey; 3])) }).collect()
    }

    fn places(stops: &[RampStop]) -> Vec<f32> {
        stops.iter().map(|stop| stop.at).collect()
    }

    fn greys(stops: &[RampStop]) -> Vec<u8> {
        stops.iter().map(|stop| stop.colour.0[0]).collect()
    }

    const SMOOTH: Curve = Curve::Monotone;

    #[test]
    fn a_stop_passes_others_only_beyond_them() {
        let mut list = stops(&[(0.0, 0, SMOOTH), (0.5, 1, SMOOTH), (0.5, 2, SMOOTH), (1.0, 3, SMOOTH)]);
        assert_eq!(move_to(&mut list, 0, 0.5), 0);
        assert_eq!(greys(&list), [0, 1, 2, 3]);
        assert_eq!(move_to(&mut list, 0, 0.6), 2);
        assert_eq!(greys(&list), [1, 2, 0, 3]);
        assert_eq!(move_to(&mut list, 2, 0.5), 2, "from above it stays above");
        assert_eq!(move_to(&mut list, 2, -3.0), 0);
        assert_eq!((greys(&list), list[0].at), (vec![0, 1, 2, 3], 0.0));
        assert_eq!(move_to(&mut list, 3, f32::NAN), 3);
        assert_eq!(list[3].at, 1.0);
    }

    #[test]
    fn a_stop_is_added_in_its_place_and_the_last_one_stays() {
        let mut list = stops(&[(0.2, 0, Curve::Ease), (0.2, 1, Curve::Constant), (0.8, 2, SMOOTH)]);
        assert_eq!(add(&mut list, 0.2, HexColour([9; 3])), 2);
        assert_eq!((greys(&list), list[2].curve), (vec![0, 1, 9, 2], Curve::Constant));
        assert_eq!(add(&mut list, 0.1, HexColour([8; 3])), 0);
        assert_eq!(list[0].curve, Curve::Ease);
        assert_eq!(remove(&mut list, 4), 3);
        while list.len() > 1 {
            assert_eq!(remove(&mut list, 0), 0);
        }
        assert_eq!((remove(&mut list, 0), list.len()), (0, 1));
    }

    #[test]
    fn there_is_a_place_for_one_more_wherever_it_can_be() {
        let list = stops(&[(0.0, 0, SMOOTH), (0.5, 0, SMOOTH), (1.0, 0, SMOOTH)]);
        assert_eq!([0, 1, 2].map(|index| gap(&list, index)), [0.25, 0.75, 0.75]);
        assert_eq!(gap(&stops(&[(0.4, 0, SMOOTH)]), 0), 0.7);
        assert_eq!(gap(&stops(&[(1.0, 0, SMOOTH)]), 0), 0.5);
    }

    #[test]
    fn arrows_go_by_thousandths_hundredths_and_to_equal_parts() {
        let close = |at: f32, expected: f32| assert!((at - expected).abs() < 1.0e-5, "{at} {expected}");
        close(nudged(0.25, 1.0, false, None), 0.251);
        close(nudged(0.25, -1.0, true, None), 0.24);
        close(nudged(0.25, 1.0, false, Some(10)), 0.3);
        close(nudged(0.25, -1.0, false, Some(10)), 0.2);
        close(nudged(0.3, 1.0, true, Some(10)), 0.4);
        close(nudged(0.3, -1.0, false, Some(10)), 0.2);
        close(nudged(0.3, 1.0, false, Some(3)), 1.0 / 3.0);
        let mut at = 0.123;
        (0..100).for_each(|_| at = nudged(at, 1.0, false, None));
        (0..100).for_each(|_| at = nudged(at, -1.0, false, None));
        close(at, 0.123);
        close(snapped(0.349, Some(10)), 0.3);
        close(snapped(0.349, Some(8)), 0.375);
        close(snapped(0.349, None), 0.349);
    }

    #[test]
    fn stops_are_distributed_between_the_first_and_the_last() {
        let mut list = stops(&[(0.2, 0, SMOOTH), (0.3, 1, SMOOTH), (0.3, 2, SMOOTH), (0.8, 3, SMOOTH)]);
        distribute(&mut list);
        assert_eq!(greys(&list), [0, 1, 2, 3]);
        for (at, expected) in places(&list).into_iter().zip([0.2, 0.4, 0.6, 0.8]) {
            assert!((at - expected).abs() < 1.0e-6, "{at}");
        }
        let mut list = stops(&[(0.5, 0, SMOOTH), (0.5, 1, SMOOTH), (0.5, 2, SMOOTH)]);
        distribute(&mut list);
        assert_eq!(places(&list), [0.0, 0.5, 1.0]);
        let mut one = stops(&[(0.5, 0, SMOOTH)]);
        distribute(&mut one);
        assert_eq!(places(&one), [0.0]);
    }

    #[test]
    fn hard_steps_stay_as_many_when_they_are_turned_round() {
        let hard = Curve::Constant;
        let mut list = stops(&[(0.0, 1, hard), (0.45, 2, hard), (0.72, 3, hard)]);
        flip(&mut list);
        assert_eq!(greys(&list), [3, 2, 1]);
        for (at, expected) in places(&list).into_iter().zip([0.0, 0.28, 0.55]) {
            assert!((at - expected).abs() < 1.0e-6, "{at}");
        }
    }

    proptest! {
        #[test]
        fn turned_round_a_gradient_is_its_mirror(
            list in prop::collection::vec((0u8..=20, any::<u8>(), 0usize..4), 1..8),
        ) {
            let mut list: Vec<_> = list
                .into_iter()
                .map(|(at, grey, curve)| (f32::from(at) / 20.0, grey, Curve::ALL[curve]))
                .collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            let row = stops(&list);
            let mut flipped = row.clone();
            flip(&mut flipped);
            let gradient = |stops: &[RampStop]| {
                let rows = vec![RampRow { stops: stops.to_vec(), ..RampRow::default() }];
                RampRecipe { rows, ..RampRecipe::default() }.gradient().unwrap()
            };
            let (before, after) = (gradient(&row), gradient(&flipped));
            // Between the places: at an edge the side counts.
            for step in 0..60 {
                let u = (step as f32 + 0.5) / 60.0;
                let apart = (before.sample(u, 0.0) - after.sample(1.0 - u, 0.0)).abs().max_element();
                prop_assert!(apart < 1.0e-3, "{u}: {apart} {flipped:?}");
            }
        }

        #[test]
        fn order_holds_whatever_is_moved(
            list in prop::collection::vec(0.0f32..=1.0, 1..8), index in 0usize..8, at in -1.0f32..2.0,
        ) {
            let mut list: Vec<_> = list.into_iter().map(|at| RampStop::new(at, HexColour([0; 3]))).collect();
            sort(&mut list);
            let index = index % list.len();
            list[index].colour = HexColour([9; 3]);
            let index = move_to(&mut list, index, at);
            prop_assert_eq!((list[index].colour, list[index].at), (HexColour([9; 3]), at.clamp(0.0, 1.0)));
            prop_assert!(list.is_sorted_by(|a, b| a.at <= b.at));
        }
    }
}
