//! Pressure projection: makes the velocity free of divergence.
//!
//! Solves Poisson's equation on the cells by conjugate gradients, preconditioned by one V-cycle of multigrid. (McAdams,
//! Sifakis and Teran, "A parallel multigrid Poisson solver for fluids simulation on large grids", 2010)

use glam::UVec3;

use super::grid::Grid;

/// Norm of the divergence that is left, relative to that before the projection.
pub const RELATIVE_RESIDUAL: f64 = 1.0e-4;
const MAX_ITERATIONS: u32 = 60;
/// Jacobi sweeps before and after the coarser grid's correction, and on the coarsest grid.
const SWEEPS: u32 = 2;
const COARSEST_SWEEPS: u32 = 16;
/// Weight of a Jacobi sweep that damps high frequencies of a 7-point stencil best.
const RELAXATION: f32 = 6.0 / 7.0;

/// Solver for one domain: the faces that are open do not change.
pub struct PressureSolver {
    levels: Vec<Level>,
    /// Pressure of the last step, with which the next one starts.
    pub pressure: Vec<f32>,
    direction: Vec<f32>,
    product: Vec<f32>,
}

/// Matrix of the pressure equation on one grid: 7-point stencil with open and solid faces.
struct Matrix {
    grid: Grid,
    /// Openness of the faces below each cell along x, y and z: 1 open, 0 solid.
    faces: [Vec<f32>; 3],
    /// Inverse of the sum of a cell's six faces, 0 in solid cells.
    inverse_diagonal: Vec<f32>,
}

impl Matrix {
    fn new(grid: Grid, faces: [Vec<f32>; 3]) -> Self {
        let mut inverse_diagonal = vec![0.0; grid.cells()];
        grid.for_rows(&mut inverse_diagonal, |first, row| {
            for (index, inverse) in (grid.index(first)..).zip(row) {
                let openness = |(faces, stride): (&Vec<f32>, usize)| faces[index] + faces[index + stride];
                let sum: f32 = faces.iter().zip(grid.strides()).map(openness).sum();
                *inverse = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            }
        });
        Self { grid, faces, inverse_diagonal }
    }

    /// Returns the matrix of half the size, or `None` if this is the coarsest.
    fn coarser(&self) -> Option<Self> {
        let size = self.grid.size;
        if (size % 2).max_element() > 0 || size.min_element() <= 2 {
            return None;
        }
        let grid = Grid { size: size / 2 };
        let faces = [0, 1, 2].map(|axis| {
            let mut openness = vec![0.0; grid.cells()];
            let fine = &self.faces[axis];
            let strides = self.grid.strides();
            let [a, b] = [strides[(axis + 1) % 3], strides[(axis + 2) % 3]];
            grid.for_rows_within(grid.faces(axis), &mut openness, |cell, row| {
                for (x, open) in (0_u32..).zip(row) {
                    let first = self.grid.index((cell + UVec3::X * x) * 2 - 1);
                    // The mean of the four faces that this one covers.
                    *open = (fine[first] + fine[first + a] + fine[first + b] + fine[first + a + b]) * 0.25;
                }
            });
            openness
        });
        Some(Self::new(grid, faces))
    }

    /// Computes out = A values.
    fn multiply(&self, values: &[f32], out: &mut [f32]) {
        self.grid.for_rows(out, |first, row| {
            let start = self.grid.index(first);
            let stencil = Stencil::new(self, values, start, row.len());
            let here = &values[start..start + row.len()];
            for (x, out) in row.iter_mut().enumerate() {
                *out = stencil.diagonal(x) * here[x] - stencil.sum(x);
            }
        });
    }

    /// One damped Jacobi sweep from `values` to `out`.
    fn smooth(&self, right: &[f32], values: &[f32], out: &mut [f32]) {
        self.grid.for_rows(out, |first, row| {
            let start = self.grid.index(first);
            let stencil = Stencil::new(self, values, start, row.len());
            let [here, right, inverse] =
                [values, right, &self.inverse_diagonal].map(|values| &values[start..start + row.len()]);
            for (x, out) in row.iter_mut().enumerate() {
                let target = (right[x] + stencil.sum(x)) * inverse[x];
                *out = here[x] + (target - here[x]) * RELAXATION;
            }
        });
    }
}

