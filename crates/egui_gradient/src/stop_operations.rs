//! Operations on the stops of a gradient and its selection, without any drawing.

use std::ops::Range;

use haze_core::error::FieldError;

use super::selection::Selection;
use haze_author::ramp::{Blend, Curve, Gradient, RampRecipe, RampRow, RampStop};

/// Builds the gradient of the stops.
pub fn gradient(stops: &[RampStop], blend: Blend) -> Result<Gradient, FieldError> {
    let rows = vec![RampRow { stops: stops.to_vec(), ..RampRow::default() }];
    RampRecipe { blend, rows, ..RampRecipe::default() }.gradient()
}

/// Sorts stops by position, stably.
pub fn sort(stops: &mut [RampStop]) {
    stops.sort_by(|a, b| a.at.total_cmp(&b.at));
}

/// Sorts stops by position, stably, and updates the selection.
fn sort_selected(stops: &mut [RampStop], selection: &mut Selection) {
    let mut order: Vec<_> = (0..stops.len()).collect();
    order.sort_by(|a, b| stops[*a].at.total_cmp(&stops[*b].at));
    let mut moved_to = vec![0; stops.len()];
    order.iter().enumerate().for_each(|(new, old)| moved_to[*old] = new);
    *selection = selection.map(|old| moved_to.get(old).copied().unwrap_or(old));
    sort(stops);
}

/// Inserts a copy after each selected stop and selects the copies.
pub fn copy(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    let copied: Vec<_> = selection.iter().filter(|index| *index < stops.len()).collect();
    for index in copied.iter().rev() {
        stops.insert(index + 1, stops[*index].clone());
    }
    // Shifted by its own copy and by the copies of selected stops before it.
    *selection = selection.map(|index| index + copied.partition_point(|before| *before <= index));
}

/// Returns the position for a new stop: halfway to the next stop or to 1; for a last stop at 1, halfway to the previous
/// one.
pub fn insertion_position(stops: &[RampStop], index: usize) -> f32 {
    let at = |index: usize| stops.get(index).map(|stop| stop.at);
    let from = at(index).unwrap_or(0.0);
    let to = at(index + 1).unwrap_or(if from < 1.0 { 1.0 } else { at(index.wrapping_sub(1)).unwrap_or(0.0) });
    f32::midpoint(from, to)
}

/// Removes the selected stops, but keeps the lead if all are selected. Selects the stop that takes the first one's
/// place.
pub fn remove(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    let is_all = selection.count() >= stops.len();
    let mut index = 0;
    stops.retain(|_| {
        index += 1;
        !selection.contains(index - 1) || is_all && selection.lead() == index - 1
    });
    *selection = Selection::one(selection.range().start.min(stops.len().saturating_sub(1)));
}

/// Moves the lead to `at` and the other selected stops by the same distance, limited so that all stay within 0 to 1. A
/// stop changes order with another only if it moves past it. At equal positions the order is kept, and the two stops
/// form a hard edge.
pub fn move_to(stops: &mut [RampStop], selection: &mut Selection, at: f32) {
    let Some(lead) = stops.get(selection.lead()).map(|lead| lead.at).filter(|_| at.is_finite()) else { return };
    let (least, most) = ends(stops, selection.iter());
    let at = at.min(1.0 - (most - lead)).max(lead - least);
    for index in selection.iter() {
        // Computed relative to the lead, so that stops at equal positions stay equal despite rounding.
        stops[index].at = (at + (stops[index].at - lead)).clamp(0.0, 1.0);
    }
    sort_selected(stops, selection);
}

/// Multiplies the positions of the selected stops.
pub fn scale(stops: &mut [RampStop], selection: &mut Selection, times: f32) {
    for index in selection.iter() {
        stops[index].at = (stops[index].at * times).clamp(0.0, 1.0);
    }
    sort_selected(stops, selection);
}

/// Returns the smallest and the largest position.
fn ends(stops: &[RampStop], indices: impl Iterator<Item = usize>) -> (f32, f32) {
    indices.fold((1.0, 0.0), |(least, most): (f32, f32), index| (least.min(stops[index].at), most.max(stops[index].at)))
}

/// Returns the nearest border of equal parts, or `at` without snapping.
pub fn snap_to_parts(at: f32, parts: Option<u32>) -> f32 {
    parts.map_or(at, |parts| (at * parts as f32).round() / parts as f32)
}

/// Returns the position of an unselected stop nearby, so that the two form a hard edge; otherwise `at`.
pub fn snap_to_stop(stops: &[RampStop], selection: &Selection, at: f32) -> f32 {
    const NEAR: f32 = 0.02;
    let others = stops.iter().enumerate().filter(|(other, _)| !selection.contains(*other)).map(|(_, stop)| stop.at);
    let near = others.filter(|other| (other - at).abs() <= NEAR);
    near.min_by(|a, b| (a - at).abs().total_cmp(&(b - at).abs())).unwrap_or(at)
}

/// Returns `at` moved by `steps`: steps of 0.001, of 0.01 if `far`, or to the next borders of equal parts.
pub fn nudge_position(at: f32, steps: f32, far: bool, parts: Option<u32>) -> f32 {
    // Rounding makes a hundred steps and a hundred steps back return to the start.
    let round = |at: f32, unit: f32| (at * unit).round() / unit;
    match parts.map(|parts| parts as f32) {
        // The next border, unless `at` is already there within 1e-3 of a part.
        Some(parts) if steps > 0.0 => ((at * parts + 1.0e-3).floor() + steps) / parts,
        Some(parts) => ((at * parts - 1.0e-3).ceil() + steps) / parts,
        None => round(at + steps * if far { 0.01 } else { 0.001 }, 1.0e4),
    }
}

