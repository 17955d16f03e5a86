//! Group 0 of every pass: the view and the scene's depth.

use crate::frame::SceneDepth;
use crate::gpu_types::ViewUniform;
use crate::pass::{Layouts, uniform_buffer};
use crate::view::ViewGeometry;

/// The view's uniforms with either kind of scene depth.
#[derive(Debug)]
pub(crate) struct FrameBindings {
    buffer: Source,
    linear: Source,
}

/// One kind of scene depth, and a bind group that is made anew when the host hands over another texture.
#[derive(Debug)]
struct Source {
    view: wgpu::Buffer,
    /// The depth view that the bind group shows, and the bind group.
    bound: Option<(wgpu::TextureView, wgpu::BindGroup)>,
}

impl FrameBindings {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { buffer: Source::new(device), linear: Source::new(device) }
    }

    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        view: &ViewGeometry,
        scene_depth: &SceneDepth<'_>,
    ) {
        self.buffer.write(device, queue, layouts, &view.uniform(false), scene_depth.buffer());
        self.linear.write(device, queue, layouts, &view.uniform(true), scene_depth.linear());
    }

    /// `linear`: the system reads the linear target.
    pub fn bind_group(&self, linear: bool) -> Option<&wgpu::BindGroup> {
        let source = if linear { &self.linear } else { &self.buffer };
        source.bound.as_ref().map(|(_, bind_group)| bind_group)
    }
}

impl Source {
    fn new(device: &wgpu::Device) -> Self {
        Self { view: uniform_buffer(device, "haze view", size_of::<ViewUniform>() as u64), bound: None }
    }

    fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        view: &ViewUniform,
        depth: Option<&wgpu::TextureView>,
    ) {
        let Some(depth) = depth else {
            self.bound = None;
            return;
        };
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        if self.bound.as_ref().is_some_and(|(bound, _)| bound == depth) {
            return;
        }
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze frame"),
            layout: &layouts.frame,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(depth) },
            ],
        });
        self.bound = Some((depth.clone(), bind_group));
    }
}
