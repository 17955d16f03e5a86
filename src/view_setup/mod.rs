//! Device-independent data of a frame: the placement of systems and sprites in the view, and the uniforms that both
//! renderers read.

mod bounds;
mod lights;
mod optical_depth;
mod order;
mod smoke_extent;
mod sprites;
mod system;
mod view;

pub use lights::light_uniforms;
pub use optical_depth::optical_depth;
pub use order::{SortScratch, in_order};
pub use sprites::{Grid, ProjectedSprite, SpriteProjector, SpriteTrim};
pub use system::{SystemInput, SystemSetup, system_setup};
pub use view::ViewGeometry;
