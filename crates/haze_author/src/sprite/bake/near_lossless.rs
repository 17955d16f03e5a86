//! Near-lossless preprocessing for PNG: moves texels towards the PNG filter's prediction, for smaller files without a
//! visible difference.

use glam::{IVec2, UVec2};
use image::Rgba;

use haze_core::assets::image::Image;

/// Maximum movement of a normal in thin smoke, in multiples of the tolerance.
const MAX_NORMAL_FACTOR: i32 = 4;

/// Moves every channel of a frame by at most `tolerance` of 255. Normals may move further where the amount is small, in
/// inverse proportion to it, up to `MAX_NORMAL_FACTOR` times. Normals of clear texels without visible neighbours may
/// take any value.
pub fn quantise_frame(frame: &mut Image<Rgba<u8>>, tolerance: u32) {
    let tolerance = tolerance as i32;
    let amounts = Image { size: frame.size, texels: frame.texels.iter().map(|texel| texel.0[3]).collect() };
    let is_alone = |at: IVec2| (-1..=1).all(|y| (-1..=1).all(|x| amounts.load(at + IVec2::new(x, y)) == 0));
    shrink(frame, tolerance, |at| match i32::from(amounts.load(at)) {
        0 if is_alone(at) => 255,
        0 => MAX_NORMAL_FACTOR * tolerance,
        amount => (tolerance * 255 / amount).min(MAX_NORMAL_FACTOR * tolerance),
    });
}

/// Moves every channel of a detail map's frame by at most `tolerance` of 255, also in clear texels: motion matters
/// where the smoke moves to.
pub fn quantise_detail(frame: &mut Image<Rgba<u8>>, tolerance: u32) {
    shrink(frame, tolerance as i32, |_| tolerance as i32);
}

/// Near-lossless coding as in JPEG-LS, with the predictor of PNG's Paeth filter: a channel takes the predicted value if
/// that is within tolerance. Clear texels stay clear.
fn shrink(frame: &mut Image<Rgba<u8>>, of_amount: i32, of_color: impl Fn(IVec2) -> i32) {
    for index in 0..frame.texels.len() as u32 {
        let at = UVec2::new(index % frame.size.x, index / frame.size.x).as_ivec2();
        let texel = frame.load(at).0;
        let near = |offset: IVec2| if (at - offset).min_element() < 0 { [0; 4] } else { frame.load(at - offset).0 };
        let [left, up, corner] = [IVec2::X, IVec2::Y, IVec2::ONE].map(near);
        let of_amount = if texel[3] == 0 { 0 } else { of_amount };
        let of_color = of_color(at);
        frame.texels[index as usize].0 = [0, 1, 2, 3].map(|channel| {
            let [left, up, corner] = [left, up, corner].map(|near| i32::from(near[channel]));
            let tolerance = if channel == 3 { of_amount } else { of_color };
            quantized(i32::from(texel[channel]), paeth(left, up, corner), tolerance)
        });
    }
}

/// Quantises the difference from the prediction in steps of `2 * tolerance + 1`, and returns the resulting code.
fn quantized(code: i32, predicted: i32, tolerance: i32) -> u8 {
    let step = 2 * tolerance + 1;
    let off = code - predicted;
    let steps = (off.abs() + tolerance) / step * off.signum();
    u8::try_from(predicted + steps * step).unwrap_or(code as u8)
}

/// Returns whichever of left, up and corner is nearest to left + up - corner. (PNG specification, filter 4)
fn paeth(left: i32, up: i32, corner: i32) -> i32 {
    let [from_left, from_up] = [(up - corner).abs(), (left - corner).abs()];
    let from_corner = (left + up - 2 * corner).abs();
    if from_left <= from_up && from_left <= from_corner {
        left
    } else if from_up <= from_corner {
        up
    } else {
        corner
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::sprite::bake::SpriteRecipe;
    use haze_core::assets::json;

    #[test]
    fn no_texel_moves_further_than_the_tolerance() {
        let recipe = include_str!("../../../../../tests/corpus/sprite/good_first");
        let recipe: SpriteRecipe = json::parse(Path::new("puff.sprite.json"), recipe).unwrap();
        let recipe = SpriteRecipe { size: 64, ..recipe };
        let baked = recipe.bake_frame(0.0).image;
        let shrunk = SpriteRecipe { tolerance: 2, ..recipe }.bake_frame(0.0).image;
        let mut moved = 0;
        for (from, to) in baked.texels.iter().zip(&shrunk.texels) {
            let [r, g, b, a] = [0, 1, 2, 3].map(|channel| u32::from(from.0[channel].abs_diff(to.0[channel])));
            let amount = u32::from(from.0[3]);
            let normal = r.max(g).max(b);
            assert!(a <= 2 && (amount > 0 || a == 0), "{from:?} {to:?}");
            assert!(amount == 0 || (normal <= 8 && normal * amount <= 2 * 255), "{from:?} {to:?}");
            moved += normal + a;
        }
        assert!(moved > 0);
        let mut same = baked.clone();
        quantise_frame(&mut same, 0);
        assert!(baked.texels.iter().zip(&same.texels).all(|(from, to)| from.0[3] == 0 || from == to));
        quantise_detail(&mut same, 1);
        let off = |(from, to): (&Rgba<u8>, &Rgba<u8>)| from.0.iter().zip(to.0).all(|(a, b)| a.abs_diff(b) <= 1);
        assert!(
            shrunk.texels != same.texels
                && baked.texels.iter().zip(&same.texels).all(|pair| pair.0.0[3] == 0 || off(pair))
        );
    }
}
