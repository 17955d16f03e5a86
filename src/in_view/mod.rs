//! Device-independent data of a frame: the placement of systems and sprites in the view, and the uniforms that both
//! renderers read.

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
