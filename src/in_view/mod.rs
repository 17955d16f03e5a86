//! What is derived from a frame without a device: where things stand in the view, in uniforms that both renderers read.

mod bounds;
mod in_front;
mod lights;
mod middle;
mod order;
mod sprites;
mod system;
mod view;

pub use in_front::optical_depth;
pub use lights::lights_in_view;
pub use order::{SortScratch, in_order};
pub use sprites::{Grid, Pictures, Placing, SpriteInView};
pub use system::{SystemInView, SystemInWorld, system_in_view};
pub use view::ViewGeometry;
