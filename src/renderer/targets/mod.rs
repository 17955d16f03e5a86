//! Textures whose size depends on the view or on a setting.

mod accumulation;
mod attachments;
mod baked_diffuse;
mod input_groups;
mod target;
mod target_views;
mod texture_allocator;

pub(crate) use accumulation::{AccumulationKey, AccumulationTarget};
pub(crate) use attachments::{
    PLACEHOLDER_FORMAT, TiledFormats, attachment_constants, attachments, tiled_formats, validate_attachments,
};
pub(crate) use baked_diffuse::{BAKED_DIFFUSE_FORMAT, BakedDiffuse};
pub(crate) use input_groups::InputGroups;
pub(crate) use target::{Extent, PlannedTarget, PlannedTargets, Target, planned_targets};
pub use target_views::TargetViews;
pub(crate) use texture_allocator::single_target;

/// Textures of one system that fit the current frame.
#[derive(Clone, Copy)]
pub(crate) struct SystemTextures<'a> {
    pub accumulation: &'a AccumulationTarget,
    pub baked_diffuse: &'a BakedDiffuse,
}
