//! Curves over the life of a particle, or over an emission.

use glam::{Vec2, Vec4};

/// Maximum number of points of a [`Curve`].
pub const MAX_CURVE_POINTS: usize = 8;

/// Curve over the life of a particle, or over an emission: one to eight points (x, value), with straight lines between them,
/// and constant before the first and after the last. x is from 0, at the beginning, to 1, at the end, and increases.
///
/// In JSON: `[[0, 0.2], [0.3, 1], [1, 0]]`. On the command line: `0:0.2,0.3:1,1:0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// The last point is repeated.
    points: [Vec2; MAX_CURVE_POINTS],
    count: usize,
}

/// Points that are no curve: the problem, and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CurveError {
    problem: String,
}

impl std::fmt::Display for CurveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}; expected 1 to {MAX_CURVE_POINTS} points [x, value], with x from 0 to 1, increasing",
            self.problem
        )
    }
}

impl std::error::Error for CurveError {}

impl Curve {
    /// Curve with the same value everywhere.
    pub const fn constant(value: f32) -> Self {
        Self { points: [Vec2::new(0.0, value); MAX_CURVE_POINTS], count: 1 }
    }

    /// Curve through these points (x, value).
    ///
    /// # Errors
    /// No points, or more than [`MAX_CURVE_POINTS`]; x outside 0..=1 or not increasing; numbers that are not finite.
    pub fn new(points: &[Vec2]) -> Result<Self, CurveError> {
        let problem = |problem: String| Err(CurveError { problem });
        let Some(&last) = points.last().filter(|_| points.len() <= MAX_CURVE_POINTS) else {
            return problem(format!("{} points", points.len()));
        };
        if let Some(point) = points.iter().find(|point| !point.is_finite() || !(0.0..=1.0).contains(&point.x)) {
            return problem(format!("the point [{}, {}]", point.x, point.y));
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[0].x >= pair[1].x) {
            return problem(format!("x {} after x {}", pair[1].x, pair[0].x));
        }
        let mut all = [last; MAX_CURVE_POINTS];
        all[..points.len()].copy_from_slice(points);
        Ok(Self { points: all, count: points.len() })
    }

    /// Points (x, value).
    pub fn points(&self) -> &[Vec2] {
        &self.points[..self.count]
    }

    /// Largest value.
    pub fn max_value(&self) -> f32 {
        self.points.iter().fold(f32::NEG_INFINITY, |highest, point| highest.max(point.y))
    }

    /// Points as `formula::curve` reads them, two in each vector.
    pub fn packed(&self) -> [Vec4; MAX_CURVE_POINTS / 2] {
        std::array::from_fn(|pair| (self.points[2 * pair], self.points[2 * pair + 1]).into())
    }
}

impl std::fmt::Display for Curve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, point) in self.points().iter().enumerate() {
            let comma = if index > 0 { "," } else { "" };
            write!(f, "{comma}{}:{}", point.x, point.y)?;
        }
        Ok(())
    }
}

impl std::str::FromStr for Curve {
    type Err = CurveError;

    fn from_str(text: &str) -> Result<Self, CurveError> {
        let point = |pair: &str| {
            let (age, value) = pair.split_once(':')?;
            Some(Vec2::new(age.trim().parse().ok()?, value.trim().parse().ok()?))
        };
        let points: Option<Vec<_>> = text.split(',').map(point).collect();
        Self::new(&points.ok_or_else(|| CurveError { problem: format!("{text:?}") })?)
    }
}

impl serde::Serialize for Curve {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.points().iter().map(Vec2::to_array))
    }
}

impl<'de> serde::Deserialize<'de> for Curve {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let points: Vec<[f32; 2]> = serde::Deserialize::deserialize(deserializer)?;
        let points: Vec<_> = points.into_iter().map(Vec2::from).collect();
        Self::new(&points).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_json_round_trip() {
        let curve: Curve = " 0:0.2, 0.5:1 ,1:0".parse().unwrap();
        assert_eq!(curve.to_string().parse::<Curve>().unwrap(), curve);
        let json = serde_json::to_string(&curve).unwrap();
        assert_eq!(json, "[[0.0,0.2],[0.5,1.0],[1.0,0.0]]");
        assert_eq!(serde_json::from_str::<Curve>(&json).unwrap(), curve);
    }

    #[test]
    fn points_that_are_no_curve_are_refused() {
        let refused = |json: &str| serde_json::from_str::<Curve>(json).unwrap_err().to_string();
        let expected = "; expected 1 to 8 points [x, value], with x from 0 to 1, increasing";
        assert_eq!(refused("[]"), format!("0 points{expected}"));
        assert_eq!(refused("[[0,1],[0.5,1],[0.5,2]]"), format!("x 0.5 after x 0.5{expected}"));
        assert_eq!(refused("[[0,1],[1.5,1]]"), format!("the point [1.5, 1]{expected}"));
        assert_eq!(refused("[[0,1e39]]"), format!("the point [0, inf]{expected}"));
        assert!(refused(&format!("[{}]", ["[0,1]"; 9].join(","))).starts_with("9 points"));
        assert!("0;1".parse::<Curve>().unwrap_err().to_string().starts_with("\"0;1\""));
    }
}
