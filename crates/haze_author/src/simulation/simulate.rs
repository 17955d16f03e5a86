//! Runs a recipe, and records its frames.

use glam::{UVec3, Vec2};
use haze_core::error::FieldError;

use super::bake::Recording;
use super::fluid::Fluid;
use super::framing::Window;
use super::moment::Moment;
use super::recorded_frame::{Extent, FrameGas, RecordedFrame};
use super::sim_recipe::SimRecipe;

/// A simulation under way: first the steps of the warm-up, then the moments of the sheet.
pub struct Simulation<'a> {
    pub(super) recipe: &'a SimRecipe,
    pub(super) fluid: Fluid<'a>,
    /// Number of finished steps of the warm-up.
    pub(super) warm_up_steps: u32,
    /// Finished moments.
    pub(super) frames: Vec<RecordedFrame>,
}

impl<'a> Simulation<'a> {
    /// Starts a simulation.
    ///
    /// # Errors
    /// The first field of the recipe that is not valid.
    pub fn new(recipe: &'a SimRecipe) -> Result<Self, FieldError> {
        recipe.validate()?;
        Ok(Self { recipe, fluid: Fluid::new(recipe), warm_up_steps: 0, frames: Vec::new() })
    }

    /// Returns the number of finished moments, of [`SimRecipe::moment_count`].
    pub fn finished_moments(&self) -> u32 {
        self.frames.len() as u32
    }

    /// Advances by a step of the warm-up, which returns `None`, or to the next moment.
    pub fn advance(&mut self) -> Option<Moment<'_>> {
        let step = self.recipe.seconds_per_frame();
        // In steps of about a frame, so that sources begin and end on time.
        let warm_up = self.recipe.time.warm_up;
        let steps = (warm_up / step).ceil().min(1.0e4) as u32;
        if self.warm_up_steps < steps {
            self.fluid.advance(warm_up / steps as f32);
            self.warm_up_steps += 1;
            return None;
        }
        self.fluid.advance(step);
        self.frames.push(RecordedFrame::new(&self.fluid.frame_gas(), &self.recipe.view));
        Some(Moment { fluid: &self.fluid, number: self.finished_moments(), has_heat: self.recipe.burns() })
    }

    /// Simulates the moments that are left, and returns all, framed.
    pub fn finish(mut self) -> Recording {
        while self.finished_moments() < self.recipe.moment_count() {
            self.advance();
        }
        self.into_recording()
    }

    /// Returns the finished moments, framed.
    pub fn into_recording(self) -> Recording {
        let Self { recipe, fluid, frames, .. } = self;
        let extent = frames.iter().map(|frame| frame.extent).fold(Extent::EMPTY, Extent::union);
        Recording {
            sheet: recipe.sheet,
            view: recipe.view.clone(),
            frames,
            seconds_per_frame: recipe.seconds_per_frame(),
            has_velocity: true,
            has_heat: recipe.burns(),
            fine: fluid.fine,
            window: Window::new(&recipe.view, fluid.domain, recipe.grid.ground, extent),
        }
    }
}

impl SimRecipe {
    /// Returns the number of moments that are simulated for the sheet.
    pub fn moment_count(&self) -> u32 {
        let frames = self.sheet.frame_count();
        frames + self.time.frame_loop.blended_frames(frames, self.time.blend)
    }

    /// Time between frames, seconds.
    pub fn seconds_per_frame(&self) -> f32 {
        self.time.duration / self.sheet.frame_count() as f32
    }
}

impl Fluid<'_> {
    /// Returns the gas, to be recorded.
    fn frame_gas(&self) -> FrameGas<'_, impl Fn(UVec3) -> Vec2 + Sync> {
        let velocity = |cell: UVec3| {
            let position = self.fine.position(cell.as_vec3());
            let velocity = self.domain.grid.sample(&self.centered, self.domain.coordinate(position));
            velocity.truncate().truncate()
        };
        FrameGas { fine: self.fine, occupied: self.occupied, gas: &self.gas, velocity }
    }
}
