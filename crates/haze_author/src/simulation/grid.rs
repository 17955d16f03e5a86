//! Grid of cells with one ghost cell on every side, and iteration over its rows on all processors.

use glam::{UVec3, Vec3, Vec4};
use haze_core::assets::parallel::parallel_for_each;

/// Fewest cells for which threads are worth their start.
const PARALLEL_CELLS: usize = 30_000;

/// Size of a grid. Arrays over it hold `cells()` values, x first, then y (up), then z (towards the viewer). Cells
/// inside are numbered from 1; 0 and the last are ghosts. Cell `i` has its center at coordinate `i`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Cells inside, without ghosts.
    pub size: UVec3,
}

impl Grid {
    /// Number of cells with ghosts.
    pub fn cells(self) -> usize {
        self.strides()[2] * (self.size.z as usize + 2)
    }

    /// Distance in the arrays to the next cell along x, y and z.
    pub fn strides(self) -> [usize; 3] {
        let row = self.size.x as usize + 2;
        [1, row, row * (self.size.y as usize + 2)]
    }

    /// Index of a cell, ghosts included.
    pub fn index(self, cell: UVec3) -> usize {
        let [_, row, slice] = self.strides();
        cell.z as usize * slice + cell.y as usize * row + cell.x as usize
    }

    /// Returns the faces along an axis, each numbered as the cell above it. The last ones lie in the ghosts.
    pub fn faces(self, axis: usize) -> CellBox {
        let mut high = self.size;
        high[axis] += 1;
        CellBox { low: UVec3::ONE, high }
    }

    /// Calls `f(first_cell, values)` for every row of cells inside, without its ghosts.
    pub fn for_rows<T: Send>(self, values: &mut [T], f: impl Fn(UVec3, &mut [T]) + Sync) {
        self.for_rows_within(CellBox { low: UVec3::ONE, high: self.size }, values, f);
    }

    /// Calls `f(first_cell, values)` for every row of cells in a box.
    pub fn for_rows_within<T: Send>(self, cells: CellBox, values: &mut [T], f: impl Fn(UVec3, &mut [T]) + Sync) {
        if cells.is_empty() {
            return;
        }
        let [_, row, slice] = self.strides();
        let range = cells.low.x as usize..cells.high.x as usize + 1;
        let work = |(z, slice): (u32, &mut [T])| {
            let rows = (0..).zip(slice.chunks_mut(row));
            for (y, row) in rows.skip(cells.low.y as usize).take((cells.high.y + 1 - cells.low.y) as usize) {
                f(UVec3::new(cells.low.x, y, z), &mut row[range.clone()]);
            }
        };
        let slices = (0..).zip(values.chunks_mut(slice));
        let slices = slices.skip(cells.low.z as usize).take((cells.high.z + 1 - cells.low.z) as usize);
        if self.cells() < PARALLEL_CELLS {
            slices.for_each(work);
        } else {
            parallel_for_each(slices, work);
        }
    }

    /// Adds up `f(first_index)` over all rows inside. The order of additions does not depend on the number of threads.
    pub fn sum_rows(self, f: impl Fn(usize) -> f64 + Sync) -> f64 {
        let mut sums = vec![0.0; self.size.z as usize];
        let work = |(z, sum): (u32, &mut f64)| {
            *sum = (1..=self.size.y).map(|y| f(self.index(UVec3::new(1, y, z)))).sum();
        };
        let slices = (1..).zip(&mut sums);
        if self.cells() < PARALLEL_CELLS {
            slices.for_each(work);
        } else {
            parallel_for_each(slices, work);
        }
        sums.iter().sum()
    }

    /// Returns the cells around a coordinate, which is clamped to the ghosts' centers.
    #[inline]
    fn corner(self, at: Vec3) -> (usize, Vec3) {
        let at = at.clamp(Vec3::ZERO, self.size.as_vec3() + 0.999);
        let low = at.as_uvec3();
        (self.index(low), at - low.as_vec3())
    }

    /// Interpolates four numbers of a cell trilinearly.
    #[inline]
    pub fn sample(self, values: &[Vec4], at: Vec3) -> Vec4 {
        let (first, fraction) = self.corner(at);
        let [_, row, slice] = self.strides();
        let along = |start: usize| {
            let pair = &values[start..start + 2];
            pair[0] + (pair[1] - pair[0]) * fraction.x
        };
        let plane = |start: usize| {
            let low = along(start);
            low + (along(start + row) - low) * fraction.y
        };
        let near = plane(first);
        near + (plane(first + slice) - near) * fraction.z
    }

