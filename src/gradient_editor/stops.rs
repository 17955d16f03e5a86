//! What can be done to the stops of a gradient, and to those of them that are selected. Nothing here draws.

use std::ops::Range;

use super::selection::Selection;
use crate::assets::ramp::bake::{Curve, HexColour, RampStop};

/// Puts stops in the order of their places; those at one place stay in theirs.
pub fn sort(stops: &mut [RampStop]) {
    stops.sort_by(|a, b| a.at.total_cmp(&b.at));
}

/// The same with what is selected of them.
fn sort_selected(stops: &mut [RampStop], selection: &mut Selection) {
    let mut order: Vec<_> = (0..stops.len()).collect();
    order.sort_by(|a, b| stops[*a].at.total_cmp(&stops[*b].at));
    let mut moved_to = vec![0; stops.len()];
    order.iter().enumerate().for_each(|(new, old)| moved_to[*old] = new);
    *selection = selection.map(|old| moved_to.get(old).copied().unwrap_or(old));
    sort(stops);
}

/// Adds a stop that goes on as the one before it does; gives its index.
pub fn add(stops: &mut Vec<RampStop>, at: f32, colour: HexColour) -> usize {
    let index = stops.partition_point(|stop| stop.at <= at);
    let neighbour = stops.get(index.saturating_sub(1));
    let curve = neighbour.map_or(Curve::default(), |stop| stop.curve);
    stops.insert(index, RampStop { at, colour, curve });
    index
}

/// Puts a copy of each selected stop behind it, and selects the copies.
pub fn copy(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    let copied: Vec<_> = selection.iter().filter(|index| *index < stops.len()).collect();
    for index in copied.iter().rev() {
        stops.insert(index + 1, stops[*index].clone());
    }
    // Behind itself, and behind those of the selected that are before it.
    *selection = selection.map(|index| index + copied.partition_point(|before| *before <= index));
}

/// The place for one more: half way from a stop to the next, or to the one before the last.
pub fn gap(stops: &[RampStop], index: usize) -> f32 {
    let at = |index: usize| stops.get(index).map(|stop| stop.at);
    let from = at(index).unwrap_or(0.0);
    let to = at(index + 1).unwrap_or(if from < 1.0 { 1.0 } else { at(index.wrapping_sub(1)).unwrap_or(0.0) });
    f32::midpoint(from, to)
}

/// Removes what is selected, but for the lead where that is all; selects the one to go on with.
pub fn remove(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    let is_all = selection.count() >= stops.len();
    let mut index = 0;
    stops.retain(|_| {
        index += 1;
        !selection.contains(index - 1) || is_all && selection.lead() == index - 1
    });
    *selection = Selection::one(selection.range().start.min(stops.len().saturating_sub(1)));
}

/// Puts the lead elsewhere and the others as far, kept to the gradient with the distances between them. They pass others only
/// where they go beyond them: come to the place of another a stop stays on its side, and makes a hard edge.
pub fn move_to(stops: &mut [RampStop], selection: &mut Selection, at: f32) {
    let Some(lead) = stops.get(selection.lead()).map(|lead| lead.at).filter(|_| at.is_finite()) else { return };
    let (least, most) = ends(stops, selection.iter());
    let at = at.min(1.0 - (most - lead)).max(lead - least);
    for index in selection.iter() {
        // Those at one place stay together, whatever is rounded.
        stops[index].at = (at + (stops[index].at - lead)).clamp(0.0, 1.0);
    }
    sort_selected(stops, selection);
}

/// Multiplies the places of what is selected.
pub fn scale(stops: &mut [RampStop], selection: &mut Selection, times: f32) {
    for index in selection.iter() {
        stops[index].at = (stops[index].at * times).clamp(0.0, 1.0);
    }
    sort_selected(stops, selection);
}

/// The places of the first and the last.
fn ends(stops: &[RampStop], indices: impl Iterator<Item = usize>) -> (f32, f32) {
    indices.fold((1.0, 0.0), |(least, most): (f32, f32), index| (least.min(stops[index].at), most.max(stops[index].at)))
}

/// The nearest border of equal parts, if it snaps to those.
pub fn snapped(at: f32, parts: Option<u32>) -> f32 {
    parts.map_or(at, |parts| (at * parts as f32).round() / parts as f32)
}

