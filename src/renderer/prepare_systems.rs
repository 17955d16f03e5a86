//! First part of a frame: systems, and the passes that do not read the scene's depth.

use haze_core::error::{FieldError, PrepareError};
use haze_core::formula::shadow::SHADOWED_LIGHTS;
use haze_core::glam::Vec3;
use haze_core::view_setup::{SmokeShadow, ViewGeometry};

use super::frame_context::FrameContext;
use super::gpu::frame_encoder::FrameEncoder;
use super::resolved_depth::ResolvedDepth;
use super::system::SystemState;
use super::validate_frame::{host_size, validate};
use super::{Renderer, VisibleSystem};
use crate::frame::{FrameInput, SceneDepth};

impl Renderer {
    /// Prepares all systems, and records the passes that do not read the scene's depth.
    pub(super) fn prepare_systems(
        &mut self,
        encoder: &mut FrameEncoder<'_>,
        frame: &FrameInput<'_>,
    ) -> Result<(), PrepareError> {
        self.order.clear();
        self.view = None;
        self.validate_submitted()?;
        let context = self.context.clone();
        let shared = context.shared();
        let gpu = shared.gpu();
        let view = ViewGeometry::new(&frame.view)?;
        validate(shared, &self.host, frame)?;
        // The passes read a single-sampled depth instead of a multisampled one.
        self.resolved_depth = match frame.scene_depth {
            SceneDepth::Multisampled(samples) => {
                Some(ResolvedDepth::ensure(self.resolved_depth.take(), shared, samples)?)
            }
            _ => None,
        };
        let resolved = self.resolved_depth.as_ref().map(|resolved| resolved.target.clone());
        let scene_depth = resolved.as_ref().map_or(frame.scene_depth, SceneDepth::Buffer);
        let frame = &FrameInput { scene_depth, ..*frame };
        let inputs = self.pipeline_inputs(&view, frame.scene_depth.kind(), frame.debug_views);
        // Bind group 0 of every system: view and scene depth.
        self.bindings.write(shared, &view, &frame.scene_depth)?;
        self.sync_system_states(frame);
        self.submission.track(encoder.commands());
        let timing = self.timing.as_ref();
        self.timed_frame = timing.map(|timing| timing.register_prepare(self.timed_frame));

        // Measures all systems: their smoke shades each other.
        let states = &mut self.states;
        let measured = frame.systems.iter().filter_map(|system| {
            let state = states.iter_mut().find(|state| state.key == system.key)?;
            Some(state.measure_box(shared, &view, system))
        });
        let is_mapped = |light| frame.shadow_maps.iter().any(|map| map.projection.light == light);
        let shadow = SmokeShadow::new(
            &view,
            frame.up.normalize_or(Vec3::Y),
            shared.max_volume_depth,
            frame.lights,
            is_mapped,
            measured,
        );
        self.shadowed_lights = shadow.map_or([None; SHADOWED_LIGHTS], |shadow| shadow.lights);
        // Places and clears the density grid around all systems, if any system receives shadow.
        match &shared.pipelines.tiled {
            Some(tiled) => self.shadow_volume.write(&gpu, tiled, shadow.as_ref(), frame.shadow_maps),
            None => self.sliced_shadow.write(shared, shadow.as_ref(), frame.shadow_maps),
        }
        let of_frame = |shadow| self.shadow_volume.of_frame(shadow).or_else(|| self.sliced_shadow.of_frame(shadow));
        let grid = shadow.as_ref().and_then(of_frame);
        if grid.is_some() {
            self.shadow_volume.clear(encoder.commands());
        }
        self.scene_shadow.write(shared, frame, grid);
        if self.screen_shadow.write(shared, frame, &view, shadow.as_ref().filter(|_| grid.is_some())) {
            shared.pipelines.drawn.screen_shadow.check(self.scene_pass)?;
        }
        let host_size = host_size(frame);
        let bindings = &self.bindings;
        let context =
            FrameContext { gpu, shared, frame, view: &view, host_size, inputs: &inputs, bindings, shadow: grid };
        for system in frame.systems {
            let Some(index) = self.states.iter().position(|state| state.key == system.key) else { continue };
            let state = &mut self.states[index];
            // Computes the placement in the view; uploads lights, settings and sorted particles.
            state.write(&context, system);
            if let (Some(timing), Some(choice)) = (timing, state.choice()) {
                timing.add_choice(system.key, choice);
            }
            // A system out of sight casts shadow, and no more.
            if state.passes().is_some() {
                self.order.push(VisibleSystem { state: index, draw_order: state.draw_order() });
            }
            // Copies the number of a host's particles, if only the GPU knows it.
            if let Some(copy) = state.alive() {
                copy.record(encoder.commands());
            }
            // Clears the counters of the lists of tiles.
            if let Some(tiled) = state.tiled_passes() {
                tiled.clear_counters(encoder.commands());
            }
        }
        for state in &self.states {
            // Measures a host's particles, which the CPU cannot read.
            if let Some(pass) = state.measure() {
                pass.record(encoder);
            }
            // Evaluates an emitter's particles, or sorts a host's particles back to front.
            if let Some(pass) = state.particle_pass() {
                pass.record(encoder);
            }
            // Adds the sprites to the density grid.
            if let Some(pass) = state.splat() {
                pass.record(encoder);
            }
        }
        // Marches from the cells of the density grid to the lights; looks up the host's shadow maps.
        match (&shadow, &shared.pipelines.tiled) {
            (Some(shadow), Some(tiled)) => {
                if let Some(pass) = self.shadow_volume.look_up(tiled, shadow) {
                    pass.record(encoder);
                }
                if let Some(pass) = self.shadow_volume.march(tiled, shadow) {
                    pass.record(encoder);
                }
            }
            // Without compute shaders, the CPU adds the sprites to the grid.
            (Some(shadow), None) => {
                let states = &self.states;
                let cast = frame
                    .systems
                    .iter()
                    .filter_map(|system| states.iter().find(|state| state.key == system.key)?.cast(system.particles));
                cast.for_each(|(system, particles)| self.sliced_shadow.add(shadow, system, particles));
                for pass in self.sliced_shadow.march(shared, shadow) {
                    pass.record(encoder);
                }
            }
            (None, _) => {}
        }
        self.view = Some(view);
        Ok(())
    }

    /// Refuses a second `prepare` before the commands of the first are submitted or dropped: those commands read the
    /// buffers that this call would overwrite.
    fn validate_submitted(&self) -> Result<(), FieldError> {
        if !self.submission.is_outstanding() {
            return Ok(());
        }
        let problem = "called again before the commands of the first call were submitted or dropped";
        let expected = "one renderer per view of a submission; renderers that share a Context are cheap";
        Err(FieldError::from_problem("prepare", problem, expected))
    }

    /// Keeps one state per system of the frame, found by its key. Drops states whose system has been absent for more
    /// than 120 frames.
    fn sync_system_states(&mut self, frame: &FrameInput<'_>) {
        let is_missing = |state: &SystemState| !frame.systems.iter().any(|system| system.key == state.key);
        self.states.retain_mut(|state| {
            let is_missing = is_missing(state);
            !state.tick_absence(is_missing)
        });
        for system in frame.systems {
            if !self.states.iter().any(|state| state.key == system.key) {
                self.states.push(SystemState::new(system.key, self.context.shared()));
            }
        }
    }
}