    /// Returns the least and the largest of the eight values that [`Grid::sample`] interpolates.
    #[inline]
    pub fn sample_range(self, values: &[Vec4], at: Vec3) -> [Vec4; 2] {
        let (first, _) = self.corner(at);
        let [_, row, slice] = self.strides();
        let mut low = values[first];
        let mut high = low;
        for start in [first, first + row, first + slice, first + row + slice] {
            for value in &values[start..start + 2] {
                low = low.min(*value);
                high = high.max(*value);
            }
        }
        [low, high]
    }

    /// [`Grid::sample`] and [`Grid::sample_range`] of one number of a cell: value, least, largest.
    #[inline]
    pub fn sample_scalar(self, values: &[f32], at: Vec3) -> [f32; 3] {
        let (first, fraction) = self.corner(at);
        let [_, row, slice] = self.strides();
        let mut low = values[first];
        let mut high = low;
        let mut along = |start: usize| {
            let pair = &values[start..start + 2];
            low = low.min(pair[0].min(pair[1]));
            high = high.max(pair[0].max(pair[1]));
            pair[0] + (pair[1] - pair[0]) * fraction.x
        };
        let lines = [along(first), along(first + row), along(first + slice), along(first + row + slice)];
        let near = lines[0] + (lines[1] - lines[0]) * fraction.y;
        let far = lines[2] + (lines[3] - lines[2]) * fraction.y;
        [near + (far - near) * fraction.z, low, high]
    }

    /// Returns the cells of a box for which `is_occupied` is true of their index, as a smaller box.
    pub fn occupied(self, cells: CellBox, is_occupied: impl Fn(usize) -> bool + Sync) -> CellBox {
        if cells.is_empty() {
            return cells;
        }
        let mut boxes = vec![CellBox::EMPTY; (cells.high.z + 1 - cells.low.z) as usize];
        parallel_for_each((cells.low.z..).zip(&mut boxes), |(z, found)| {
            for y in cells.low.y..=cells.high.y {
                let start = self.index(UVec3::new(0, y, z));
                let is_occupied = |&x: &u32| is_occupied(start + x as usize);
                let mut row = cells.low.x..=cells.high.x;
                if let Some(first) = row.find(is_occupied) {
                    found.include(UVec3::new(first, y, z));
                    let last = row.rfind(is_occupied).unwrap_or(first);
                    found.include(UVec3::new(last, y, z));
                }
            }
        });
        boxes.into_iter().fold(CellBox::EMPTY, CellBox::union)
    }

    /// Copies the cells next to the ghosts to them: no slope across the border. The last layer along `staggered` is
    /// kept: faces of the border, not ghosts.
    pub fn extend_to_ghosts<T: Copy>(self, values: &mut [T], staggered: Option<usize>) {
        let last = self.size + 1;
        for axis in 0..3 {
            let stride = self.strides()[axis];
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            for i in 0..=last[a] {
                for j in 0..=last[b] {
                    let mut cell = UVec3::ZERO;
                    cell[a] = i;
                    cell[b] = j;
                    let low = self.index(cell);
                    cell[axis] = last[axis];
                    let high = self.index(cell);
                    values[low] = values[low + stride];
                    if staggered != Some(axis) {
                        values[high] = values[high - stride];
                    }
                }
            }
        }
    }
}

/// Box of cells, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellBox {
    pub low: UVec3,
    pub high: UVec3,
}

impl CellBox {
    pub const EMPTY: Self = Self { low: UVec3::MAX, high: UVec3::ZERO };

    pub fn is_empty(self) -> bool {
        self.low.cmpgt(self.high).any()
    }

    pub fn include(&mut self, cell: UVec3) {
        self.low = self.low.min(cell);
        self.high = self.high.max(cell);
    }

    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Returns the box with `margin` more cells on every side, within the grid.
    pub fn grown(self, margin: u32, grid: Grid) -> Self {
        if self.is_empty() {
            return self;
        }
        let low = self.low.saturating_sub(UVec3::splat(margin)).max(UVec3::ONE);
        Self { low, high: (self.high + margin).min(grid.size) }
    }
}
