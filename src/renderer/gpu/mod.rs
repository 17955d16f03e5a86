//! wgpu helpers that all passes share. Nothing here is specific to smoke.

pub(crate) mod binding;
pub(crate) mod capabilities;
pub(crate) mod error_scopes;
pub(crate) mod frame_encoder;
pub(crate) mod frame_times;
pub(crate) mod host_pass;
pub(crate) mod idle_counter;
pub(crate) mod pipeline;
pub(crate) mod record;
pub(crate) mod submission;
pub(crate) mod timing;

/// Device that creates resources, and queue that uploads their contents.
#[derive(Clone, Copy)]
pub(crate) struct Gpu<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}
