//! Textures whose size depends on the view or on a setting.

mod accumulation;
mod baked_diffuse;
mod target_views;
mod texture_allocator;

pub(crate) use accumulation::{
    AccumulationKey, AccumulationTarget, DEPTH_COPY_FORMAT, ExtraAttachment, LIT_FORMAT, REDUCED_DEPTH_FORMAT,
    accumulation_layout, tiled_formats,
};
pub(crate) use baked_diffuse::{BAKED_DIFFUSE_FORMAT, BakedDiffuse};
pub use target_views::TargetViews;
pub(crate) use texture_allocator::storage_target;
