//! Paths of an emitter's particles that are kept from frame to frame.

use std::collections::VecDeque;

use glam::{IVec3, Vec3};

use super::particle::Particle;
use crate::formula::emitter::{EmittedParticle, emitted_particle_on};
use crate::formula::flow::FlowStep;
use crate::formula::uniforms::EmitterUniform;

/// Steps of each particle of an emitter on its way through the flow, for
/// [`EmitterSnapshot::evaluate_along`](super::EmitterSnapshot::evaluate_along): evaluating the next frame takes a fraction of
/// the time of evaluating any. One for each emitter, and for each of all particles and a sample.
#[derive(Clone, Debug, Default)]
pub struct EmitterPaths {
    /// The emitter without its time. The paths of another one are dropped.
    emitter: EmitterUniform,
    /// Index of the first birth, and number of births from one path to the next.
    first: u32,
    step: u32,
    reached: VecDeque<FlowStep>,
}

impl EmitterPaths {
    /// Replaces `particles` with those of every `step`th birth from number `first` on that are alive.
    pub(super) fn write(&mut self, emitter: &EmitterUniform, first: u32, step: u32, particles: &mut Vec<Particle>) {
        // The step of a snapshot is public.
        let step = step.max(1);
        let index = emitter.first.wrapping_add(first);
        let passed = index.wrapping_sub(self.first);
        let is_same = self.emitter == without_time(emitter) && self.step == step && passed.is_multiple_of(step);
        let gone = (passed / step) as usize;
        if is_same && gone <= self.reached.len() {
            self.reached.drain(..gone);
        } else {
            self.reached.clear();
        }
        self.emitter = without_time(emitter);
        self.first = index;
        self.step = step;
        let count = emitter.count.saturating_sub(first).div_ceil(step) as usize;
        self.reached.resize(count, FlowStep::default());
        particles.clear();
        let numbers = (first..emitter.count).step_by(step as usize);
        particles.extend(
            numbers
                .zip(&mut self.reached)
                .filter_map(|(number, reached)| visible_particle(emitted_particle_on(emitter, number, reached))),
        );
    }
}

/// Particles that are not alive have an amount of 0 and no position. They are dropped, as are those that have faded out.
fn visible_particle(emitted: EmittedParticle) -> Option<Particle> {
    let [rotation, amount, frame, age] = emitted.rotation_amount_frame_age.to_array();
    let [r, g, b, heat] = emitted.tint_heat;
    (amount > 0.0).then_some(Particle {
        position: emitted.position_radius.truncate(),
        radius: emitted.position_radius.w,
        rotation,
        amount,
        frame,
        age,
        velocity: emitted.velocity,
        tint: [r, g, b],
        heat,
    })
}

fn without_time(emitter: &EmitterUniform) -> EmitterUniform {
    EmitterUniform {
        first: 0,
        count: 0,
        since_first: 0.0,
        first_in_pulse: 0,
        swirl_turn: 0.0,
        swirl_offset: Vec3::ZERO,
        swirl_first: IVec3::ZERO,
        ring_phase: 0.0,
        ring_first: 0,
        ..*emitter
    }
}
