//! Values between keyframes.
//!
//! `smooth` is a cubic Hermite curve through each component, with the slopes of Fritsch and Butland, "A Method for Constructing
//! Local Monotone Piecewise Cubic Interpolants", 1984: the value never leaves the range of the two keyframes around it.

use haze_core::glam::Vec3;

use super::keyframe::{Ease, KeyValue, Keyframe};

/// Kind of the interpolated values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Numbers, positions, sizes and colors: component by component.
    Linear,
    /// Directions turn the short way.
    Direction,
    /// Switches and choices.
    Step,
}

/// Keyframe with its time, which is a period earlier or later for those beyond the ends of a repeating track.
#[derive(Clone, Copy)]
struct Place<'a> {
    key: &'a Keyframe,
    time: f32,
}

/// Two keyframes around a time, and their neighbors.
struct Segment<'a> {
    before: Option<Place<'a>>,
    from: Place<'a>,
    to: Place<'a>,
    after: Option<Place<'a>>,
}

/// Value at a time. Before the first keyframe and after the last, their values. `period` above 0: the keyframes repeat.
/// `None` without keyframes.
pub(super) fn value(keys: &[Keyframe], period: f32, time: f64, kind: Kind) -> Option<KeyValue> {
    let time = if period > 0.0 { time.rem_euclid(f64::from(period)) } else { time };
    let first = keys.first()?;
    let last = keys.last()?;
    let next = keys.partition_point(|key| f64::from(key.time) <= time);
    if keys.len() == 1 || period <= 0.0 && next == 0 {
        return Some(first.value.clone());
    }
    if period <= 0.0 && next == keys.len() {
        return Some(last.value.clone());
    }
    let segment = Segment::ending_at(keys, period, next as i64);
    let Segment { from, to, .. } = &segment;
    let elapsed = (time - f64::from(from.time)) as f32;
    if kind == Kind::Step || from.key.ease == Ease::Hold || elapsed <= 0.0 {
        return Some(from.key.value.clone());
    }
    let progress = (elapsed / (to.time - from.time)).clamp(0.0, 1.0);
    Some(match (&from.key.value, &to.key.value) {
        (KeyValue::Number(_), KeyValue::Number(_)) => KeyValue::Number(segment.component(progress, &number)),
        (KeyValue::Vector(start), KeyValue::Vector(end)) if kind == Kind::Direction => {
            KeyValue::Vector(start.slerp(*end, segment.turn(progress)))
        }
        (KeyValue::Vector(_), KeyValue::Vector(_)) => KeyValue::Vector(Vec3::from_array([0, 1, 2].map(|axis| {
            segment.component(progress, &|key| match key.value {
                KeyValue::Vector(vector) => vector[axis],
                _ => 0.0,
            })
        }))),
        (value, _) => value.clone(),
    })
}

fn number(key: &Keyframe) -> f32 {
    if let KeyValue::Number(number) = key.value { number } else { 0.0 }
}

impl<'a> Segment<'a> {
    /// Segment that ends at a keyframe. With a period, an index beyond the ends is that of another repetition.
    fn ending_at(keys: &'a [Keyframe], period: f32, end: i64) -> Self {
        let count = keys.len() as i64;
        let position = |index: i64| {
            let turns = index.div_euclid(count);
            let key = keys.get(index.rem_euclid(count) as usize).filter(|_| turns == 0 || period > 0.0)?;
            Some(Place { key, time: key.time + turns as f32 * period })
        };
        let nearest = Place { key: &keys[0], time: keys[0].time };
        Self {
            before: position(end - 2),
            from: position(end - 1).unwrap_or(nearest),
            to: position(end).unwrap_or(nearest),
            after: position(end + 1),
        }
    }

    fn component(&self, progress: f32, get: &dyn Fn(&Keyframe) -> f32) -> f32 {
        let start = get(self.from.key);
        let end = get(self.to.key);
        let slope = |from: &Place<'_>, to: &Place<'_>| Slope::between(from, to, get(to.key) - get(from.key));
        start + (end - start) * self.eased(progress, end - start, &slope, &|_| 1.0)
    }

