//! Which way to accumulate the path `auto` takes, and why.

mod choice;
mod load;
mod model;

pub use choice::{PathChoice, PathReason};
pub use load::PathLoad;
pub use model::{PathCosts, PathModel, PathModelSource};

pub(crate) use choice::Chooser;
pub(crate) use load::load;