/// Rows around one row of cells: the faces to its six neighbours, and their values.
struct Stencil<'a> {
    faces: [&'a [f32]; 6],
    neighbours: [&'a [f32]; 6],
}

impl<'a> Stencil<'a> {
    fn new(matrix: &'a Matrix, values: &'a [f32], first: usize, count: usize) -> Self {
        let strides = matrix.grid.strides();
        let row = |values: &'a [f32], start: usize| &values[start..start + count];
        // Below and above along each axis.
        let faces = |side: usize| row(&matrix.faces[side / 2], first + side % 2 * strides[side / 2]);
        let neighbour = |side: usize| row(values, first + side % 2 * 2 * strides[side / 2] - strides[side / 2]);
        Self { faces: std::array::from_fn(faces), neighbours: std::array::from_fn(neighbour) }
    }

    /// Sum of the neighbours, weighted by the faces to them.
    #[inline(always)]
    fn sum(&self, x: usize) -> f32 {
        let [a, b, c, d, e, f] = self.faces;
        let [p, q, r, s, t, u] = self.neighbours;
        (a[x] * p[x] + b[x] * q[x]) + (c[x] * r[x] + d[x] * s[x]) + (e[x] * t[x] + f[x] * u[x])
    }

    #[inline(always)]
    fn diagonal(&self, x: usize) -> f32 {
        let [a, b, c, d, e, f] = self.faces;
        (a[x] + b[x]) + (c[x] + d[x]) + (e[x] + f[x])
    }
}

/// One grid of the multigrid.
struct Level {
    matrix: Matrix,
    right: Vec<f32>,
    solution: Vec<f32>,
    scratch: Vec<f32>,
}

impl Level {
    fn new(matrix: Matrix) -> Self {
        let zero = || vec![0.0; matrix.grid.cells()];
        Self { right: zero(), solution: zero(), scratch: zero(), matrix }
    }

    /// Smooths the solution `count` times. With `from_zero`, the solution is taken as 0 first.
    fn relax(&mut self, count: u32, from_zero: bool) {
        if from_zero {
            // The first sweep from 0.
            let Matrix { grid, inverse_diagonal, .. } = &self.matrix;
            grid.for_rows(&mut self.solution, |first, row| {
                let start = grid.index(first);
                for ((value, right), inverse) in
                    row.iter_mut().zip(&self.right[start..]).zip(&inverse_diagonal[start..])
                {
                    *value = right * inverse * RELAXATION;
                }
            });
        }
        for _ in u32::from(from_zero)..count {
            self.matrix.smooth(&self.right, &self.solution, &mut self.scratch);
            std::mem::swap(&mut self.solution, &mut self.scratch);
        }
    }

    /// Restricts the residual of this level to the right side of the coarser one.
    fn restrict_to(&mut self, coarse: &mut Self) {
        self.matrix.multiply(&self.solution, &mut self.scratch);
        let grid = self.matrix.grid;
        let [x, y, z] = grid.strides();
        coarse.matrix.grid.for_rows(&mut coarse.right, |first, row| {
            let start = grid.index(first * 2 - 1);
            for (index, out) in row.iter_mut().enumerate() {
                let left = start + 2 * index;
                let residual = |at: usize| self.right[at] - self.scratch[at];
                let pair = |at: usize| residual(at) + residual(at + x);
                // The mean of eight cells, times 4 because the cells are twice as wide.
                *out = ((pair(left) + pair(left + y)) + (pair(left + z) + pair(left + y + z))) * 0.5;
            }
        });
    }

    /// Adds the coarser level's solution.
    fn add(&mut self, coarse: &Self) {
        self.matrix.grid.for_rows(&mut self.solution, |first, row| {
            let start = coarse.matrix.grid.index((first + 1) / 2);
            for (index, value) in row.iter_mut().enumerate() {
                *value += coarse.solution[start + index / 2];
            }
        });
    }
}

/// Sum of products of two rows in eight lanes.
fn dot_row(a: &[f32], b: &[f32]) -> f64 {
    let mut lanes = [0.0_f32; 8];
    for (a, b) in a.chunks(8).zip(b.chunks(8)) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().map(|&lane| f64::from(lane)).sum()
}

fn dot(grid: Grid, a: &[f32], b: &[f32]) -> f64 {
    let count = grid.size.x as usize;
    grid.sum_rows(|first| dot_row(&a[first..first + count], &b[first..first + count]))
}

/// Adds `factor` times `b` to `a`.
fn add_scaled(grid: Grid, a: &mut [f32], factor: f32, b: &[f32]) {
    grid.for_rows(a, |first, row| {
        row.iter_mut().zip(&b[grid.index(first)..]).for_each(|(a, b)| *a += factor * b);
    });
}

impl PressureSolver {
    /// `faces` holds 1 for each open face below a cell along x, y and z, and 0 for each solid one. Beyond open faces of
    /// the border the pressure is 0.
    pub fn new(grid: Grid, faces: [Vec<f32>; 3]) -> Self {
        let mut levels = vec![Level::new(Matrix::new(grid, faces))];
        while let Some(coarser) = levels.last().and_then(|level| level.matrix.coarser()) {
            levels.push(Level::new(coarser));
        }
        let zero = || vec![0.0; grid.cells()];
        Self { levels, pressure: zero(), direction: zero(), product: zero() }
    }

    /// Subtracts the pressure's slope from the velocity on the faces, so that the flow out of each cell becomes
    /// `expansion`: the sum of the velocities on its faces. Returns the number of iterations.
    pub fn project(&mut self, velocity: &mut [Vec<f32>; 3], expansion: &[f32]) -> u32 {
        let grid = self.levels[0].matrix.grid;
        let strides = grid.strides();
        // Nothing flows through solid faces.
        for (component, faces) in velocity.iter_mut().zip(&self.levels[0].matrix.faces) {
            component.iter_mut().zip(faces).for_each(|(value, open)| *value *= open);
        }
        let mut residual = vec![0.0; grid.cells()];
        let inverse = &self.levels[0].matrix.inverse_diagonal;
        grid.for_rows(&mut residual, |first, row| {
            for (index, out) in (grid.index(first)..).zip(row) {
                let flow = |axis: usize| velocity[axis][index + strides[axis]] - velocity[axis][index];
                let divergence = flow(0) + flow(1) + flow(2);
                *out = if inverse[index] > 0.0 { expansion[index] - divergence } else { 0.0 };
            }
        });
        let iterations = self.solve(residual);
        for (axis, component) in velocity.iter_mut().enumerate() {
            let faces = &self.levels[0].matrix.faces[axis];
            let pressure = &self.pressure;
            let stride = strides[axis];
            // Also the faces above the last cells.
            for (index, value) in component.iter_mut().enumerate().skip(strides[2]) {
                *value -= faces[index] * (pressure[index] - pressure[index - stride]);
            }
        }
        iterations
    }

    /// Solves A pressure = right.
    fn solve(&mut self, right: Vec<f32>) -> u32 {
        let grid = self.levels[0].matrix.grid;
        let goal = dot(grid, &right, &right) * RELATIVE_RESIDUAL * RELATIVE_RESIDUAL;
        let mut residual = right;
        self.levels[0].matrix.multiply(&self.pressure, &mut self.product);
        add_scaled(grid, &mut residual, -1.0, &self.product);
        let mut slope = 0.0;
        for iteration in 0..MAX_ITERATIONS {
            // Also false for NaN.
            if dot(grid, &residual, &residual) <= goal {
                return iteration;
            }
            residual = self.precondition(residual);
            let preconditioned = &self.levels[0].solution;
            let steeper = dot(grid, &residual, preconditioned);
            let keep = if iteration == 0 { 0.0 } else { (steeper / slope) as f32 };
            slope = steeper;
            grid.for_rows(&mut self.direction, |first, row| {
                let preconditioned = &preconditioned[grid.index(first)..];
                row.iter_mut().zip(preconditioned).for_each(|(direction, step)| *direction = step + keep * *direction);
            });
            self.levels[0].matrix.multiply(&self.direction, &mut self.product);
            let curvature = dot(grid, &self.direction, &self.product);
            if curvature <= 0.0 {
                return iteration;
            }
            let step = (slope / curvature) as f32;
            add_scaled(grid, &mut self.pressure, step, &self.direction);
            add_scaled(grid, &mut residual, -step, &self.product);
        }
        MAX_ITERATIONS
    }

    /// Solves approximately for `right` by one V-cycle, into the solution of the first level. Returns `right`.
    fn precondition(&mut self, right: Vec<f32>) -> Vec<f32> {
        self.levels[0].right = right;
        let last = self.levels.len() - 1;
        for index in 0..last {
            let (fine, coarse) = self.levels.split_at_mut(index + 1);
            fine[index].relax(SWEEPS, true);
            fine[index].restrict_to(&mut coarse[0]);
        }
        self.levels[last].relax(COARSEST_SWEEPS, true);
        for index in (0..last).rev() {
            let (fine, coarse) = self.levels.split_at_mut(index + 1);
            fine[index].add(&coarse[0]);
            fine[index].relax(SWEEPS, false);
        }
        std::mem::take(&mut self.levels[0].right)
    }
}
