//! One particle system in a renderer: its buffers, its targets, and its passes of the current frame.

mod alive_copy;
mod instances;
mod particles;
mod passes;
mod state;
mod targets;

pub(crate) use passes::SystemPasses;
pub(crate) use state::SystemState;
