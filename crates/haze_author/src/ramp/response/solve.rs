//! Least squares over values at knots, none of them below 0.

use glam::Vec3;

/// The knots round a place from 0 to 1, and how much each counts. The second counts nothing where there is one.
pub(super) fn knots(at: f32, count: usize) -> [(usize, f32); 2] {
    let at = at.clamp(0.0, 1.0) * (count - 1) as f32;
    let low = (at as usize).min(count.saturating_sub(2));
    let share = at - low as f32;
    [(low, 1.0 - share), ((low + 1).min(count - 1), share)]
}

/// Normal equations, of three channels at once.
pub(super) struct Equations {
    count: usize,
    matrix: Vec<f64>,
    right: Vec<[f64; 3]>,
}

impl Equations {
    pub fn new(count: usize) -> Self {
        Self { count, matrix: vec![0.0; count * count], right: vec![[0.0; 3]; count] }
    }

    /// Terms that should sum to a value: its place and its factor, each.
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

    /// How much the equations ask of a value, in the mean.
    pub fn mean_square(&self) -> f64 {
        (0..self.count).map(|i| self.matrix[i * self.count + i]).sum::<f64>() / self.count as f64
    }

    /// The values, by steps of Gauss and Seidel that stay at 0 or above.
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
