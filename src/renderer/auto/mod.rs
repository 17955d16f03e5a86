//! Choice of the accumulation path for `auto`: workload, cost model and decision.

mod choice;
mod load;
mod model;

pub use choice::{PathChoice, PathReason};
pub use load::PathWorkload;
pub use model::{PathCosts, PathModel, PathModelSource};

pub(crate) use choice::Chooser;
pub(crate) use load::load;
