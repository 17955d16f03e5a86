//! State of a simulation, and one step of it.

use glam::{UVec3, Vec4};

use super::advection::Flow;
use super::domain::Domain;
use super::forces::{accelerate_faces, accelerations, center_velocities};
use super::grid::{CellBox, Grid};
use super::pressure::PressureSolver;
use super::sim_recipe::SimRecipe;
use super::source::Source;
use super::sources::Emission;

/// Largest distance that gas moves in one step, cells of the velocity. MacCormack's method is stable beyond, but less
/// accurate.
const MAX_CELLS_PER_STEP: f32 = 2.0;
/// Most steps between two frames: bounds the time of a simulation that explodes.
const MAX_STEPS: u32 = 16;
/// Gas below this is taken as none.
const MIN_GAS: f32 = 1.0e-3;

/// Velocity and gas of a simulation.
pub struct Fluid<'a> {
    recipe: &'a SimRecipe,
    pub domain: Domain,
    /// Grid of the gas.
    pub fine: Domain,
    /// Velocity on the faces below each cell along x, y and z, box widths per second.
    pub velocity: [Vec<f32>; 3],
    /// Velocity at the centers of cells, without divergence.
    pub centered: Vec<Vec4>,
    /// Smoke, heat and fuel of the cells of the fine grid.
    pub gas: Vec<Vec4>,
    /// Cells of the fine grid that hold gas.
    pub occupied: CellBox,
    pub solver: PressureSolver,
    pub time: f32,
}

impl<'a> Fluid<'a> {
    pub fn new(recipe: &'a SimRecipe) -> Self {
        let grid = Grid { size: recipe.cells() };
        let domain = Domain { grid };
        let fine = Domain { grid: Grid { size: grid.size * recipe.grid.detail } };
        let velocity = recipe.physics.wind.to_array().map(|wind| vec![wind; grid.cells()]);
        Self {
            recipe,
            domain,
            fine,
            centered: center_velocities(domain, &velocity),
            velocity,
            gas: vec![Vec4::ZERO; fine.grid.cells()],
            occupied: CellBox::EMPTY,
            solver: PressureSolver::new(grid, open_faces(recipe, domain)),
            time: 0.0,
        }
    }

    /// Advances by `seconds`, in as many steps as the velocity needs.
    pub fn advance(&mut self, seconds: f32) {
        let end = self.time + seconds;
        for left in (1..=MAX_STEPS).rev() {
            let rest = end - self.time;
            let cells = self.cells_per_second() * rest;
            let steps = ((cells / MAX_CELLS_PER_STEP).ceil()).clamp(1.0, left as f32);
            if steps <= 1.0 {
                self.step(rest);
                break;
            }
            self.step(rest / steps);
        }
        self.time = end;
    }

    /// Speed of the fastest gas, and of the sources that emit.
    fn cells_per_second(&self) -> f32 {
        let fastest = self.velocity.iter().flatten().fold(0.0_f32, |fastest, speed| fastest.max(speed.abs()));
        let emitted = |source: &Source| source.velocity.abs().max_element().max(source.spread.abs());
        let emits = |source: &&Source| source.start <= self.time && self.time < source.end;
        let sources = self.recipe.sources.iter().filter(emits).map(emitted).fold(0.0, f32::max);
        fastest.max(sources) / self.domain.cell_width()
    }

    fn step(&mut self, step: f32) {
        let physics = &self.recipe.physics;
        self.emit(step);
        self.react(step);
        let gas = self.coarse_gas();
        // Burned fuel expands: the sum of the velocities on the faces of a cell.
        let scale = physics.burn_expansion / step * self.domain.cell_width();
        let expansion: Vec<_> = gas.iter().map(|gas| gas.w * scale).collect();
        let accelerations = accelerations(self.domain, physics, self.time, &gas, &self.centered);
        let keep = 1.0 / (1.0 + physics.drag * step);
        for (axis, faces) in self.velocity.iter_mut().enumerate() {
            accelerate_faces(self.domain, axis, &accelerations, step, keep, faces);
        }
        self.solver.project(&mut self.velocity, &expansion);
        for (axis, faces) in self.velocity.iter_mut().enumerate() {
            self.domain.grid.extend_to_ghosts(faces, Some(axis));
        }
        self.centered = center_velocities(self.domain, &self.velocity);
        self.advect(step);
        self.time += step;
    }

    /// Fills the sources that emit.
    fn emit(&mut self, step: f32) {
        for source in &self.recipe.sources {
            if let Some(emission) = Emission::new(source, self.time, step, self.domain.cell_width()) {
                emission.fill(self.fine, &mut self.gas);
                self.occupied = self.occupied.union(emission.cells(self.fine));
                for (axis, faces) in self.velocity.iter_mut().enumerate() {
                    emission.push(self.domain, axis, faces);
                }
            }
        }
    }

