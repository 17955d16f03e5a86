//! wgpu, as every pass uses it. Nothing here knows smoke.

pub(crate) mod capabilities;
pub(crate) mod checked;
pub(crate) mod frame_times;
pub(crate) mod host_pass;
pub(crate) mod pipeline;
pub(crate) mod record;
pub(crate) mod spare;
pub(crate) mod submission;
pub(crate) mod timing;

/// Where things are made, and what brings their contents there.
#[derive(Clone, Copy)]
pub(crate) struct Gpu<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}
