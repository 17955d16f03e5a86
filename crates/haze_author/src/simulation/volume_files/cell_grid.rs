//! Grid of cells around the smoke of all frames, and the smoke of a frame in its cells.

use glam::{DVec3, UVec3, Vec2, Vec4};
use haze_preset::UpAxis;

use super::super::domain::Domain;
use super::super::grid::{CellBox, Grid};
use super::super::recorded_frame::{FrameGas, RecordedFrame};
use super::super::sim_recipe::View;
use super::frame_grids::FrameVolumes;
use super::heat_scale::HeatScale;
use crate::vdb::{GridTransform, Sampler, SparseGrid};

/// Smoke and heat below this are taken as none, as in simulations.
const MIN_GAS: f32 = 1.0e-3;
/// Most samples along a side of a cell. Interpolation makes each the mean of two voxels, so that cells of 8 voxels are
/// exact means.
const MAX_SAMPLES: u32 = 4;
/// Empty cells around the smoke.
const MARGIN: i64 = 1;
/// Most memory of all recorded frames, bytes.
const MAX_BYTES: u64 = 2 << 30;
/// Bytes of a recorded cell.
const BYTES_PER_CELL: u64 = 8;

/// Axes of files: haze has x right, y up, z towards the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes(pub UpAxis);

impl Axes {
    pub fn to_haze(self, vector: DVec3) -> DVec3 {
        match self.0 {
            UpAxis::Y => vector,
            // Seen along y, as Blender's front view.
            UpAxis::Z => DVec3::new(vector.x, vector.z, -vector.y),
        }
    }

    pub fn to_file(self, vector: DVec3) -> DVec3 {
        match self.0 {
            UpAxis::Y => vector,
            UpAxis::Z => DVec3::new(vector.x, -vector.z, vector.y),
        }
    }
}

/// Box of positions with haze's axes, units of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Returns the box around all values of a grid above a value.
    pub fn of_grid(grid: &SparseGrid<1>, above: f32, axes: Axes) -> Self {
        let Some(voxels) = grid.bounds(above) else { return Self::EMPTY };
        let [one, other] = voxels.map(|voxel| axes.to_haze(grid.transform.position(voxel.as_dvec3())));
        let half = grid.transform.voxel * 0.5;
        Self { low: one.min(other) - half, high: one.max(other) + half }
    }
}

/// Cells that all frames are sampled on: cubes of whole voxels of the first frame.
#[derive(Clone, Copy)]
pub struct CellGrid {
    pub domain: Domain,
    axes: Axes,
    /// Positions of voxels.
    transform: GridTransform,
    /// First voxel of the first cell, with haze's axes.
    first: DVec3,
    /// Voxels along a side of a cell.
    pub voxels_per_cell: u32,
}

/// Scales of the values of all frames.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Density that becomes 1.
    pub density: f32,
    pub heat: HeatScale,
}

impl CellGrid {
    /// Returns the finest grid around a box that has at most `resolution` cells along each side, and whose `frames` do
    /// not take too much memory. `transform`: positions of the voxels of the first frame.
    pub fn new(bounds: Bounds, transform: GridTransform, axes: Axes, resolution: u32, frames: u32) -> Self {
        let offset = axes.to_haze(transform.offset);
        // Nearest voxels, because the sides of a voxel are not exact.
        let voxel = |position: DVec3| ((position - offset) / transform.voxel).round();
        let low = voxel(bounds.low + transform.voxel * 0.5);
        let voxels = (voxel(bounds.high - transform.voxel * 0.5) - low + 1.0).max(DVec3::ONE);
        let cells = |per_cell: f64| (voxels / per_cell).ceil() + 2.0 * MARGIN as f64;
        let is_small = |per_cell: f64| {
            let cells = cells(per_cell);
            let bytes = cells.element_product() * f64::from(frames) * BYTES_PER_CELL as f64;
            cells.max_element() <= f64::from(resolution) && bytes <= MAX_BYTES as f64
        };
        let longest = voxels.max_element();
        let mut per_cell = (longest / f64::from(resolution)).floor().max(1.0);
        while per_cell < longest && !is_small(per_cell) {
            // By a factor too, because a large number does not grow by 1.
            per_cell = (per_cell * 1.02).floor().max(per_cell + 1.0);
        }
        let size = cells(per_cell).min(DVec3::splat(f64::from(resolution))).as_uvec3();
        Self {
            domain: Domain { grid: Grid { size } },
            axes,
            transform,
            first: low - per_cell * MARGIN as f64,
            voxels_per_cell: per_cell as u32,
        }
    }

