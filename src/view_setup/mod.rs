//! Device-independent data of a frame: the placement of systems and sprites in the view, and the uniforms that both
//! renderers read.

mod attachment_role;
mod optical_depth;
mod particle_sort;
mod projected_bounds;
mod smoke_extent;
mod sprite_projector;
mod system_setup;
mod view_geometry;
mod view_lights;

pub use attachment_role::{AttachmentRole, AttachmentSet, MAX_TARGET_ATTACHMENTS};
pub use optical_depth::optical_depth;
pub use particle_sort::{SortScratch, write_in_drawing_order};
pub use sprite_projector::{ProjectedSprite, SpriteProjector, SpriteTrim, TexelGrid};
pub use system_setup::{SystemInput, SystemSetup, system_setup};
pub use view_geometry::ViewGeometry;
pub use view_lights::light_uniforms;
