#![allow(clippy::float_cmp, reason = "positions are literals or halves of literals, so results are exact")]

use proptest::prelude::*;

use super::*;
use haze_author::ramp::gradient::add_stop;
use haze_author::ramp::{HexColor, RampRecipe, RampRow};

fn stops(list: &[(f32, u8, Curve)]) -> Vec<RampStop> {
    list.iter().map(|&(at, gray, curve)| RampStop { curve, ..RampStop::new(at, HexColor([gray; 3])) }).collect()
}

fn positions(stops: &[RampStop]) -> Vec<f32> {
    stops.iter().map(|stop| stop.at).collect()
}

fn grays(stops: &[RampStop]) -> Vec<u8> {
    stops.iter().map(|stop| stop.color.0[0]).collect()
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
fn a_stop_changes_order_only_if_it_moves_past_another() {
    let mut list = stops(&[(0.0, 0, SMOOTH), (0.5, 1, SMOOTH), (0.5, 2, SMOOTH), (1.0, 3, SMOOTH)]);
    assert_eq!(moved(&mut list, 0, 0.5), 0);
    assert_eq!(grays(&list), [0, 1, 2, 3]);
    assert_eq!(moved(&mut list, 0, 0.6), 2);
    assert_eq!(grays(&list), [1, 2, 0, 3]);
    assert_eq!(moved(&mut list, 2, 0.5), 2, "from above it stays above");
    assert_eq!(moved(&mut list, 2, -3.0), 0);
    assert_eq!((grays(&list), list[0].at), (vec![0, 1, 2, 3], 0.0));
    assert_eq!(moved(&mut list, 3, f32::NAN), 3);
    assert_eq!(list[3].at, 1.0);
}

#[test]
fn added_stops_are_inserted_in_order_and_the_last_stop_cannot_be_removed() {
    let mut list = stops(&[(0.2, 0, Curve::Ease), (0.2, 1, Curve::Constant), (0.8, 2, SMOOTH)]);
    assert_eq!(add_stop(&mut list, 0.2, HexColor([9; 3])), 2);
    assert_eq!((grays(&list), list[2].curve), (vec![0, 1, 9, 2], Curve::Constant));
    assert_eq!(add_stop(&mut list, 0.1, HexColor([8; 3])), 0);
    assert_eq!(list[0].curve, Curve::Ease);
    assert_eq!(removed(&mut list, 4), 3);
    while list.len() > 1 {
        assert_eq!(removed(&mut list, 0), 0);
    }
    assert_eq!((removed(&mut list, 0), list.len()), (0, 1));
}

#[test]
fn a_new_stop_goes_halfway_to_a_neighbour() {
    let list = stops(&[(0.0, 0, SMOOTH), (0.5, 0, SMOOTH), (1.0, 0, SMOOTH)]);
    assert_eq!([0, 1, 2].map(|index| insertion_position(&list, index)), [0.25, 0.75, 0.75]);
    assert_eq!(insertion_position(&stops(&[(0.4, 0, SMOOTH)]), 0), 0.7);
    assert_eq!(insertion_position(&stops(&[(1.0, 0, SMOOTH)]), 0), 0.5);
}

#[test]
fn nudging_moves_by_thousandths_hundredths_or_equal_parts() {
    let close = |at: f32, expected: f32| assert!((at - expected).abs() < 1.0e-5, "{at} {expected}");
    close(nudge_position(0.25, 1.0, false, None), 0.251);
    close(nudge_position(0.25, -1.0, true, None), 0.24);
    close(nudge_position(0.25, 1.0, false, Some(10)), 0.3);
    close(nudge_position(0.25, -1.0, false, Some(10)), 0.2);
    close(nudge_position(0.3, 1.0, true, Some(10)), 0.4);
    close(nudge_position(0.3, -1.0, false, Some(10)), 0.2);
    close(nudge_position(0.3, 1.0, false, Some(3)), 1.0 / 3.0);
    let mut at = 0.123;
    (0..100).for_each(|_| at = nudge_position(at, 1.0, false, None));
    (0..100).for_each(|_| at = nudge_position(at, -1.0, false, None));
    close(at, 0.123);
    close(snap_to_parts(0.349, Some(10)), 0.3);
    close(snap_to_parts(0.349, Some(8)), 0.375);
    close(snap_to_parts(0.349, None), 0.349);
}

#[test]
fn stops_are_distributed_between_the_first_and_the_last() {
    let mut list = stops(&[(0.2, 0, SMOOTH), (0.3, 1, SMOOTH), (0.3, 2, SMOOTH), (0.8, 3, SMOOTH)]);
    distribute(&mut list, &mut all());
    assert_eq!(grays(&list), [0, 1, 2, 3]);
    for (at, expected) in positions(&list).into_iter().zip([0.2, 0.4, 0.6, 0.8]) {
        assert!((at - expected).abs() < 1.0e-6, "{at}");
    }
    let mut list = stops(&[(0.5, 0, SMOOTH), (0.5, 1, SMOOTH), (0.5, 2, SMOOTH)]);
    distribute(&mut list, &mut all());
    assert_eq!(positions(&list), [0.0, 0.5, 1.0]);
    let mut one = stops(&[(0.5, 0, SMOOTH)]);
    distribute(&mut one, &mut all());
    assert_eq!(positions(&one), [0.0]);
}

#[test]
fn selected_stops_move_together_and_keep_their_distances() {
    let mut list = stops(&[(0.0, 0, SMOOTH), (0.2, 1, SMOOTH), (0.2, 2, SMOOTH), (0.5, 3, SMOOTH), (1.0, 4, SMOOTH)]);
    let mut selection = Selection::between(3, 1);
    move_to(&mut list, &mut selection, 0.7);
    assert_eq!((grays(&list), selected(&selection), selection.lead()), (vec![0, 1, 2, 3, 4], vec![1, 2, 3], 1));
    assert_eq!([list[1].at, list[2].at], [0.7, 0.7], "those at one place stay together");
    assert!((list[3].at - 1.0).abs() < 1.0e-6);
    // At the end of the gradient they stop and keep their distances.
    move_to(&mut list, &mut selection, 5.0);
    assert!((list[1].at - 0.7).abs() < 1.0e-6 && list[3].at <= 1.0, "{:?}", positions(&list));
    move_to(&mut list, &mut selection, -5.0);
    assert_eq!((grays(&list), list[2].at), (vec![0, 1, 2, 3, 4], 0.0));
    // Selected stops that are not adjacent can pass unselected ones between them.
    let mut list = stops(&[(0.1, 0, SMOOTH), (0.2, 1, SMOOTH), (0.3, 2, SMOOTH), (0.9, 3, SMOOTH)]);
    let mut selection = Selection::one(0);
    selection.toggle(2);
    move_to(&mut list, &mut selection, 0.45);
    assert_eq!((grays(&list), selected(&selection), selection.lead()), (vec![1, 0, 2, 3], vec![1, 2], 2));
}

#[test]
fn selected_stops_are_removed_copied_and_scaled() {
    let from = stops(&[(0.0, 0, SMOOTH), (0.2, 1, SMOOTH), (0.4, 2, SMOOTH), (1.0, 3, SMOOTH)]);
    let mut selection = Selection::one(1);
    selection.toggle(3);
    let mut list = from.clone();
    let mut of = selection.clone();
    remove(&mut list, &mut of);
    assert_eq!((grays(&list), selected(&of)), (vec![0, 2], vec![1]));
    let mut list = from.clone();
    let mut of = Selection::between(0, 3);
    remove(&mut list, &mut of);
    assert_eq!((grays(&list), selected(&of)), (vec![3], vec![0]), "one stays: the lead");
    let mut list = from.clone();
    let mut of = selection.clone();
    copy(&mut list, &mut of);
    assert_eq!((grays(&list), selected(&of), of.lead()), (vec![0, 1, 1, 2, 3, 3], vec![2, 5], 5));
    let mut list = from;
    let mut of = selection;
    scale(&mut list, &mut of, 2.5);
    assert_eq!((grays(&list), positions(&list)), (vec![0, 2, 1, 3], vec![0.0, 0.4, 0.5, 1.0]));
    assert_eq!(selected(&of), [2, 3]);
}

#[test]
fn operations_on_a_part_leave_the_other_stops_unchanged() {
    let from = stops(&[(0.0, 0, SMOOTH), (0.2, 1, SMOOTH), (0.3, 2, SMOOTH), (0.6, 3, SMOOTH), (1.0, 4, SMOOTH)]);
    let part = Selection::between(1, 3);
    let check = |change: &dyn Fn(&mut Vec<RampStop>, &mut Selection), expected: &[(f32, u8)], which: &[usize]| {
        let mut list = from.clone();
        let mut of = part.clone();
        change(&mut list, &mut of);
        assert_eq!(grays(&list), expected.iter().map(|(_, gray)| *gray).collect::<Vec<_>>());
        for (at, (expected, _)) in positions(&list).into_iter().zip(expected) {
            assert!((at - expected).abs() < 1.0e-6, "{at} {expected}");
        }
        assert_eq!(selected(&of), which);
    };
    check(&|list, of| distribute(list, of), &[(0.0, 0), (0.2, 1), (0.4, 2), (0.6, 3), (1.0, 4)], &[1, 2, 3]);
    let steps = [(0.0, 0), (0.2, 1), (0.2 + 0.8 / 3.0, 2), (0.2 + 1.6 / 3.0, 3), (1.0, 4)];
    check(&|list, of| distribute_steps(list, of), &steps, &[1, 2, 3]);
    check(&flip, &[(0.0, 0), (0.2, 3), (0.5, 2), (0.6, 1), (1.0, 4)], &[1, 2, 3]);
    let mirrored = [(0.0, 0), (0.2, 1), (0.25, 2), (0.4, 3), (0.55, 2), (0.6, 1), (1.0, 4)];
    check(&mirror, &mirrored, &[1, 2, 3, 4, 5]);
}

#[test]
fn flipping_constant_steps_keeps_their_number() {
    let hard = Curve::Constant;
    let mut list = stops(&[(0.0, 1, hard), (0.45, 2, hard), (0.72, 3, hard)]);
    flip(&mut list, &mut all());
    assert_eq!(grays(&list), [3, 2, 1]);
    for (at, expected) in positions(&list).into_iter().zip([0.0, 0.28, 0.55]) {
        assert!((at - expected).abs() < 1.0e-6, "{at}");
    }
}

proptest! {
    #[test]
    fn a_flipped_gradient_is_the_mirror_image(
        list in prop::collection::vec((0u8..=20, any::<u8>(), 0usize..4), 1..8),
    ) {
        let mut list: Vec<_> = list
            .into_iter()
            .map(|(at, gray, curve)| (f32::from(at) / 20.0, gray, Curve::ALL[curve]))
            .collect();
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        let row = stops(&list);
        let mut flipped = row.clone();
        flip(&mut flipped, &mut all());
        let gradient = |stops: &[RampStop]| {
            let rows = vec![RampRow { stops: stops.to_vec(), ..RampRow::default() }];
            RampRecipe { rows, ..RampRecipe::default() }.gradient().unwrap()
        };
        let before = gradient(&row);
        let after = gradient(&flipped);
        // Samples between stop positions: at a hard edge the two sides differ.
        for step in 0..60 {
            let u = (step as f32 + 0.5) / 60.0;
            let apart = (before.sample(u, 0.0) - after.sample(1.0 - u, 0.0)).abs().max_element();
            prop_assert!(apart < 1.0e-3, "{u}: {apart} {flipped:?}");
        }
    }

    #[test]
    fn a_mirrored_gradient_is_the_original_and_its_mirror_image(
        list in prop::collection::vec((0u8..=20, any::<u8>(), 0usize..4), 1..8),
    ) {
        let list = list.into_iter().map(|(at, gray, curve)| (f32::from(at) / 20.0, gray, Curve::ALL[curve]));
        let mut row = stops(&list.collect::<Vec<_>>());
        sort(&mut row);
        let mut mirrored = row.clone();
        mirror(&mut mirrored, &mut all());
        prop_assert!(mirrored.is_sorted_by(|a, b| a.at <= b.at));
        let gradient = |stops: &[RampStop]| {
            let rows = vec![RampRow { stops: stops.to_vec(), ..RampRow::default() }];
            RampRecipe { rows, ..RampRecipe::default() }.gradient().unwrap()
        };
        let before = gradient(&row);
        let after = gradient(&mirrored);
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
    fn every_operation_keeps_stops_sorted_and_selected(
        list in prop::collection::vec((0u8..=10, 0usize..4), 1..9),
        selected in prop::collection::vec(0usize..9, 1..5),
        what in 0usize..7, at in -1.0f32..2.0,
    ) {
        let list = list.into_iter().map(|(at, curve)| (f32::from(at) / 10.0, 0, Curve::ALL[curve]));
        let mut list = stops(&list.collect::<Vec<_>>());
        sort(&mut list);
        let mut selection = Selection::one(selected[0]);
        selected[1..].iter().for_each(|index| selection.toggle(*index));
        selection.clamp_to(list.len());
        // Selected stops are marked by a color. Mirroring and removal change the number of marked stops.
        selection.iter().for_each(|index| list[index].color = HexColor([9; 3]));
        match what {
            0 => move_to(&mut list, &mut selection, at),
            1 => scale(&mut list, &mut selection, at),
            2 => distribute(&mut list, &mut selection),
            3 => distribute_steps(&mut list, &mut selection),
            4 => flip(&mut list, &mut selection),
            5 => mirror(&mut list, &mut selection),
            _ => remove(&mut list, &mut selection),
        }
        prop_assert!(list.is_sorted_by(|a, b| a.at <= b.at) && !list.is_empty());
        prop_assert!(list.iter().all(|stop| (0.0..=1.0).contains(&stop.at)));
        prop_assert!(selection.iter().all(|index| index < list.len()) && selection.contains(selection.lead()));
        if what < 4 {
            let marked = list.iter().map(|stop| stop.color == HexColor([9; 3]));
            prop_assert!(marked.enumerate().all(|(index, is)| is == selection.contains(index)));
        }
    }

    #[test]
    fn moving_a_stop_keeps_the_order(
        list in prop::collection::vec(0.0f32..=1.0, 1..8), index in 0usize..8, at in -1.0f32..2.0,
    ) {
        let mut list: Vec<_> = list.into_iter().map(|at| RampStop::new(at, HexColor([0; 3]))).collect();
        sort(&mut list);
        let index = index % list.len();
        list[index].color = HexColor([9; 3]);
        let index = moved(&mut list, index, at);
        prop_assert_eq!((list[index].color, list[index].at), (HexColor([9; 3]), at.clamp(0.0, 1.0)));
        prop_assert!(list.is_sorted_by(|a, b| a.at <= b.at));
    }
}
