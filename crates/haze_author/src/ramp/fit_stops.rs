//! Fits the stops of a ramp recipe to an image.

use std::ops::{Range, RangeInclusive};

use glam::Vec3;
use haze_core::error::FieldError;
use haze_core::formula::color::srgb_from_linear;
use image::DynamicImage;

use super::gradient::PreparedRows;
use super::ramp_recipe::{Blend, Curve, HexColor, RampRecipe, RampRow, RampStop};

/// Default error bound of an image without noise, steps of 255: one for dithering, and a half for rounding of a stop's
/// color.
pub const DEFAULT_MAX_ERROR: f32 = 1.5;

/// Range of error bounds, steps of 255: from the smallest that stops of 8 bits per channel can meet to the largest of use.
pub const MAX_ERROR_RANGE: RangeInclusive<f32> = 1.0..=64.0;

/// Standard deviations of the noise of a painted image, steps of 255. Rounding and dithering are below; above, the texture
/// is a part of the image.
const PAINTED_NOISE: RangeInclusive<f32> = 0.9..=4.0;

/// Texels over which the difference of two rows is averaged, to tell noise from a slope.
const NOISE_WINDOW: usize = 16;

/// Least number of texels that the noise is estimated from.
const MIN_NOISE_TEXELS: usize = 64;

/// Maximum number of stops. An image that needs more is not a gradient, and its recipe would exceed the size limit.
const MAX_STOPS: usize = 50_000;

/// A fitted recipe and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct RampFit {
    /// Recipe of an image's size; one row if all rows of the image are equal.
    pub recipe: RampRecipe,
    /// Largest difference between the recipe and its source in any channel, steps of 255 of sRGB code. Of an image, at
    /// every texel of the baked recipe; of a gradient, at sampled positions.
    pub error: f32,
}

/// Fits stops to an sRGB image, so that no channel differs by more than `max_error`, 1 to 64 steps of 255. Hard edges
/// are preserved: with constant stops between flat parts, otherwise with two stops at one position.
///
/// Without a bound, the stops follow the paint and not its noise: rows that differ only by noise are averaged to one row, and
/// the bound is [`DEFAULT_MAX_ERROR`] plus four standard deviations of the noise that is left.
///
/// # Errors
/// [`FieldError`] if `max_error` is out of range, the image is empty, or it needs more than 50 000 stops.
pub fn fit_image(image: &DynamicImage, max_error: Option<f32>) -> Result<RampFit, FieldError> {
    validate_max_error(max_error)?;
    let pixels = image.to_rgb16();
    if pixels.is_empty() {
        return Err(FieldError::from_problem("image", "has no pixels", "at least one pixel"));
    }
    let code = |channel: u16| f32::from(channel) / 257.0;
    let mut rows: Vec<Vec<Vec3>> =
        pixels.rows().rev().map(|row| row.map(|pixel| Vec3::from(pixel.0.map(code))).collect()).collect();
    let width = pixels.width().max(2);
    let height = pixels.height();
    for row in &mut rows {
        row.resize(width as usize, row.first().copied().unwrap_or_default());
    }
    let mean = |x: usize| rows.iter().map(|row| row[x]).sum::<Vec3>() / rows.len() as f32;
    let mean_row: Vec<Vec3> = (0..width as usize).map(mean).collect();
    let noise = if max_error.is_none() { painted_noise(&rows) } else { 0.0 };
    // Rows that differ only by dithering count as equal.
    let is_dithered = || rows.iter().all(|row| max_difference(row, &rows[0]) <= 1.0);
    let is_strip = is_dithered() || noise > 0.0 && rows.iter().all(|row| is_noise(row, &mean_row, noise));
    let strip = [mean_row];
    let texels: &[Vec<Vec3>] = if is_strip { &strip } else { &rows };
    let noise_left = if is_strip { noise / (rows.len() as f32).sqrt() } else { noise };
    let max_error = max_error.unwrap_or(DEFAULT_MAX_ERROR + 4.0 * noise_left);
    let spaces = [Blend::Oklab, Blend::Srgb, Blend::Linear].map(|blend| (blend, curve_for(blend)));
    // About eight rows decide which blend space needs the fewest stops.
    let some = texels.iter().step_by(texels.len().div_ceil(8));
    let stops_of = |&(blend, curve): &(Blend, Curve)| -> usize {
        some.clone().map(|row| fit_stops(row, blend, curve, max_error).len()).sum()
    };
    let (blend, curve) = spaces.into_iter().min_by_key(stops_of).unwrap_or_default();
    let height = if is_strip { 1 } else { height };
    let recipe =
        RampRecipe { width, height, blend, rows: fit_rows(texels, blend, curve, max_error), ..RampRecipe::default() };
    let count = recipe.rows.iter().map(|row| row.stops.len()).sum::<usize>();
    if count > MAX_STOPS {
        let expected = format!("at most {MAX_STOPS}: an image of gradients, or a larger error");
        return Err(FieldError::from_problem("stops", format!("the image needs {count}"), expected));
    }
    let baked = recipe.bake()?.into_rgb16();
    let baked: Vec<Vec3> = baked.pixels().map(|pixel| Vec3::from(pixel.0.map(code))).collect();
    let baked = baked.chunks(width as usize).rev().cycle();
    Ok(RampFit { recipe, error: rows.iter().zip(baked).map(|(a, b)| max_difference(a, b)).fold(0.0, f32::max) })
}

