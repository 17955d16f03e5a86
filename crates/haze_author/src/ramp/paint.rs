//! Painting on a ramp: colors near a position are multiplied.

use glam::{Vec2, Vec3};
use haze_core::error::FieldError;
use haze_core::formula::color::srgb_from_linear;

use super::gradient::add_stop;
use super::{HexColor, RampRecipe, RampRow};

/// Distance from the painted position, along and across rows, at which the change of colors has fallen to 0.6.
const REACH: f32 = 0.12;
/// Distance from the painted position within which an existing stop is changed, and none is added.
const NEAR: f32 = 0.06;
/// Linear light that is added before the multiplication and taken away after it, so that black can be lightened.
const LIFT: f32 = 0.004;

impl RampRecipe {
    /// Recipe whose colors near a position are multiplied by a linear color, and end at white. Stops further away change less.
    /// A stop is added where none is near. `at`: 0 to 1 on both axes.
    ///
    /// # Errors
    /// As [`RampRecipe::validate`].
    pub fn painted(&self, at: Vec2, factor: Vec3) -> Result<Self, FieldError> {
        let mut recipe = self.clone();
        let position = self.gradient()?.place(at);
        let distance = |row: &RampRow| (row.at - at.y).abs();
        let nearest = self.rows.iter().map(distance).fold(f32::INFINITY, f32::min);
        for row in &mut recipe.rows {
            // The nearest row changes as if it were at the position.
            let across = weight(distance(row) - nearest);
            if across > 0.5 && row.stops.iter().all(|stop| (stop.at - position).abs() > NEAR) {
                let color = color_of(self, row, position)?;
                row.stops.sort_by(|a, b| a.at.total_cmp(&b.at));
                add_stop(&mut row.stops, position, color);
            }
            for stop in &mut row.stops {
                let fraction = across * weight(stop.at - position);
                // By powers, so that a stroke back undoes one.
                let light = (stop.color.linear() + LIFT) * factor.powf(fraction) - LIFT;
                let painted = HexColor::from_srgb(light.clamp(Vec3::ZERO, Vec3::ONE).map(srgb_from_linear));
                stop.color = if fraction < 0.01 { stop.color } else { painted };
            }
        }
        Ok(recipe)
    }
}

fn weight(distance: f32) -> f32 {
    (-0.5 * (distance / REACH).powi(2)).exp()
}

/// Color of a row without the others.
fn color_of(recipe: &RampRecipe, row: &RampRow, at: f32) -> Result<HexColor, FieldError> {
    let place = String::new();
    let times = Vec::new();
    let alone = RampRecipe { place, times, rows: vec![row.clone()], ..recipe.clone() };
    Ok(HexColor::from_srgb(alone.gradient()?.sample(at, row.at).map(srgb_from_linear)))
}

#[cfg(test)]
mod tests {
    use super::super::RampStop;
    use super::*;

    fn row(at: f32, stops: &[(f32, u8)]) -> RampRow {
        let stops = stops.iter().map(|&(at, code)| RampStop::new(at, HexColor([code; 3]))).collect();
        RampRow { at, stops, ..RampRow::default() }
    }

    #[test]
    fn the_place_changes_by_the_factor_and_distant_colors_stay() {
        let recipe = RampRecipe { rows: vec![row(0.0, &[(0.0, 20), (0.5, 100), (1.0, 180)])], ..RampRecipe::default() };
        let sample = |recipe: &RampRecipe, at: f32| recipe.gradient().unwrap().sample(at, 0.0);
        for (at, factor) in [(0.5, 2.0), (0.7, 1.5), (0.3, 0.25)] {
            let painted = recipe.painted(Vec2::new(at, 0.0), Vec3::splat(factor)).unwrap();
            let before = sample(&recipe, at).x;
            let after = sample(&painted, at).x;
            let expected = (before + LIFT) * factor - LIFT;
            // Colors of stops have 8 bits.
            assert!((after - expected).abs() < 0.01 * expected + 0.002, "{at}: {after}, expected {expected}");
            assert_eq!(painted.rows[0].stops.len(), if (at - 0.5).abs() > NEAR { 4 } else { 3 });
            let end = sample(&recipe, 1.0).x;
            let painted_end = sample(&painted, 1.0).x;
            assert!((painted_end - end).abs() < 0.03 * end, "{at}: {painted_end}, expected {end}");
        }
        let same = recipe.painted(Vec2::new(0.5, 0.0), Vec3::ONE).unwrap();
        assert_eq!(same, recipe);
    }

    #[test]
    fn black_is_lightened_white_stays_and_the_nearest_row_is_painted() {
        let rows = vec![row(0.0, &[(0.0, 0), (1.0, 255)]), row(1.0, &[(0.0, 0), (1.0, 255)])];
        let recipe = RampRecipe { height: 2, rows, ..RampRecipe::default() };
        let painted = recipe.painted(Vec2::new(0.0, 0.9), Vec3::splat(8.0)).unwrap();
        let color = |row: usize, stop: usize| painted.rows[row].stops[stop].color.0[0];
        assert!(color(1, 0) > 30 && color(0, 0) == 0, "{painted:?}");
        assert_eq!([color(0, 1), color(1, 1)], [255; 2]);
    }

    #[test]
    fn a_formula_moves_the_place() {
        let rows = vec![row(0.0, &[(0.0, 50), (0.5, 50), (1.0, 50)])];
        let recipe = RampRecipe { place: "1 - u".into(), rows, ..RampRecipe::default() };
        let painted = recipe.painted(Vec2::new(1.0, 0.0), Vec3::splat(2.0)).unwrap();
        let colors: Vec<_> = painted.rows[0].stops.iter().map(|stop| stop.color.0[0]).collect();
        assert!(colors[0] > 60 && colors[2] == 50, "{colors:?}");
    }
}
