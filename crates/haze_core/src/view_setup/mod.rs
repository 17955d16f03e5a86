//! Device-independent data of a frame: the placement of systems and sprites in the view, and the uniforms that both
//! renderers read.

mod attachment_role;
mod density_splat;
mod drawing_order;
mod error_prediction;
mod lighting_choice;
mod optical_depth;
mod particle_measures;
mod particle_space;
mod projected_bounds;
mod resolved_settings;
mod scale_choice;
mod smoke_extent;
mod smoke_shadow;
mod sprite_projector;
mod system_setup;
mod view_geometry;
mod view_lights;

pub use attachment_role::{AttachmentRole, AttachmentSet, MAX_TARGET_ATTACHMENTS};
pub use density_splat::{cell_optical_depths, density_radius, density_splat, erosion_of, sprite_optical_depth};
pub use drawing_order::DrawingOrder;
pub use lighting_choice::LightingChoice;
pub use optical_depth::optical_depth;
pub use particle_measures::{ParticleMeasures, SystemBoxes};
pub use particle_space::ParticleSpace;
pub use resolved_settings::{ResolvedSettings, Support};
pub use scale_choice::ScaleChoice;
pub use smoke_extent::SmokeExtent;
pub use smoke_shadow::{SmokeGrid, SmokeShadow};
pub use sprite_projector::{ProjectedSprite, SpriteProjector, SpriteTrim, TexelGrid};
pub use system_setup::{DrawOrder, SystemInput, SystemSetup, caster_uniform, system_setup};
pub use view_geometry::ViewGeometry;
pub use view_lights::{light_uniforms, scene_light_uniforms};