/// Fits fewer rows and stops to the rows of a recipe, so that no channel differs by more than `max_error`, 1 to 64 steps of
/// 255. The gradient that multiplies the rows and the formula of the position stay.
///
/// # Errors
/// [`FieldError`] if `max_error` is out of range or the recipe is invalid.
pub fn simplify_rows(recipe: &RampRecipe, max_error: f32) -> Result<RampFit, FieldError> {
    let plain = RampRecipe { bits: 16, times: Vec::new(), place: String::new(), ..recipe.clone() };
    let RampFit { recipe: fitted, error } = fit_image(&plain.bake()?, Some(max_error))?;
    let recipe = RampRecipe { rows: fitted.rows, blend: fitted.blend, ..recipe.clone() };
    Ok(RampFit { recipe, error })
}

/// Fits stops to a row of at least two sRGB codes, 0 to 255, evenly spaced from 0 to 1, so that no channel differs by
/// more than `max_error` steps of 255.
pub fn fit_row(row: &[Vec3], blend: Blend, max_error: f32) -> Vec<RampStop> {
    fit_stops(row, blend, curve_for(blend), max_error)
}

/// Returns the curve to fit with: linear in the spaces in which other programs blend linearly.
fn curve_for(blend: Blend) -> Curve {
    if matches!(blend, Blend::Srgb | Blend::Linear) { Curve::Linear } else { Curve::Monotone }
}

/// Returns an error if the bound is below what stops of 8 bits per channel can meet, or too large to be useful.
pub(super) fn validate_max_error(max_error: Option<f32>) -> Result<(), FieldError> {
    let Some(max_error) = max_error else { return Ok(()) };
    let is_good = MAX_ERROR_RANGE.contains(&max_error);
    if is_good { Ok(()) } else { Err(FieldError::new("error", max_error, "1 to 64 steps of 255")) }
}

/// Returns the largest difference in any channel.
fn max_difference(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs().max_element()).fold(0.0, f32::max)
}

/// Returns the standard deviation of the noise of painted rows, steps of 255; 0 for rounding, dithering and textures.
///
/// The fourth difference of a smooth curve is near 0, and that of independent noise has sqrt(70) times its deviation. The median
/// of absolute values, 0.6745 deviations of a normal distribution, ignores edges.
fn painted_noise(rows: &[Vec<Vec3>]) -> f32 {
    let of_channel = |channel: usize| {
        let fourth_difference = |near: &[Vec3]| {
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|index| near[index][channel]);
            // Clipped texels have no noise.
            (c > 0.0 && c < 255.0).then_some((a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs())
        };
        let count: usize = rows.iter().map(Vec::len).sum();
        let mut found: Vec<f32> = rows.iter().flat_map(|row| row.windows(5).filter_map(fourth_difference)).collect();
        // The slope between two clipped parts is too short for an estimate.
        if found.len() < (count / 4).max(MIN_NOISE_TEXELS) {
            return 0.0;
        }
        let middle = found.len() / 2;
        *found.select_nth_unstable_by(middle, f32::total_cmp).1 / (0.6745 * 70.0_f32.sqrt())
    };
    let noise = (0..3).map(of_channel).fold(0.0, f32::max);
    if PAINTED_NOISE.contains(&noise) { noise } else { 0.0 }
}