/// Returns the part to flip or mirror: its stops and its start and end. From the first to the last selected stop, or
/// the whole gradient if only one stop is selected.
fn selected_part(stops: &[RampStop], selection: &Selection) -> (Range<usize>, f32, f32) {
    let range = selection.range();
    match (stops.get(range.start), stops.get(range.end.saturating_sub(1))) {
        (Some(first), Some(last)) if selection.is_many() => (range, first.at, last.at),
        _ => (0..stops.len(), 0.0, 1.0),
    }
}

/// Replaces the stops of a part, and selects the new ones if several stops were selected.
fn replace_part(stops: &mut Vec<RampStop>, selection: &mut Selection, range: Range<usize>, others: Vec<RampStop>) {
    let end = (range.start + others.len()).saturating_sub(1);
    if selection.is_many() {
        *selection = Selection::between(range.start, end);
    }
    stops.splice(range, others);
}

/// Reverses a part.
pub fn flip(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    sort_selected(stops, selection);
    let (range, from, to) = selected_part(stops, selection);
    let reversed = reversed(&stops[range.clone()], from + to, from, to);
    replace_part(stops, selection, range, reversed);
}

/// Compresses a part into its first half and appends its mirror image.
pub fn mirror(stops: &mut Vec<RampStop>, selection: &mut Selection) {
    sort_selected(stops, selection);
    let (range, from, to) = selected_part(stops, selection);
    let middle = f32::midpoint(from, to);
    let mut mirrored = stops[range.clone()].to_vec();
    mirrored.iter_mut().for_each(|stop| stop.at = f32::midpoint(stop.at, from).clamp(from, middle));
    let back = reversed(&mirrored, from + to, middle, to);
    if let (Some(last), Some(first)) = (mirrored.last(), back.first())
        && (last.at, last.color) == (first.at, first.color)
    {
        // The two halves share the middle stop.
        mirrored.pop();
    }
    mirrored.extend(back);
    replace_part(stops, selection, range, mirrored);
}

/// Returns the stops in reverse, each at `sum` minus its position, clamped to `from`..`to`. Each curve stays with its
/// segment. A constant segment keeps its color, which then comes from its other end.
fn reversed(stops: &[RampStop], sum: f32, from: f32, to: f32) -> Vec<RampStop> {
    let Some(last) = stops.last() else { return Vec::new() };
    // True if the segment after a stop is constant and not empty.
    let is_held = |index: usize| {
        let stop = &stops[index];
        let next = stops.get(index + 1);
        stop.curve == Curve::Constant && next.is_some_and(|next| next.at > stop.at)
    };
    let mut flipped = Vec::with_capacity(stops.len() + 1);
    for (index, stop) in stops.iter().enumerate().rev() {
        let at = (sum - stop.at).clamp(from, to);
        let is_last = index + 1 == stops.len();
        let before = index.checked_sub(1).map(|before| (&stops[before], is_held(before)));
        if let Some((before, true)) = before {
            // The stop's own color must be kept as well, unless the segment after it holds it already.
            if is_last {
                flipped.push(RampStop { at: from, color: stop.color, curve: Curve::Constant });
            } else if !is_held(index) {
                flipped.push(RampStop { at, ..stop.clone() });
            }
            flipped.push(RampStop { at, color: before.color, curve: Curve::Constant });
        } else if before.is_some() || !is_held(index) {
            let curve = before.map_or(last.curve, |(before, _)| before.curve);
            flipped.push(RampStop { at, color: stop.color, curve });
        }
    }
    flipped
}

/// Returns the stops to distribute: the selected ones, or all if only one is selected.
fn stops_to_distribute(stops: &[RampStop], selection: &Selection) -> Vec<usize> {
    if selection.is_many() { selection.iter().collect() } else { (0..stops.len()).collect() }
}

/// Spaces stops evenly between the first and the last, or from 0 to 1 if those are at one position.
pub fn distribute(stops: &mut [RampStop], selection: &mut Selection) {
    let indices = stops_to_distribute(stops, selection);
    let (first, last) = ends(stops, indices.iter().copied());
    let (from, to) = if first < last { (first, last) } else { (0.0, 1.0) };
    let parts = indices.len().saturating_sub(1).max(1) as f32;
    for (position, index) in indices.into_iter().enumerate() {
        let fraction = position as f32 / parts;
        stops[index].at = from * (1.0 - fraction) + to * fraction;
    }
    sort_selected(stops, selection);
}

/// Spaces stops so that the segments after them have equal width, for constant curves. All stops from 0 to 1, or the
/// selected ones from the first to the stop after the last.
pub fn distribute_steps(stops: &mut [RampStop], selection: &mut Selection) {
    let indices = stops_to_distribute(stops, selection);
    let from = if selection.is_many() { ends(stops, indices.iter().copied()).0 } else { 0.0 };
    let behind = indices.last().and_then(|last| stops.get(last + 1));
    let to = behind.map_or(1.0, |behind| behind.at);
    let parts = indices.len().max(1) as f32;
    for (position, index) in indices.into_iter().enumerate() {
        stops[index].at = (from + (to - from) * position as f32 / parts).clamp(from, to);
    }
    sort_selected(stops, selection);
}

#[cfg(test)]
mod tests;
