//! Choice of the accumulation path for `auto`: workload, cost model and decision.

mod path_choice;
mod path_model;
mod workload;

pub use path_choice::{PathChoice, PathReason};
pub use path_model::{PathCosts, PathModel, PathModelSource};
pub use workload::PathWorkload;

pub(crate) use path_choice::PathChooser;
pub(crate) use workload::estimate_workload;
