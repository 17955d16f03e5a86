//! Non-negative linear least squares over values at knots.

use glam::Vec3;

/// Returns the two knots around a position, 0 to 1, with their linear weights. With a single knot the second weight is
/// 0.
pub(super) fn knots(at: f32, count: usize) -> [(usize, f32); 2] {
    let at = at.clamp(0.0, 1.0) * (count - 1) as f32;
    let low = (at as usize).min(count.saturating_sub(2));
    let fraction = at - low as f32;
    [(low, 1.0 - fraction), ((low + 1).min(count - 1), fraction)]
}

/// Normal equations of three channels with a common matrix.
pub(super) struct NormalEquations {
    count: usize,
    matrix: Vec<f64>,
    right: Vec<[f64; 3]>,
}

impl NormalEquations {
    pub fn new(count: usize) -> Self {
        Self { count, matrix: vec![0.0; count * count], right: vec![[0.0; 3]; count] }
    }

    /// Adds a weighted equation: the sum of the terms (knot index, factor) should equal `value`.
    pub fn add(&mut self, terms: &[(usize, f32)], value: Vec3, weight: f32) {
        let weight = f64::from(weight);
        for &(i, a) in terms.iter().filter(|term| term.1 != 0.0) {
            for &(j, b) in terms {
                self.matrix[i * self.count + j] += f64::from(a) * f64::from(b) * weight;
            }
            for (right, value) in self.right[i].iter_mut().zip(value.to_array()) {
                *right += f64::from(a) * f64::from(value) * weight;
            }
        }
    }

    /// Adds a smoothness term over a table of knots from index `first` on: second differences along and across its rows are
    /// to be 0.
    pub fn smooth(&mut self, first: usize, stops: usize, rows: usize, weight: f32) {
        let position = |row: usize, stop: usize| first + row * stops + stop;
        let mut hold = |[before, here, after]: [usize; 3]| {
            self.add(&[(before, 1.0), (here, -2.0), (after, 1.0)], Vec3::ZERO, weight);
        };
        for row in 0..rows {
            (2..stops).for_each(|stop| hold([2, 1, 0].map(|back| position(row, stop - back))));
        }
        for stop in 0..stops {
            (2..rows).for_each(|row| hold([2, 1, 0].map(|back| position(row - back, stop))));
        }
    }

    /// Returns the mean of the matrix's diagonal.
    pub fn mean_square(&self) -> f64 {
        (0..self.count).map(|i| self.matrix[i * self.count + i]).sum::<f64>() / self.count as f64
    }

    /// Solves by projected Gauss-Seidel iteration; values stay at or above 0.
    pub fn solve(&self, steps: u32) -> Vec<Vec3> {
        let mut values = vec![[0.0_f64; 3]; self.count];
        for _ in 0..steps {
            for i in 0..self.count {
                let row = &self.matrix[i * self.count..][..self.count];
                for channel in 0..3 {
                    let sum: f64 = row.iter().zip(&values).map(|(a, value)| a * value[channel]).sum();
                    let step = (self.right[i][channel] - sum) / row[i].max(f64::MIN_POSITIVE);
                    values[i][channel] = (values[i][channel] + step).max(0.0);
                }
            }
        }
        values.iter().map(|value| Vec3::from(value.map(|value| value as f32))).collect()
    }
}