    /// Burns fuel, cools, and thins smoke.
    fn react(&mut self, step: f32) {
        let physics = &self.recipe.physics;
        let fine = self.fine;
        let keep_heat = 1.0 / (1.0 + physics.cooling * step);
        let keep_smoke = 1.0 / (1.0 + physics.dissipation * step);
        let obstacle = &self.recipe.obstacle;
        fine.grid.for_rows_within(self.occupied, &mut self.gas, |cell, row| {
            for (x, gas) in (0_u32..).zip(row) {
                let [smoke, heat, fuel, _] = gas.to_array();
                let burned = fuel.min(physics.burn_rate * step);
                let smoke = (smoke + burned * physics.burn_smoke) * keep_smoke - physics.erosion * step;
                let heat = (heat + burned * physics.burn_heat) * keep_heat;
                // The last number is what burned, until it is advected.
                *gas = Vec4::new(smoke.max(0.0), heat, fuel - burned, burned);
                if let Some(obstacle) = obstacle
                    && obstacle.contains(fine.position((cell + UVec3::X * x).as_vec3()))
                {
                    *gas = Vec4::ZERO;
                }
            }
        });
    }

    /// Returns the mean gas of each cell of the velocity.
    fn coarse_gas(&self) -> Vec<Vec4> {
        let detail = self.recipe.grid.detail;
        let grid = self.domain.grid;
        let mut coarse = vec![Vec4::ZERO; grid.cells()];
        let fraction = 1.0 / detail.pow(3) as f32;
        grid.for_rows(&mut coarse, |first, row| {
            for (x, mean) in (0_u32..).zip(row) {
                let corner = (first + UVec3::X * x - 1) * detail + 1;
                for index in 0..detail.pow(3) {
                    let offset = UVec3::new(index % detail, index / detail % detail, index / (detail * detail));
                    *mean += self.gas[self.fine.grid.index(corner + offset)] * fraction;
                }
            }
        });
        coarse
    }

    fn advect(&mut self, step: f32) {
        let grid = self.domain.grid;
        let cells_per_step = step / self.domain.cell_width();
        if self.recipe.grid.ground {
            self.copy_to_ground();
        }
        let flow = Flow::new(grid, &self.centered, cells_per_step);
        let reach = (flow.longest() * self.recipe.grid.detail as f32).min(4096.0).ceil() as u32 + 2;
        let cells = self.occupied.grown(reach, self.fine.grid);
        self.gas = flow.advect_cells(&self.gas, self.fine.grid, cells);
        self.velocity = [0, 1, 2].map(|axis| flow.advect_faces(&self.velocity[axis], axis));
        let gas = &self.gas;
        self.occupied = self.fine.grid.occupied(cells, |index| gas[index].truncate().max_element() > MIN_GAS);
        // Traces elsewhere would never end.
        let occupied = self.occupied;
        self.fine.grid.for_rows_within(cells, &mut self.gas, |cell, row| {
            for (x, gas) in (0_u32..).zip(row) {
                let cell = cell + UVec3::X * x;
                if cell.cmplt(occupied.low).any() || cell.cmpgt(occupied.high).any() {
                    *gas = Vec4::ZERO;
                }
            }
        });
    }

    /// Gives the ghosts below the ground the gas above, so that none is lost to clear air there.
    fn copy_to_ground(&mut self) {
        let grid = self.fine.grid;
        let row = grid.strides()[1];
        for z in 0..grid.size.z + 2 {
            let start = grid.index(UVec3::new(0, 0, z));
            self.gas.copy_within(start + row..start + 2 * row, start);
        }
    }
}

/// Returns the openness of the faces below each cell: closed around the obstacle and on the ground.
fn open_faces(recipe: &SimRecipe, domain: Domain) -> [Vec<f32>; 3] {
    let grid = domain.grid;
    let is_solid = |cell: UVec3| {
        let is_below = recipe.grid.ground && cell.y == 0;
        let position = domain.position(cell.as_vec3());
        is_below || recipe.obstacle.as_ref().is_some_and(|obstacle| obstacle.contains(position))
    };
    [0, 1, 2].map(|axis| {
        let mut open = vec![0.0; grid.cells()];
        grid.for_rows_within(grid.faces(axis), &mut open, |first, row| {
            for (x, open) in (0_u32..).zip(row) {
                let cell = first + UVec3::X * x;
                let mut below = cell;
                below[axis] -= 1;
                *open = if is_solid(cell) || is_solid(below) { 0.0 } else { 1.0 };
            }
        });
        open
    })
}
