//! Codes of colors: straight or multiplied by the amount, linear or sRGB.

use glam::Vec3;
use haze_core::formula::color::linear_from_srgb;
use haze_core::settings::choice;

use super::answer::Answer;
use super::small_frames::SmallFrames;
use crate::deterministic_math::ln;

choice! {
    /// Relation of color to the amount.
    AlphaMode {
        /// Color of the smoke itself.
        #[default]
        Straight = "straight",
        /// Color times the amount, in linear light: black where the sheet is clear.
        Premultiplied = "premultiplied",
    }
}

choice! {
    /// Meaning of the codes of colors.
    CodeSpace {
        /// Codes are values.
        #[default]
        Linear = "linear",
        /// Codes are those of sRGB.
        Srgb = "srgb",
    }
}

/// Codes of a file's colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorCode {
    /// Relation to the amount.
    pub alpha: Answer<AlphaMode>,
    /// Meaning of the codes.
    pub space: Answer<CodeSpace>,
}

/// Options that fix a part of the search.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GivenCode {
    pub alpha: Option<AlphaMode>,
    pub space: Option<CodeSpace>,
}

/// Decodes a color to straight linear values.
pub(super) fn decode(color: Vec3, amount: f32, alpha: AlphaMode, space: CodeSpace) -> Vec3 {
    let linear = match space {
        CodeSpace::Linear => color,
        CodeSpace::Srgb => Vec3::from(color.to_array().map(linear_from_srgb)),
    };
    match alpha {
        AlphaMode::Straight => linear,
        AlphaMode::Premultiplied => linear / amount.max(1.0 / 255.0),
    }
}

fn hypotheses(given: GivenCode) -> impl Iterator<Item = (AlphaMode, CodeSpace)> {
    let all = AlphaMode::ALL.iter().flat_map(|&alpha| CodeSpace::ALL.iter().map(move |&space| (alpha, space)));
    all.filter(move |(alpha, space)| {
        given.alpha.is_none_or(|given| given == *alpha) && given.space.is_none_or(|given| given == *space)
    })
}

/// Finds the codes of normals: decoded, they have unit length, thin smoke included.
pub(super) fn find_normal_code(normals: &SmallFrames, amount: &SmallFrames, given: GivenCode) -> ColorCode {
    let off = |(alpha, space)| {
        let mut sum = 0.0;
        let mut count = 1.0e-6;
        for (normals, amount) in normals.frames.iter().zip(&amount.frames) {
            for (texel, amount) in normals.texels.iter().zip(&amount.texels).filter(|(_, amount)| amount.w > 0.1) {
                let normal = decode(texel.truncate(), amount.w, alpha, space) * 2.0 - 1.0;
                sum += (normal.length() - 1.0).abs().min(1.0);
                count += 1.0;
            }
        }
        sum / count
    };
    let mut found: Vec<_> = hypotheses(given).map(|code| (code, off(code))).collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let Some(&((alpha, space), least)) = found.first() else { return ColorCode::default() };
    let margin = |differs: &dyn Fn(AlphaMode, CodeSpace) -> bool| {
        let rival = found.iter().find(|((alpha, space), _)| differs(*alpha, *space));
        rival.map_or(0.0, |(_, off)| (off - least) / off.max(0.02))
    };
    ColorCode {
        alpha: Answer::given_or(given.alpha, || Answer::found(alpha, margin(&|other, _| other != alpha))),
        space: Answer::given_or(given.space, || Answer::found(space, margin(&|_, other| other != space))),
    }
}

impl Default for ColorCode {
    fn default() -> Self {
        Self { alpha: Answer::found(AlphaMode::Straight, 0.0), space: Answer::found(CodeSpace::Linear, 0.0) }
    }
}

/// Measures of the codes of light maps.
#[derive(Clone, Copy, Debug)]
struct LightMeasures {
    /// Slope of the logarithm of codes over that of the amount: near 0 if straight, up to 1 if multiplied.
    slope: f32,
    /// Fraction of thin texels whose brightest code exceeds the amount: 0 if linear light is multiplied.
    above: f32,
}

/// Smallest amount of a texel that is examined.
const MIN_AMOUNT: f32 = 0.06;

/// Texels of two maps, with the amount in alpha.
fn texels<'a>(maps: [&'a SmallFrames; 2], amount: &'a SmallFrames) -> impl Iterator<Item = ([Vec3; 2], f32)> + 'a {
    let frames = maps[0].frames.iter().zip(&maps[1].frames).zip(&amount.frames);
    frames.flat_map(|((first, second), amount)| {
        let texels = first.texels.iter().zip(&second.texels).zip(&amount.texels);
        texels.map(|((first, second), amount)| ([first.truncate(), second.truncate()], amount.w))
    })
}

