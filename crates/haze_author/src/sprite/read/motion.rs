//! Directions and scale of motion vectors.
//!
//! The right ones predict the next frame: a texel of the next frame, moved back by its way, is that of this frame.

use std::str::FromStr;

use glam::Vec2;
use haze_core::settings::choice;

use super::answer::Answer;
use super::small_frames::{SmallFrames, bilinear};

choice! {
    /// Direction of full red or green.
    Direction {
        /// Right.
        #[default]
        Right = "right",
        /// Left.
        Left = "left",
        /// Up.
        Up = "up",
        /// Down.
        Down = "down",
    }
}

impl Direction {
    /// Unit vector, y down.
    fn way(self) -> Vec2 {
        match self {
            Self::Right => Vec2::X,
            Self::Left => Vec2::NEG_X,
            Self::Up => Vec2::NEG_Y,
            Self::Down => Vec2::Y,
        }
    }

    fn is_across(self) -> bool {
        matches!(self, Self::Right | Self::Left)
    }
}

/// Directions of full red and full green.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionAxes {
    /// Direction of full red.
    red: Direction,
    /// Direction of full green, across that of red.
    green: Direction,
}

impl Default for MotionAxes {
    /// Those of haze's own maps.
    fn default() -> Self {
        Self { red: Direction::Right, green: Direction::Down }
    }
}

impl MotionAxes {
    /// Returns the axes if one is across the view and the other along its height.
    pub fn new(red: Direction, green: Direction) -> Option<Self> {
        (red.is_across() != green.is_across()).then_some(Self { red, green })
    }

    /// Returns all eight.
    pub fn all() -> impl Iterator<Item = Self> {
        let pairs = Direction::ALL.iter().flat_map(|&red| Direction::ALL.iter().map(move |&green| (red, green)));
        pairs.filter_map(|(red, green)| Self::new(red, green))
    }

    /// Names of both: `right, down`.
    pub fn name(self) -> String {
        format!("{}, {}", self.red.name(), self.green.name())
    }

    /// Returns the way of a signed vector: right, down.
    pub fn way(self, vector: Vec2) -> Vec2 {
        self.red.way() * vector.x + self.green.way() * vector.y
    }

    /// Returns the signed vector of a way: right, down.
    pub fn vector(self, way: Vec2) -> Vec2 {
        Vec2::new(self.red.way().dot(way), self.green.way().dot(way))
    }
}

impl FromStr for MotionAxes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "{text:?} are no directions; expected those of full red and full green, as right,down: one of right and left, \
                 the other of up and down"
            )
        };
        let (red, green) = text.split_once(',').ok_or_else(expected)?;
        let direction = |name: &str| name.trim().parse().map_err(|_| expected());
        Self::new(direction(red)?, direction(green)?).ok_or_else(expected)
    }
}

/// Meaning of the vectors of a motion map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionCode {
    /// Directions of full red and green.
    pub axes: Answer<MotionAxes>,
    /// Way of full red or green, as a fraction of a frame's width or height.
    pub scale: Answer<f32>,
}

/// Options that fix a part of the search.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GivenMotion {
    pub axes: Option<MotionAxes>,
    pub scale: Option<f32>,
}

/// Pairs of frames that are examined.
const MAX_PAIRS: usize = 10;

/// Finds directions and scale. `vectors` holds signed vectors in red and green, -1 to 1; `smoke` what moves, premultiplied.
pub(super) fn find_motion(vectors: &SmallFrames, smoke: &SmallFrames, given: GivenMotion) -> MotionCode {
    let pairs = smoke.frames.len().saturating_sub(1);
    let examined: Vec<_> = (0..pairs).step_by(pairs.div_ceil(MAX_PAIRS).max(1)).collect();
    let error = |axes: MotionAxes, scale: f32| {
        examined.iter().map(|&frame| prediction_error(vectors, smoke, frame, axes, scale)).sum::<f32>()
    };
    let still = error(MotionAxes::default(), 0.0);
    // From 1/512 to 1/2 of a frame, in steps of a factor of the square root of 2.
    let steps: Vec<_> = (0..17).map(|step| 2.0_f32.powf(step as f32 * 0.5 - 9.0)).collect();
    let best_scale = |axes: MotionAxes| {
        if let Some(scale) = given.scale {
            return (scale, error(axes, scale));
        }
        let errors: Vec<_> = steps.iter().map(|&scale| error(axes, scale)).collect();
        let least = (0..steps.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
        refine(&steps, &errors, least, |scale| error(axes, scale))
    };
    let candidates = MotionAxes::all().filter(|axes| given.axes.is_none_or(|given| given == *axes));
    let mut found: Vec<_> = candidates.map(|axes| (axes, best_scale(axes))).collect();
    found.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let Some(&(axes, (scale, least))) = found.first() else {
        return MotionCode { axes: Answer::found(MotionAxes::default(), 0.0), scale: Answer::found(0.0, 0.0) };
    };
    let gain = |error: f32| if still > 1.0e-9 { 1.0 - error / still } else { 0.0 };
    let second = found.get(1).map_or(still, |(_, (_, error))| *error);
    let margin = gain(least) - gain(second).max(0.0);
    MotionCode {
        axes: given.axes.map_or(Answer::found(axes, margin * 6.0), Answer::given),
        scale: given.scale.map_or(Answer::found(scale, gain(least) * 0.7), Answer::given),
    }
}

/// Refines the best of several scales by the parabola through the logarithms of it and its neighbors.
fn refine(steps: &[f32], errors: &[f32], least: usize, error: impl Fn(f32) -> f32) -> (f32, f32) {
    let best = (steps[least], errors[least]);
    if least == 0 || least + 1 >= steps.len() {
        return best;
    }
    let [low, middle, high] = [errors[least - 1], errors[least], errors[least + 1]];
    let bend = low - 2.0 * middle + high;
    if bend <= 0.0 {
        return best;
    }
    let step = 0.5 * (low - high) / bend;
    let scale = steps[least] * 2.0_f32.powf(step.clamp(-1.0, 1.0) * 0.5);
    let refined = (scale, error(scale));
    if refined.1 < best.1 { refined } else { best }
}

fn prediction_error(vectors: &SmallFrames, smoke: &SmallFrames, frame: usize, axes: MotionAxes, scale: f32) -> f32 {
    let [Some(now), Some(next), Some(vectors)] =
        [smoke.frames.get(frame), smoke.frames.get(frame + 1), vectors.frames.get(frame)]
    else {
        return 0.0;
    };
    let size = smoke.size.as_vec2();
    let mut sum = 0.0;
    for (index, texel) in (0..).zip(&now.texels) {
        let at = Vec2::new((index % smoke.size.x) as f32, (index / smoke.size.x) as f32);
        let vector = bilinear(vectors, (at + 0.5) * vectors.size.as_vec2() / size - 0.5);
        let way = axes.way(vector.truncate().truncate()) * scale * size;
        sum += (bilinear(next, at + way) - *texel).length_squared();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_pairs_of_directions_are_read_back() {
        assert_eq!(MotionAxes::all().count(), 8);
        for axes in MotionAxes::all() {
            assert_eq!(axes.name().parse(), Ok(axes));
            let way = Vec2::new(0.3, -0.2);
            assert!(axes.way(axes.vector(way)).distance(way) < 1.0e-6);
        }
        for bad in ["right", "right,left", "up,down", "right,forward"] {
            assert!(bad.parse::<MotionAxes>().unwrap_err().contains("expected those of full red"), "{bad}");
        }
    }
}
