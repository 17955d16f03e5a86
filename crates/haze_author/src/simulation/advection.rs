//! Advection: carries values along the velocity for one step, by MacCormack's method. Values stay within the range of
//! those around the start of their path, so that nothing overshoots. (Selle et al. 2008)

use glam::{UVec3, Vec3, Vec4, Vec4Swizzles};

use super::grid::{CellBox, Grid};

/// Paths of one step through the center of every cell.
pub struct Flow {
    grid: Grid,
    /// Distance in cells to the end of the path that starts in a cell, and to the start of the one that ends there.
    ahead: Vec<Vec4>,
    behind: Vec<Vec4>,
}

impl Flow {
    /// Traces the paths by the midpoint rule. `velocity` is that at the centers of cells, and `cells_per_step` the
    /// cells that a velocity of 1 moves in the step.
    pub fn new(grid: Grid, velocity: &[Vec4], cells_per_step: f32) -> Self {
        let trace = |step: f32| {
            let mut paths = vec![Vec4::ZERO; grid.cells()];
            grid.for_rows(&mut paths, |first, row| {
                for (x, path) in (0_u32..).zip(row) {
                    let cell = first + UVec3::X * x;
                    let middle = cell.as_vec3() + velocity[grid.index(cell)].xyz() * (step * 0.5);
                    *path = grid.sample(velocity, middle) * step;
                }
            });
            grid.extend_to_ghosts(&mut paths, None);
            paths
        };
        Self { grid, ahead: trace(cells_per_step), behind: trace(-cells_per_step) }
    }

    /// Returns the longest path along an axis, in cells.
    pub fn longest(&self) -> f32 {
        let paths = self.ahead.iter().chain(&self.behind);
        paths.fold(Vec4::ZERO, |longest, path| longest.max(path.abs())).max_element()
    }

    /// True if a coordinate is within the domain.
    fn is_inside(&self, at: Vec3) -> bool {
        at.cmpge(Vec3::splat(0.5)).all() && at.cmple(self.grid.size.as_vec3() + 0.5).all()
    }

    /// Advects one component of a staggered velocity.
    pub fn advect_faces(&self, values: &[f32], axis: usize) -> Vec<f32> {
        let grid = self.grid;
        let stride = grid.strides()[axis];
        let to_face = Vec3::AXES[axis] * 0.5;
        let path = |paths: &[Vec4], face: usize| (paths[face] + paths[face - stride]).xyz() * 0.5;
        let mut first = values.to_vec();
        grid.for_rows_within(grid.faces(axis), &mut first, |cell, row| {
            for (x, value) in (0_u32..).zip(row) {
                let cell = cell + UVec3::X * x;
                [*value, _, _] = grid.sample_scalar(values, cell.as_vec3() + path(&self.behind, grid.index(cell)));
            }
        });
        let mut advected = first.clone();
        grid.for_rows_within(grid.faces(axis), &mut advected, |cell, row| {
            for (x, value) in (0_u32..).zip(row) {
                let cell = cell + UVec3::X * x;
                let index = grid.index(cell);
                let ahead = cell.as_vec3() + path(&self.ahead, index);
                let behind = cell.as_vec3() + path(&self.behind, index);
                if self.is_inside(ahead - to_face) && self.is_inside(behind - to_face) {
                    let [returned, _, _] = grid.sample_scalar(&first, ahead);
                    let [_, low, high] = grid.sample_scalar(values, behind);
                    *value = (*value + (values[index] - returned) * 0.5).max(low).min(high);
                }
            }
        });
        advected
    }

    /// Advects the numbers of the cells of a box, on a grid with `detail` times as many cells along each side. None may
    /// be negative. Values elsewhere become 0.
    pub fn advect_cells(&self, values: &[Vec4], fine: Grid, cells: CellBox) -> Vec<Vec4> {
        let detail = (fine.size.x / self.grid.size.x) as f32;
        let first = self.carry_cells(values, fine, cells);
        let mut advected = vec![Vec4::ZERO; fine.cells()];
        let to_coarse = |at: Vec3| (at - 0.5) * (1.0 / detail) + 0.5;
        fine.for_rows_within(cells, &mut advected, |cell, row| {
            let start = fine.index(cell);
            let behind = self.paths_of_row(&self.behind, cell, row.len(), detail);
            let ahead = self.paths_of_row(&self.ahead, cell, row.len(), detail);
            for (x, value) in row.iter_mut().enumerate() {
                let carried = first[start + x];
                if carried == Vec4::ZERO {
                    // All around the start of the path is clear.
                    continue;
                }
                *value = carried;
                let at = (cell + UVec3::X * x as u32).as_vec3();
                let ahead = at + ahead[x];
                let behind = at + behind[x];
                if self.is_inside(to_coarse(ahead)) && self.is_inside(to_coarse(behind)) {
                    let error = values[start + x] - fine.sample(&first, ahead);
                    let [low, high] = fine.sample_range(values, behind);
                    *value = (carried + error * 0.5).max(low).min(high);
                }
            }
        });
        advected
    }

    /// The same in one step to the values at the start of each path, which blurs. (Stam 1999)
    pub fn carry_cells(&self, values: &[Vec4], fine: Grid, cells: CellBox) -> Vec<Vec4> {
        let detail = (fine.size.x / self.grid.size.x) as f32;
        let mut carried = vec![Vec4::ZERO; fine.cells()];
        fine.for_rows_within(cells, &mut carried, |cell, row| {
            let paths = self.paths_of_row(&self.behind, cell, row.len(), detail);
            for ((x, value), path) in (0_u32..).zip(row).zip(paths) {
                *value = fine.sample(values, (cell + UVec3::X * x).as_vec3() + path);
            }
        });
        carried
    }

    /// Interpolates the paths to the cells of a row of the finer grid, in its cells.
    fn paths_of_row(&self, paths: &[Vec4], first: UVec3, count: usize, detail: f32) -> Vec<Vec3> {
        let [_, row, slice] = self.grid.strides();
        let at = (first.as_vec3() - 0.5) * (1.0 / detail) + 0.5;
        let low = at.as_uvec3();
        let fraction = at - low.as_vec3();
        let start = self.grid.index(UVec3::new(0, low.y, low.z));
        // The coarse row, interpolated along y and z.
        let line: Vec<Vec4> = (start..start + row)
            .map(|index| {
                let near = paths[index] + (paths[index + row] - paths[index]) * fraction.y;
                let far = paths[index + slice] + (paths[index + slice + row] - paths[index + slice]) * fraction.y;
                (near + (far - near) * fraction.z) * detail
            })
            .collect();
        let along = |x: usize| {
            let at = ((first.x as usize + x) as f32 - 0.5) * (1.0 / detail) + 0.5;
            let low = at as usize;
            (line[low] + (line[low + 1] - line[low]) * (at - low as f32)).xyz()
        };
        (0..count).map(along).collect()
    }
}