impl LightMeasures {
    fn new(maps: [&SmallFrames; 2], amount: &SmallFrames) -> Self {
        let [mut n, mut x, mut y, mut xx, mut xy] = [1.0e-6_f64; 5];
        let mut thin = 1.0e-6_f32;
        let mut above = 0.0;
        for ([first, second], amount) in texels(maps, amount).filter(|(_, amount)| *amount >= MIN_AMOUNT) {
            let mean = (first + second).element_sum() / 6.0;
            let [log_amount, log_light] = [amount, mean.max(1.0e-3)].map(|value| f64::from(ln(value)));
            n += 1.0;
            x += log_amount;
            y += log_light;
            xx += log_amount * log_amount;
            xy += log_amount * log_light;
            if amount < 0.5 {
                thin += 1.0;
                above += f32::from(first.max(second).max_element() > amount * 1.05 + 0.015);
            }
        }
        let slope = ((xy - x * y / n) / (xx - x * x / n).max(1.0e-6)) as f32;
        Self { slope, above: above / thin }
    }
}

/// Slope between those of straight and of multiplied light. Path-traced maps of six media on four shapes have -0.46 to 0.06
/// and 0.30 to 1.01: thin smoke is not as bright as thick smoke, but never that much darker.
const MIDDLE_SLOPE: f32 = 0.18;
/// Fraction of thin texels above the amount, between those of linear codes and of codes of sRGB.
const MIDDLE_ABOVE: f32 = 0.12;

/// Finds the codes of light maps. Multiplied light falls with the amount, and if it is linear, never exceeds it. Codes of
/// straight light are told by the distribution of the light.
pub(super) fn find_light_code(maps: [&SmallFrames; 2], amount: &SmallFrames, given: GivenCode) -> ColorCode {
    let LightMeasures { slope, above } = LightMeasures::new(maps, amount);
    let alpha = Answer::given_or(given.alpha, || {
        let is_straight = slope < MIDDLE_SLOPE;
        let alpha = if is_straight { AlphaMode::Straight } else { AlphaMode::Premultiplied };
        Answer::found(alpha, (slope - MIDDLE_SLOPE).abs() * 4.0)
    });
    let space = Answer::given_or(given.space, || match alpha.value {
        AlphaMode::Straight => find_straight_space(maps, amount),
        AlphaMode::Premultiplied => {
            let space = if above < MIDDLE_ABOVE { CodeSpace::Linear } else { CodeSpace::Srgb };
            Answer::found(space, (above - MIDDLE_ABOVE).abs() * 5.0)
        }
    });
    ColorCode { alpha, space }
}

/// Finds the space of straight light by a linear function of its distribution: quartiles, and mean and spread of the
/// logarithm, relative to white. It is Fisher's discriminant of path-traced maps of six media on four shapes, in which
/// linear codes have at most -0.18, and codes of sRGB at least 0.62.
fn find_straight_space(maps: [&SmallFrames; 2], amount: &SmallFrames) -> Answer<CodeSpace> {
    let solid = || texels(maps, amount).filter(|(_, amount)| *amount > 0.3);
    let mut brightest: Vec<_> = solid().map(|([first, second], _)| first.max(second).max_element()).collect();
    brightest.sort_by(f32::total_cmp);
    let white = brightest.get(brightest.len() * 99 / 100).copied().unwrap_or(1.0).max(1.0e-3);
    let mut light: Vec<_> =
        solid().flat_map(|([a, b], _)| [a.x, a.y, a.z, b.x, b.y, b.z].map(|code| code / white)).collect();
    light.sort_by(f32::total_cmp);
    let at = |fraction: usize| light.get(light.len() * fraction / 4).copied().unwrap_or(0.0);
    let logs = || light.iter().map(|value| ln(value.max(0.002)));
    let count = light.len().max(1) as f32;
    let mean = logs().sum::<f32>() / count;
    let spread = (logs().map(|log| (log - mean).powi(2)).sum::<f32>() / count).sqrt();
    let score = 15.31 * at(1) - 16.09 * at(3) + 3.814 * mean + 3.563 * spread + 5.518 - 0.22;
    let space = if score < 0.0 { CodeSpace::Linear } else { CodeSpace::Srgb };
    Answer::found(space, score.abs() * 0.8)
}