/// The place of a stop that is near and not selected, so that the two make a hard edge; else the same place.
pub fn beside(stops: &[RampStop], selection: &Selection, at: f32) -> f32 {
    const NEAR: f32 = 0.02;
    let others = stops.iter().enumerate().filter(|(other, _)| !selection.contains(*other)).map(|(_, stop)| stop.at);
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

/// What is turned round or mirrored: what lies between the first and the last that are selected, or the whole gradient if that is
/// one. The stops, and from where to where.
fn part(stops: &[RampStop], selection: &Selection) -> (Range<usize>, f32, f32) {
    let range = selection.range();
    match (stops.get(range.start), stops.get(range.end.saturating_sub(1))) {
        (Some(first), Some(last)) if selection.is_many() => (range, first.at, last.at),
        _ => (0..stops.len(), 0.0, 1.0),
    }
}

/// Puts others in the place of a part, and selects them where the part was.
fn put_part(stops: &mut Vec<RampStop>, selection: &mut Selection, range: Range<usize>, others: Vec<RampStop>) {
    let end = (range.start + others.len()).saturating_sub(1);
    if selection.is_many() {
        *selection = Selection::between(range.start, end);
    }
    stops.splice(range, others);
}

/// Turns a part round, so that what was at its one end is at the other.
pub fn flip(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    sort_selected(stops, selection);
    let (range, from, to) = part(stops, selection);
    let turned = turned(&stops[range.clone()], from + to, from, to);
    put_part(stops, selection, range, turned);
}

/// Squeezes a part into its first half, and puts its mirror picture behind it.
pub fn mirror(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    sort_selected(stops, selection);
    let (range, from, to) = part(stops, selection);
    let middle = f32::midpoint(from, to);
    let mut mirrored = stops[range.clone()].to_vec();
    mirrored.iter_mut().for_each(|stop| stop.at = f32::midpoint(stop.at, from).clamp(from, middle));
    let back = turned(&mirrored, from + to, middle, to);
    if let (Some(last), Some(first)) = (mirrored.last(), back.first())
        && (last.at, last.colour) == (first.at, first.colour)
    {
        // They meet in one.
        mirrored.pop();
    }
    mirrored.extend(back);
    put_part(stops, selection, range, mirrored);
}

/// Stops in reverse, each at `sum` less its place, which is from `from` to `to`. Curves go with the parts that they are of; a
/// constant part keeps its colour, which is that of its other end then.
fn turned(stops: &[RampStop], sum: f32, from: f32, to: f32) -> Vec<RampStop> {
    let Some(last) = stops.last() else { return Vec::new() };
    // Whether a stop's colour is held up to the next.
    let is_held = |index: usize| {
        let (stop, next) = (&stops[index], stops.get(index + 1));
        stop.curve == Curve::Constant && next.is_some_and(|next| next.at > stop.at)
    };
    let mut flipped = Vec::with_capacity(stops.len() + 1);
    for (index, stop) in stops.iter().enumerate().rev() {
        let at = (sum - stop.at).clamp(from, to);
        let is_last = index + 1 == stops.len();
        let before = index.checked_sub(1).map(|before| (&stops[before], is_held(before)));
        if let Some((before, true)) = before {
            // What it comes to there, unless that is held already.
            if is_last {
                flipped.push(RampStop { at: from, colour: stop.colour, curve: Curve::Constant });
            } else if !is_held(index) {
                flipped.push(RampStop { at, ..stop.clone() });
            }
            flipped.push(RampStop { at, colour: before.colour, curve: Curve::Constant });
        } else if before.is_some() || !is_held(index) {
            let curve = before.map_or(last.curve, |(before, _)| before.curve);
            flipped.push(RampStop { at, colour: stop.colour, curve });
        }
    }
    flipped
}

/// What is distributed: what is selected, or all where that is one.
fn distributed(stops: &[RampStop], selection: &Selection) -> Vec<usize> {
    if selection.is_many() { selection.iter().collect() } else { (0..stops.len()).collect() }
}

/// Puts stops at even distances between the first and the last, or over the whole if those are at one place.
pub fn distribute(stops: &mut [RampStop], selection: &mut Selection) {
    let indices = distributed(stops, selection);
    let (first, last) = ends(stops, indices.iter().copied());
    let (from, to) = if first < last { (first, last) } else { (0.0, 1.0) };
    let parts = indices.len().saturating_sub(1).max(1) as f32;
    for (place, index) in indices.into_iter().enumerate() {
        let share = place as f32 / parts;
        stops[index].at = from * (1.0 - share) + to * share;
    }
    sort_selected(stops, selection);
}

/// Puts stops at even distances so that the parts to the right of each are of one width, for steps: all from 0 on, or those
/// that are selected from the first of them up to the stop behind the last.
pub fn step_evenly(stops: &mut [RampStop], selection: &mut Selection) {
    let indices = distributed(stops, selection);
    let from = if selection.is_many() { ends(stops, indices.iter().copied()).0 } else { 0.0 };
    let behind = indices.last().and_then(|last| stops.get(last + 1));
    let to = behind.map_or(1.0, |behind| behind.at);
    let parts = indices.len().max(1) as f32;
    for (place, index) in indices.into_iter().enumerate() {
        stops[index].at = (from + (to - from) * place as f32 / parts).clamp(from, to);
    }
    sort_selected(stops, selection);
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

    fn moved(stops: &mut [RampStop], index: usize, at: f32) -> usize {
        let mut selection = Selection::one(index);
        move_to(stops, &mut selection, at);
        selection.lead()
    }

    fn removed(stops: &mut Vec<RampStop>, index: usize) -> usize {
        let mut selection = Selection::one(index);
        remove(stops, &mut selection);
        selection.lead()
    }

    fn selected(selection: &Selection) -> Vec<usize> {
        selection.iter().collect()
    }

    fn all() -> Selection {
        Selection::one(0)
    }

    #[test]
    fn a_stop_passes_others_only_beyond_them() {
        let mut list = stops(&[(0.0, 0, SMOOTH), (0.5, 1, SMOOTH), (0.5, 2, SMOOTH), (1.0, 3, SMOOTH)]);
        assert_eq!(moved(&mut list, 0, 0.5), 0);
        assert_eq!(greys(&list), [0, 1, 2, 3]);
        assert_eq!(moved(&mut list, 0, 0.6), 2);
        assert_eq!(greys(&list), [1, 2, 0, 3]);
        assert_eq!(moved(&mut list, 2, 0.5), 2, "from above it stays above");
        assert_eq!(moved(&mut list, 2, -3.0), 0);
        assert_eq!((greys(&list), list[0].at), (vec![0, 1, 2, 3], 0.0));
        assert_eq!(moved(&mut list, 3, f32::NAN), 3);
        assert_eq!(list[3].at, 1.0);
    }

    #[test]
    fn a_stop_is_added_in_its_place_and_the_last_one_stays() {
        let mut list = stops(&[(0.2, 0, Curve::Ease), (0.2, 1, Curve::Constant), (0.8, 2, SMOOTH)]);
        assert_eq!(add(&mut list, 0.2, HexColour([9; 3])), 2);
        assert_eq!((greys(&list), list[2].curve), (vec![0, 1, 9, 2], Curve::Constant));
        assert_eq!(add(&mut list, 0.1, HexColour([8; 3])), 0);
        assert_eq!(list[0].curve, Curve::Ease);
        assert_eq!(removed(&mut list, 4), 3);
        while list.len() > 1 {
            assert_eq!(removed(&mut list, 0), 0);
        }
        assert_eq!((removed(&mut list, 0), list.len()), (0, 1));
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
        distribute(&mut list, &mut all());
        assert_eq!(greys(&list), [0, 1, 2, 3]);
        for (at, expected) in places(&list).into_iter().zip([0.2, 0.4, 0.6, 0.8]) {
            assert!((at - expected).abs() < 1.0e-6, "{at}");
        }
        let mut list = stops(&[(0.5, 0, SMOOTH), (0.5, 1, SMOOTH), (0.5, 2, SMOOTH)]);
        distribute(&mut list, &mut all());
        assert_eq!(places(&list), [0.0, 0.5, 1.0]);
        let mut one = stops(&[(0.5, 0, SMOOTH)]);
        distribute(&mut one, &mut all());
        assert_eq!(places(&one), [0.0]);
    }

    #[test]
    fn what_is_selected_moves_together_and_keeps_its_distances() {
        let mut list =
            stops(&[(0.0, 0, SMOOTH), (0.2, 1, SMOOTH), (0.2, 2, SMOOTH), (0.5, 3, SMOOTH), (1.0, 4, SMOOTH)]);
        let mut selection = Selection::between(3, 1);
        move_to(&mut list, &mut selection, 0.7);
        assert_eq!((greys(&list), selected(&selection), selection.lead()), (vec![0, 1, 2, 3, 4], vec![1, 2, 3], 1));
        assert_eq!([list[1].at, list[2].at], [0.7, 0.7], "those at one place stay together");
        assert!((list[3].at - 1.0).abs() < 1.0e-6);
        // At the end they stop, as far apart as they were.
        move_to(&mut list, &mut selection, 5.0);
        assert!((list[1].at - 0.7).abs() < 1.0e-6 && list[3].at <= 1.0, "{:?}", places(&list));
        move_to(&mut list, &mut selection, -5.0);
        assert_eq!((greys(&list), list[2].at), (vec![0, 1, 2, 3, 4], 0.0));
        // Apart from each other they pass what is between.
        let mut list = stops(&[(0.1, 0, SMOOTH), (0.2, 1, SMOOTH), (0.3, 2, SMOOTH), (0.9, 3, SMOOTH)]);
        let mut selection = Selection::one(0);
        selection.toggle(2);
        move_to(&mut list, &mut selection, 0.45);
        assert_eq!((greys(&list), selected(&selection), selection.lead()), (vec![1, 0, 2, 3], vec![1, 2], 2));
    }

    #[test]
    fn what_is_selected_is_removed_copied_and_scaled() {
        let from = stops(&[(0.0, 0, SMOOTH), (0.2, 1, SMOOTH), (0.4, 2, SMOOTH), (1.0, 3, SMOOTH)]);
        let mut selection = Selection::one(1);
        selection.toggle(3);
        let (mut list, mut of) = (from.clone(), selection.clone());
        remove(&mut list, &mut of);
        assert_eq!((greys(&list), selected(&of)), (vec![0, 2], vec![1]));
        let (mut list, mut of) = (from.clone(), Selection::between(0, 3));
        remove(&mut list, &mut of);
        assert_eq!((greys(&list), selected(&of)), (vec![3], vec![0]), "one stays: the lead");
        let (mut list, mut of) = (from.clone(), selection.clone());
        copy(&mut list, &mut of);
        assert_eq!((greys(&list), selected(&of), of.lead()), (vec![0, 1, 1, 2, 3, 3], vec![2, 5], 5));
        let (mut list, mut of) = (from, selection);
        scale(&mut list, &mut of, 2.5);
        assert_eq!((greys(&list), places(&list)), (vec![0, 2, 1, 3], vec![0.0, 0.4, 0.5, 1.0]));
        assert_eq!(selected(&of), [2, 3]);
    }

    #[test]
    fn a_part_is_distributed_turned_and_mirrored_and_the_rest_stays() {
        let from = stops(&[(0.0, 0, SMOOTH), (0.2, 1, SMOOTH), (0.3, 2, SMOOTH), (0.6, 3, SMOOTH), (1.0, 4, SMOOTH)]);
        let part = Selection::between(1, 3);
        let check = |change: &dyn Fn(&mut Vec<RampStop>, &mut Selection), expected: &[(f32, u8)], which: &[usize]| {
            let (mut list, mut of) = (from.clone(), part.clone());
            change(&mut list, &mut of);
            assert_eq!(greys(&list), expected.iter().map(|(_, grey)| *grey).collect::<Vec<_>>());
            for (at, (expected, _)) in places(&list).into_iter().zip(expected) {
                assert!((at - expected).abs() < 1.0e-6, "{at} {expected}");
            }
            assert_eq!(selected(&of), which);
        };
        check(&|list, of| distribute(list, of), &[(0.0, 0), (0.2, 1), (0.4, 2), (0.6, 3), (1.0, 4)], &[1, 2, 3]);
        let steps = [(0.0, 0), (0.2, 1), (0.2 + 0.8 / 3.0, 2), (0.2 + 1.6 / 3.0, 3), (1.0, 4)];
        check(&|list, of| step_evenly(list, of), &steps, &[1, 2, 3]);
        check(&flip, &[(0.0, 0), (0.2, 3), (0.5, 2), (0.6, 1), (1.0, 4)], &[1, 2, 3]);
        let mirrored = [(0.0, 0), (0.2, 1), (0.25, 2), (0.4, 3), (0.55, 2), (0.6, 1), (1.0, 4)];
        check(&mirror, &mirrored, &[1, 2, 3, 4, 5]);
    }

    #[test]
    fn hard_steps_stay_as_many_when_they_are_turned_round() {
        let hard = Curve::Constant;
        let mut list = stops(&[(0.0, 1, hard), (0.45, 2, hard), (0.72, 3, hard)]);
        flip(&mut list, &mut all());
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
            flip(&mut flipped, &mut all());
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
        fn mirrored_a_gradient_is_itself_and_its_mirror(
            list in prop::collection::vec((0u8..=20, any::<u8>(), 0usize..4), 1..8),
        ) {
            let list = list.into_iter().map(|(at, grey, curve)| (f32::from(at) / 20.0, grey, Curve::ALL[curve]));
            let mut row = stops(&list.collect::<Vec<_>>());
            sort(&mut row);
            let mut mirrored = row.clone();
            mirror(&mut mirrored, &mut all());
            prop_assert!(mirrored.is_sorted_by(|a, b| a.at <= b.at));
            let gradient = |stops: &[RampStop]| {
                let rows = vec![RampRow { stops: stops.to_vec(), ..RampRow::default() }];
                RampRecipe { rows, ..RampRecipe::default() }.gradient().unwrap()
            };
            let (before, after) = (gradient(&row), gradient(&mirrored));
            for step in 0..60 {
                let u = (step as f32 + 0.5) / 60.0;
                let wanted = before.sample(u, 0.0);
                for at in [0.5 * u, 1.0 - 0.5 * u] {
                    let apart = (wanted - after.sample(at, 0.0)).abs().max_element();
                    prop_assert!(apart < 1.0e-3, "{at}: {apart} {mirrored:?}");
                }
            }
        }

        #[test]
        fn what_is_done_to_some_leaves_them_in_order_and_selected(
            list in prop::collection::vec((0u8..=10, 0usize..4), 1..9),
            selected in prop::collection::vec(0usize..9, 1..5),
            what in 0usize..7, at in -1.0f32..2.0,
        ) {
            let list = list.into_iter().map(|(at, curve)| (f32::from(at) / 10.0, 0, Curve::ALL[curve]));
            let mut list = stops(&list.collect::<Vec<_>>());
            sort(&mut list);
            let mut selection = Selection::one(selected[0]);
            selected[1..].iter().for_each(|index| selection.toggle(*index));
            selection.keep_to(list.len());
            // Marked by a colour, unless others are made of them.
            selection.iter().for_each(|index| list[index].colour = HexColour([9; 3]));
            match what {
                0 => move_to(&mut list, &mut selection, at),
                1 => scale(&mut list, &mut selection, at),
                2 => distribute(&mut list, &mut selection),
                3 => step_evenly(&mut list, &mut selection),
                4 => flip(&mut list, &mut selection),
                5 => mirror(&mut list, &mut selection),
                _ => remove(&mut list, &mut selection),
            }
            prop_assert!(list.is_sorted_by(|a, b| a.at <= b.at) && !list.is_empty());
            prop_assert!(list.iter().all(|stop| (0.0..=1.0).contains(&stop.at)));
            prop_assert!(selection.iter().all(|index| index < list.len()) && selection.contains(selection.lead()));
            if what < 4 {
                let marked = list.iter().map(|stop| stop.colour == HexColour([9; 3]));
                prop_assert!(marked.enumerate().all(|(index, is)| is == selection.contains(index)));
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
            let index = moved(&mut list, index, at);
            prop_assert_eq!((list[index].colour, list[index].at), (HexColour([9; 3]), at.clamp(0.0, 1.0)));
            prop_assert!(list.is_sorted_by(|a, b| a.at <= b.at));
        }
    }
}