/// True if a row differs from another only by noise of a standard deviation: nowhere by more than six deviations, which
/// no texel of a million has, and on average by little.
fn is_noise(row: &[Vec3], other: &[Vec3], noise: f32) -> bool {
    let window = NOISE_WINDOW.min(row.len());
    let mean_difference = |start: usize| {
        let texels = start..start + window;
        let sum: Vec3 = row[texels.clone()].iter().zip(&other[texels]).map(|(a, b)| *a - *b).sum();
        (sum / window as f32).abs().max_element()
    };
    let most_on_average = 1.0 + 4.0 * noise / (window as f32).sqrt();
    max_difference(row, other) <= 1.0 + 6.0 * noise
        && (0..=row.len() - window).all(|start| mean_difference(start) <= most_on_average)
}

/// A candidate stop or row: the index of its texel (or row of texels) and its position.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    index: usize,
    at: f32,
    curve: Curve,
}

/// Fits the recipe's rows. `texels` begin with row 0 of the second axis.
fn fit_rows(texels: &[Vec<Vec3>], blend: Blend, curve: Curve, max_error: f32) -> Vec<RampRow> {
    if let [row] = texels {
        return vec![RampRow { stops: fit_stops(row, blend, curve, max_error), ..RampRow::default() }];
    }
    // Each row gets three quarters of the error bound; the rest is for interpolation between rows.
    let mut fitted: Vec<Option<Vec<RampStop>>> = vec![None; texels.len()];
    let mut rows_of = |keys: &[Key]| -> Vec<RampRow> {
        let row = |&Key { index, at, curve: row_curve }: &Key| {
            let stops = fitted[index].get_or_insert_with(|| fit_stops(&texels[index], blend, curve, max_error * 0.75));
            RampRow { at, curve: row_curve, stops: stops.clone() }
        };
        keys.iter().map(row).collect()
    };
    let keys = choose_keys(
        texels.len(),
        curve,
        max_error,
        |a, b| max_difference(&texels[a], &texels[b]),
        |keys, range| {
            let rows = PreparedRows::new(blend, &rows_of(keys));
            let last = (texels.len() - 1) as f32;
            range
                .map(|index| {
                    texel_errors(&rows, index as f32 / last, &texels[index], 0..texels[index].len())
                        .into_iter()
                        .fold(0.0, f32::max)
                })
                .collect()
        },
    );
    rows_of(&keys)
}

fn fit_stops(row: &[Vec3], blend: Blend, curve: Curve, max_error: f32) -> Vec<RampStop> {
    let stops_of = |keys: &[Key]| -> Vec<RampStop> {
        let color = |index: usize| HexColor::from_srgb(row[index] / 255.0);
        keys.iter().map(|key| RampStop { at: key.at, color: color(key.index), curve: key.curve }).collect()
    };
    let keys = choose_keys(
        row.len(),
        curve,
        max_error,
        |a, b| (row[a] - row[b]).abs().max_element(),
        |keys, range| {
            let rows = PreparedRows::new(blend, &[RampRow { stops: stops_of(keys), ..RampRow::default() }]);
            texel_errors(&rows, 0.0, row, range)
        },
    );
    stops_of(&keys)
}

/// Returns the error of every texel of a range.
fn texel_errors(rows: &PreparedRows, v: f32, row: &[Vec3], range: Range<usize>) -> Vec<f32> {
    let last = (row.len() - 1) as f32;
    let error = |index: usize| {
        let light = rows.sample(index as f32 / last, v).min(Vec3::ONE);
        (light.map(srgb_from_linear) * 255.0 - row[index]).abs().max_element()
    };
    range.map(error).collect()
}

