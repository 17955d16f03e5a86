//! Textures whose size depends on the view or on a setting.

mod accumulation;
mod attachments;
mod baked_diffuse;
mod target_views;
mod texture_allocator;

pub(crate) use accumulation::{
    AccumulationKey, AccumulationTarget, CELLS_FORMAT, COMPUTED_DEPTH_FORMAT, DEPTH_COPY_FORMAT, DRAWN_CELLS_FORMAT,
    GLOWS_FORMAT, LIT_FORMAT, REDUCED_DEPTH_FORMAT,
};
pub(crate) use attachments::{
    PLACEHOLDER_FORMAT, TiledFormats, attachment_constants, attachments, tiled_formats, validate_attachments,
};
pub(crate) use baked_diffuse::{BAKED_DIFFUSE_FORMAT, BakedDiffuse};
pub use target_views::TargetViews;
pub(crate) use texture_allocator::single_target;
