//! Simulated smoke and fire: a fluid solver on a grid, its recipes, and bakes of its frames to sprites.
//!
//! Stam, "Stable fluids" (1999), with vorticity confinement (Fedkiw, Stam and Jensen, "Visual simulation of smoke",
//! 2001) and MacCormack advection (Selle et al., "An unconditionally stable MacCormack method", 2008). Uses only plain
//! arithmetic in a fixed order, so that bakes are bit-identical on every machine and with any number of threads.

mod advection;
mod bake;
mod checkpoint;
mod domain;
mod fluid;
mod forces;
mod framing;
mod grid;
mod moment;
mod pressure;
mod recorded_frame;
mod sim_recipe;
mod simulate;
mod source;
mod sources;
mod volume_files;

pub use bake::{BakedRecording, Recording};
pub use moment::Moment;
pub use sim_recipe::{FrameLoop, Framing, GridSize, Obstacle, Physics, RECIPE_VERSION, SimRecipe, TimeSpan, View};
pub use simulate::Simulation;
pub use source::{Source, SourceShape};
pub use volume_files::{VolumeOptions, VolumeRecording, VolumeSequence};

#[cfg(test)]
mod tests;