    /// Fraction of the turn from one direction to the next. Angles have no sign, so the axes of two turns tell whether the
    /// second goes on like the first, bends, or leads back: the speed between them is multiplied by the cosine of the bend, at
    /// least 0.
    fn turn(&self, progress: f32) -> f32 {
        let angle = |from: &Place<'_>, to: &Place<'_>| match directions(from, to) {
            Some([from, to]) => from.angle_between(to),
            None => 0.0,
        };
        let axis = |from: &Place<'_>, to: &Place<'_>| {
            directions(from, to).map_or(Vec3::ZERO, |[from, to]| from.cross(to).normalize_or_zero())
        };
        let slope = |from: &Place<'_>, to: &Place<'_>| Slope::between(from, to, angle(from, to));
        let straightness = |[a, b, c]: [&Place<'_>; 3]| axis(a, b).dot(axis(b, c)).max(0.0);
        self.eased(progress, angle(&self.from, &self.to), &slope, &straightness)
    }

    /// Fraction of the way for a fraction of the time. `change`: the length of the way. `straightness` of the way around the
    /// second of three keyframes, 0 to 1, multiplies the slope there.
    fn eased(
        &self,
        progress: f32,
        change: f32,
        slope: &dyn Fn(&Place<'_>, &Place<'_>) -> Slope,
        straightness: &dyn Fn([&Place<'_>; 3]) -> f32,
    ) -> f32 {
        match self.from.key.ease {
            Ease::Linear => progress,
            Ease::EaseIn => progress * progress,
            Ease::EaseOut => progress * (2.0 - progress),
            Ease::Hold => 0.0,
            Ease::Smooth => {
                let here = slope(&self.from, &self.to);
                let from = &self.from;
                let to = &self.to;
                let start = self
                    .before
                    .as_ref()
                    .map_or(0.0, |before| slope(before, from).joined(&here) * straightness([before, from, to]));
                let end = self
                    .after
                    .as_ref()
                    .map_or(0.0, |after| here.joined(&slope(to, after)) * straightness([from, to, after]));
                // Slopes in fractions of the way per fraction of the time.
                let unit = if change == 0.0 { 0.0 } else { here.seconds / change };
                hermite(progress, start * unit, end * unit)
            }
        }
    }
}

/// Directions of two keyframes, if both have one.
fn directions(from: &Place<'_>, to: &Place<'_>) -> Option<[Vec3; 2]> {
    match (&from.key.value, &to.key.value) {
        (KeyValue::Vector(from), KeyValue::Vector(to)) if from.length() > 0.0 && to.length() > 0.0 => {
            Some([*from, *to])
        }
        _ => None,
    }
}

/// Straight line between two keyframes.
struct Slope {
    seconds: f32,
    per_second: f32,
}

impl Slope {
    fn between(from: &Place<'_>, to: &Place<'_>, change: f32) -> Self {
        let seconds = (to.time - from.time).max(1.0e-6);
        // A value that holds rests before it jumps.
        let change = if from.key.ease == Ease::Hold { 0.0 } else { change };
        Self { seconds, per_second: change / seconds }
    }

    /// Slope at the keyframe between two lines: 0 where the value turns back, else their weighted harmonic mean.
    fn joined(&self, next: &Self) -> f32 {
        if self.per_second * next.per_second <= 0.0 {
            return 0.0;
        }
        let left = self.seconds + 2.0 * next.seconds;
        let right = 2.0 * self.seconds + next.seconds;
        (left + right) / (left / self.per_second + right / next.per_second)
    }
}

/// Cubic from 0 to 1 with these slopes at its ends.
fn hermite(x: f32, start: f32, end: f32) -> f32 {
    let x2 = x * x;
    let x3 = x * x * x;
    (x3 - 2.0 * x2 + x) * start + (3.0 * x2 - 2.0 * x3) + (x3 - x2) * end
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn keys(values: &[(f32, f32)], ease: Ease) -> Vec<Keyframe> {
        let key = |&(time, value): &(f32, f32)| Keyframe { time, value: KeyValue::Number(value), ease };
        values.iter().map(key).collect()
    }

    fn number_at(keys: &[Keyframe], period: f32, time: f32) -> f32 {
        match value(keys, period, f64::from(time), Kind::Linear) {
            Some(KeyValue::Number(number)) => number,
            other => unreachable!("{other:?}"),
        }
    }

    #[test]
    fn each_ease_has_its_course_between_two_keyframes() {
        for (ease, quarter, half) in [
            (Ease::Linear, 2.5, 3.0),
            (Ease::EaseIn, 2.125, 2.5),
            (Ease::EaseOut, 2.875, 3.5),
            (Ease::Hold, 2.0, 2.0),
            // Between two keyframes alone it is the smoothstep.
            (Ease::Smooth, 2.0 + 2.0 * 0.15625, 3.0),
        ] {
            let keys = keys(&[(1.0, 2.0), (5.0, 4.0)], ease);
            for (time, expected) in [(-9.0, 2.0), (1.0, 2.0), (2.0, quarter), (3.0, half), (5.0, 4.0), (70.0, 4.0)] {
                let found = number_at(&keys, 0.0, time);
                assert!((found - expected).abs() < 1e-5, "{ease:?} {time}: {found}");
            }
        }
        assert_eq!(value(&[], 0.0, 1.0, Kind::Linear), None);
    }

    #[test]
    fn smooth_does_not_stop_at_a_keyframe_on_the_way_but_rests_where_the_value_turns() {
        let speed = |keys: &[Keyframe], time: f32| {
            (number_at(keys, 0.0, time + 1e-3) - number_at(keys, 0.0, time - 1e-3)) / 2e-3
        };
        let rising = keys(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)], Ease::Smooth);
        assert!((speed(&rising, 1.0) - 1.0).abs() < 0.01, "{}", speed(&rising, 1.0));
        let turning = keys(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)], Ease::Smooth);
        assert!(speed(&turning, 1.0).abs() < 0.01, "{}", speed(&turning, 1.0));
        let mut held = rising;
        held[0].ease = Ease::Hold;
        assert!((number_at(&held, 0.0, 1.01) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_period_repeats_and_leads_from_the_last_keyframe_to_the_first() {
        let open = keys(&[(1.0, 0.0), (2.0, 4.0)], Ease::Linear);
        for (time, expected) in [(1.5, 2.0), (2.0, 4.0), (3.5, 2.0), (5.0, 0.0), (0.5, 2.0 / 3.0), (-2.5, 2.0)] {
            let found = number_at(&open, 4.0, time);
            assert!((found - expected).abs() < 1e-5, "{time}: {found}");
        }
        // A keyframe at the end of the period is the first one's twin, or a jump.
        let closed = keys(&[(0.0, 1.0), (2.0, 3.0), (4.0, 1.0)], Ease::Smooth);
        assert!((number_at(&closed, 4.0, 3.0) - 2.0).abs() < 1e-5);
        assert!((number_at(&closed, 4.0, 8.0) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn directions_turn_the_short_way_at_an_even_rate() {
        let key = |time, degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Keyframe { time, value: KeyValue::Vector(Vec3::new(cos, 0.0, sin)), ease: Ease::Linear }
        };
        let keys = [key(0.0, 170.0), key(1.0, -130.0)];
        let Some(KeyValue::Vector(third)) = value(&keys, 0.0, 1.0 / 3.0, Kind::Direction) else { unreachable!() };
        let expected = 190.0_f32.to_radians();
        assert!(third.distance(Vec3::new(expected.cos(), 0.0, expected.sin())) < 1e-4, "{third}");
    }

    #[test]
    fn smooth_directions_rest_where_they_turn_back_or_aside_and_pass_where_they_go_on() {
        let key = |(time, azimuth, elevation): (f32, f32, f32)| {
            let (sin, cos) = azimuth.to_radians().sin_cos();
            let (up, level) = elevation.to_radians().sin_cos();
            let value = KeyValue::Vector(Vec3::new(cos * level, up, sin * level));
            Keyframe { time, value, ease: Ease::Smooth }
        };
        let speed = |keys: [(f32, f32, f32); 3], time: f32| {
            let keys = keys.map(key);
            let at = |time| match value(&keys, 0.0, f64::from(time), Kind::Direction) {
                Some(KeyValue::Vector(vector)) => vector,
                other => unreachable!("{other:?}"),
            };
            at(time - 5e-3).angle_between(at(time + 5e-3)).to_degrees() / 1e-2
        };
        let there = (1.0, 40.0, 0.0);
        let on = (2.0, 80.0, 0.0);
        let back = (2.0, 0.0, 0.0);
        let up = (2.0, 40.0, 40.0);
        let begin = (0.0, 0.0, 0.0);
        for (last, expected) in [(on, 40.0), (back, 0.0), (up, 0.0)] {
            let speeds = [0.99, 1.0, 1.01].map(|time| speed([begin, there, last], time));
            assert!(speeds.iter().all(|speed| (speed - expected).abs() < 3.0), "{last:?}: {speeds:?}");
        }
        // A bend by 45 degrees passes with the same speed before and after it.
        let bent = [begin, there, (2.0, 68.0, 28.0)];
        let speeds = [0.99, 1.01].map(|time| speed(bent, time));
        assert!((speeds[0] - speeds[1]).abs() < 2.0 && (20.0..36.0).contains(&speeds[0]), "{speeds:?}");
    }

    proptest! {
        #[test]
        fn values_stay_between_their_keyframes(
            steps in prop::collection::vec((0.01f32..5.0, -100.0f32..100.0), 2..8),
            at in 0.0f32..1.0,
            ease in prop::sample::select(Ease::ALL),
            is_periodic: bool,
        ) {
            let mut time = 0.0;
            let values: Vec<_> = steps.iter().map(|(step, value)| { time += step; (time, *value) }).collect();
            let keys = keys(&values, ease);
            let period = if is_periodic { time + 1.0 } else { 0.0 };
            for pair in keys.windows(2) {
                let found = number_at(&keys, period, pair[0].time + at * (pair[1].time - pair[0].time));
                let a = number(&pair[0]);
                let b = number(&pair[1]);
                prop_assert!((a.min(b) - 1e-3..=a.max(b) + 1e-3).contains(&found), "{a} {found} {b}");
            }
            let ends = [number(&keys[0]), number(keys.last().unwrap())];
            let found = number_at(&keys, period, time + 0.5);
            prop_assert!((ends[0].min(ends[1]) - 1e-3..=ends[0].max(ends[1]) + 1e-3).contains(&found));
        }
    }
}