    /// Side of a cell, units of the file.
    fn cell_side(&self) -> f64 {
        self.transform.voxel * f64::from(self.voxels_per_cell)
    }

    /// Samples a frame.
    pub fn record(&self, frame: &FrameVolumes, scales: Scales, view: &View) -> RecordedFrame {
        let grid = self.domain.grid;
        let mut gas = vec![Vec4::ZERO; grid.cells()];
        let box_width = self.cell_side() * f64::from(grid.size.x);
        grid.for_rows(&mut gas, |first, row| {
            let mut density = frame.density.sampler();
            let mut heat = frame.heat.as_ref().map(|heat| (heat, heat.sampler()));
            let mut velocity = frame.velocity_sampler();
            for (x, gas) in (0_u32..).zip(row) {
                let center = self.center(first + UVec3::X * x);
                let smoke = self.mean(&frame.density, &mut density, center) / scales.density;
                let heat = heat.as_mut().map(|(grid, sampler)| self.mean(grid, sampler, center));
                let heat = heat.map_or(0.0, |heat| scales.heat.heat(heat));
                if smoke < MIN_GAS && heat < MIN_GAS {
                    continue;
                }
                let velocity = self.axes.to_haze(velocity.sample(self.position(center))) / box_width;
                *gas = Vec4::new(smoke.max(0.0), heat, velocity.x as f32, velocity.y as f32);
            }
        });
        let all = CellBox { low: UVec3::ONE, high: grid.size };
        let occupied = grid.occupied(all, |index| gas[index].x.max(gas[index].y) > 0.0);
        let velocity = |cell: UVec3| {
            let [_, _, x, y] = gas[grid.index(cell)].to_array();
            Vec2::new(x, y)
        };
        RecordedFrame::new(&FrameGas { fine: self.domain, occupied, gas: &gas, velocity }, view)
    }

    /// Center of a cell in voxels of the first frame, with haze's axes.
    fn center(&self, cell: UVec3) -> DVec3 {
        let side = f64::from(self.voxels_per_cell);
        self.first + (cell.as_dvec3() - 1.0) * side + (side - 1.0) * 0.5
    }

    /// Position of a coordinate in voxels of the first frame, units and axes of the file.
    fn position(&self, voxel: DVec3) -> DVec3 {
        self.transform.position(self.axes.to_file(voxel))
    }

    /// Returns the mean of a grid over the cell around a coordinate.
    fn mean(&self, grid: &SparseGrid<1>, sampler: &mut Sampler<'_, 1>, center: DVec3) -> f32 {
        let samples = self.voxels_per_cell.min(MAX_SAMPLES);
        let side = f64::from(self.voxels_per_cell);
        let offset = |sample: u32| (f64::from(sample) + 0.5) * side / f64::from(samples) - side * 0.5;
        let mut sum = 0.0;
        for index in 0..samples.pow(3) {
            let sample = UVec3::new(index % samples, index / samples % samples, index / (samples * samples));
            let voxel = center + DVec3::new(offset(sample.x), offset(sample.y), offset(sample.z));
            let [value] = sampler.sample(grid.transform.index(self.position(voxel)));
            sum += value;
        }
        sum / samples.pow(3) as f32
    }
}
