//! Runs a recipe, and records its frames.

use glam::{UVec3, Vec2};
use haze_core::error::FieldError;

use super::bake::Recording;
use super::fluid::Fluid;
use super::framing::Window;
use super::moment::Moment;
use super::recorded_frame::{Extent, FrameGas, RecordedFrame};
use super::sim_recipe::SimRecipe;

impl SimRecipe {
    /// Returns the number of moments that are simulated for the sheet.
    pub fn moment_count(&self) -> u32 {
        let frames = self.sheet.frame_count();
        frames + self.time.frame_loop.blended_frames(frames, self.time.blend)
    }

    /// Simulates all frames. `progress` is called with the number of finished moments, of [`Self::moment_count`]; an
    /// error from it cancels the simulation.
    ///
    /// # Errors
    /// The first field of the recipe that is not valid, or the error of `progress`.
    pub fn simulate<E: From<FieldError>>(&self, progress: impl Fn(u32) -> Result<(), E>) -> Result<Recording, E> {
        self.simulate_moments(progress, |_| Ok(()))
    }

    /// Simulates all frames, as [`Self::simulate`], and calls `each` with every moment; an error from it cancels the
    /// simulation.
    ///
    /// # Errors
    /// As [`Self::simulate`], and those of `each`.
    pub fn simulate_moments<E: From<FieldError>>(
        &self,
        progress: impl Fn(u32) -> Result<(), E>,
        mut each: impl FnMut(&Moment<'_>) -> Result<(), E>,
    ) -> Result<Recording, E> {
        self.validate()?;
        let mut fluid = Fluid::new(self);
        let step = self.seconds_per_frame();
        progress(0)?;
        // The warm-up in steps of about a frame, so that sources begin and end on time.
        let steps = (self.time.warm_up / step).ceil().min(1.0e4) as u32;
        for _ in 0..steps {
            fluid.advance(self.time.warm_up / steps as f32);
            progress(0)?;
        }
        let mut frames = Vec::new();
        for number in 1..=self.moment_count() {
            fluid.advance(step);
            frames.push(RecordedFrame::new(&fluid.frame_gas(), &self.view));
            each(&Moment { fluid: &fluid, number, has_heat: self.burns() })?;
            progress(number)?;
        }
        let extent = frames.iter().map(|frame| frame.extent).fold(Extent::EMPTY, Extent::union);
        Ok(Recording {
            sheet: self.sheet,
            view: self.view.clone(),
            frames,
            seconds_per_frame: step,
            has_velocity: true,
            has_heat: self.burns(),
            fine: fluid.fine,
            window: Window::new(&self.view, fluid.domain, self.grid.ground, extent),
        })
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
