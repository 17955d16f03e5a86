//! Reads sheets of smoke of any origin: finds out how they are coded, mends what is missing, and builds the images that haze
//! draws with.
//!
//! Each question has a file, and is a search with a score that follows from physics: `grid`, `frame_order`, `color`,
//! `six_way`, `motion`, `playback`. Answers have a confidence, and each can be given instead.

mod answer;
mod assemble;
mod color;
mod depth;
mod file_name;
mod fill;
mod find_roles;
mod frame_grid;
mod frame_order;
mod grid;
mod motion;
mod options;
mod playback;
mod report;
mod role;
mod sheet_file;
mod side;
mod six_way;
mod small_frames;
mod sources;

pub use answer::{Answer, Observation, SURE};
pub use assemble::ReadSprite;
pub use color::{AlphaMode, CodeSpace, ColorCode};
pub use depth::DepthWhite;
pub use frame_grid::{FrameGrid, FrameOrder};
pub use motion::{Direction, MotionAxes};
pub use options::{ReadOptions, SecondAlpha};
pub use playback::Playback;
pub use report::SheetAnswers;
pub use role::Role;
pub use sheet_file::SheetFile;
pub use side::Side;
pub use six_way::SideOrder;
pub use sources::{MAX_FILES, SheetReading, read_sheets};

#[cfg(test)]
mod tests;