/// Chooses keys for `count` texels, at least two. Splits the texels at hard edges, adds the worst texel between keys
/// until every error is at most `max_error`, then removes redundant keys. `difference` returns the difference of two
/// texels; `errors` returns the error of each texel of a range for given keys.
fn choose_keys(
    count: usize,
    curve: Curve,
    max_error: f32,
    difference: impl Fn(usize, usize) -> f32,
    mut errors: impl FnMut(&[Key], Range<usize>) -> Vec<f32>,
) -> Vec<Key> {
    let position = |index: f32| (index / (count - 1) as f32 * 1.0e6).round() / 1.0e6;
    let mut chosen = Vec::new();
    let mut start = 0;
    for end in (1..=count).filter(|&end| end == count || is_edge(end, count, &difference)) {
        let middle = usize::midpoint(start, end);
        let at = if start == 0 { 0.0 } else { position(start as f32 - 0.5) };
        if (start..end).all(|index| difference(index, middle) <= max_error - 0.5) {
            chosen.push(Key { index: middle, at, curve: Curve::Constant });
        } else {
            let until = if end == count { 1.0 } else { position(end as f32 - 0.5) };
            let key = |index: usize| Key { index, at: position(index as f32), curve };
            let mut keys = vec![Key { index: start, at, curve }, Key { index: end - 1, at: until, curve }];
            refine(&mut keys, start..end, max_error, key, &mut errors);
            prune(&mut keys, start..end, max_error, &mut errors);
            chosen.extend(keys);
        }
        start = end;
    }
    // The last key has no next one, so its curve does not matter; use the usual one instead of constant.
    if let Some(last) = chosen.last_mut() {
        last.curve = curve;
    }
    chosen
}

/// True if there is a hard edge between a texel and the previous one: a jump much larger than the differences beside
/// it.
fn is_edge(index: usize, count: usize, difference: impl Fn(usize, usize) -> f32) -> bool {
    // A twentieth of white, of 255. Smaller jumps are not visible as edges and may be noise.
    const MIN_JUMP: f32 = 12.0;
    let jump = difference(index - 1, index);
    let before = if index >= 2 { difference(index - 2, index - 1) } else { 0.0 };
    let after = if index + 1 < count { difference(index, index + 1) } else { 0.0 };
    jump >= MIN_JUMP && jump >= 3.0 * before.max(after)
}

/// Adds the worst texel between every two keys until all errors are at most `max_error`. Terminates at the latest when
/// every texel is a key.
fn refine(
    keys: &mut Vec<Key>,
    range: Range<usize>,
    max_error: f32,
    key: impl Fn(usize) -> Key,
    errors: &mut impl FnMut(&[Key], Range<usize>) -> Vec<f32>,
) {
    loop {
        let mut worst = vec![None; keys.len() - 1];
        let mut pair = 0;
        for (index, error) in range.clone().zip(errors(keys, range.clone())) {
            let key = key(index);
            while pair + 1 < worst.len() && keys[pair + 1].at < key.at {
                pair += 1;
            }
            let is_worse = worst[pair].is_none_or(|(largest, _)| error > largest);
            if error > max_error && is_worse && !keys[pair..pair + 2].contains(&key) {
                worst[pair] = Some((error, key));
            }
        }
        let more: Vec<_> = worst.into_iter().flatten().map(|(_, key)| key).collect();
        if more.is_empty() {
            return;
        }
        keys.extend(more);
        keys.sort_by(|a, b| a.at.total_cmp(&b.at));
    }
}

/// Removes keys without which all errors stay at most `max_error`.
fn prune(
    keys: &mut Vec<Key>,
    range: Range<usize>,
    max_error: f32,
    errors: &mut impl FnMut(&[Key], Range<usize>) -> Vec<f32>,
) {
    let mut at = 1;
    while at + 1 < keys.len() {
        // Removing a key changes the curve up to two keys away; evaluating it there needs one more key on each side.
        let near = at.saturating_sub(3)..keys.len().min(at + 4);
        let others: Vec<_> = keys[near.clone()].iter().filter(|key| **key != keys[at]).copied().collect();
        let from = keys[at.saturating_sub(2)].index;
        let to = keys[(at + 2).min(keys.len() - 1)].index;
        if errors(&others, from.max(range.start)..(to + 1).min(range.end)).iter().all(|&error| error <= max_error) {
            keys.remove(at);
        } else {
            at += 1;
        }
    }
}

#[cfg(test)]
mod tests;
