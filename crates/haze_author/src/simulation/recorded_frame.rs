//! One moment of a simulation, as small as it can be kept until all are framed.

use glam::{UVec3, Vec2, Vec3, Vec4};
use half::f16;

use super::domain::Domain;
use super::grid::{CellBox, Grid};
use super::sim_recipe::View;

/// Least optical depth of a column of smoke that counts as visible, in units of the extinction's length.
const MIN_COLUMN: f32 = 3.0e-3;

/// Part of the image that smoke covers, in box widths: x and y of its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    pub low: Vec2,
    pub high: Vec2,
}

impl Extent {
    pub const EMPTY: Self = Self { low: Vec2::INFINITY, high: Vec2::NEG_INFINITY };

    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// Gas of one moment where there is any.
#[derive(Clone, Debug)]
pub struct RecordedFrame {
    /// Cells of the fine grid that are kept.
    pub cells: CellBox,
    /// Smoke, heat, and velocity along x and y, of every cell of the box.
    pub values: Vec<[f16; 4]>,
    pub extent: Extent,
}

/// A recorded frame as a grid that can be sampled.
pub struct FrameSampler {
    grid: Grid,
    /// From coordinates of the fine grid.
    shift: Vec3,
    values: Vec<Vec4>,
}

/// Gas on a grid, to be recorded.
pub struct FrameGas<'a, V> {
    /// Grid of the gas.
    pub fine: Domain,
    /// Cells that hold gas.
    pub occupied: CellBox,
    /// Smoke and heat of every cell of the grid, in x and y.
    pub gas: &'a [Vec4],
    /// Velocity along x and y of a cell, box widths per second.
    pub velocity: V,
}

impl RecordedFrame {
    pub fn new<V: Fn(UVec3) -> Vec2 + Sync>(frame: &FrameGas<'_, V>, view: &View) -> Self {
        let FrameGas { fine, occupied: cells, gas, velocity } = frame;
        let mut recorded = Self { cells: *cells, values: Vec::new(), extent: Extent::EMPTY };
        if cells.is_empty() {
            return recorded;
        }
        let grid = recorded.grid();
        let mut values = vec![[f16::ZERO; 4]; grid.cells()];
        grid.for_rows(&mut values, |first, row| {
            for (x, value) in (0_u32..).zip(row) {
                let cell = first + UVec3::X * x + cells.low - 1;
                let [smoke, heat, ..] = gas[fine.grid.index(cell)].to_array();
                let velocity = velocity(cell);
                *value = [smoke, heat, velocity.x, velocity.y].map(f16::from_f32);
            }
        });
        recorded.extent = extent(*fine, *cells, gas, view);
        recorded.values = values;
        recorded
    }

    pub fn grid(&self) -> Grid {
        Grid { size: self.cells.high + 1 - self.cells.low }
    }

    /// Returns the frame for sampling, or `None` if it is empty.
    pub fn sampler(&self) -> Option<FrameSampler> {
        (!self.cells.is_empty()).then(|| FrameSampler {
            grid: self.grid(),
            shift: 1.0 - self.cells.low.as_vec3(),
            values: self.values.iter().map(|value| Vec4::from_array(value.map(f32::from))).collect(),
        })
    }
}

impl FrameSampler {
    /// Returns smoke, heat, and velocity along x and y, at a coordinate of the fine grid; 0 outside.
    pub fn sample(&self, coordinate: Vec3) -> Vec4 {
        let at = coordinate + self.shift;
        if at.cmple(Vec3::ZERO).any() || at.cmpge(self.grid.size.as_vec3() + 1.0).any() {
            return Vec4::ZERO;
        }
        self.grid.sample(&self.values, at)
    }
}

/// Density that is seen of gas.
pub fn visible_density(view: &View, smoke: f32, heat: f32) -> f32 {
    smoke + heat * view.flame
}

/// Returns the part of the image in which smoke is visible.
fn extent(fine: Domain, cells: CellBox, gas: &[Vec4], view: &View) -> Extent {
    let least = MIN_COLUMN / fine.cell_width();
    let mut seen = CellBox::EMPTY;
    for y in cells.low.y..=cells.high.y {
        let mut columns = vec![0.0; (cells.high.x + 1 - cells.low.x) as usize];
        for z in cells.low.z..=cells.high.z {
            let row = &gas[fine.grid.index(UVec3::new(cells.low.x, y, z))..];
            for (column, gas) in columns.iter_mut().zip(row) {
                *column += visible_density(view, gas.x, gas.y) * view.extinction;
            }
        }
        for (x, column) in (cells.low.x..).zip(columns) {
            if column > least {
                seen.include(UVec3::new(x, y, 1));
            }
        }
    }
    if seen.is_empty() {
        return Extent::EMPTY;
    }
    let [low, high] = [seen.low.as_vec3() - 0.5, seen.high.as_vec3() + 0.5].map(|at| fine.position(at).truncate());
    Extent { low, high }
}
