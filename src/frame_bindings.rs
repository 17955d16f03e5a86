//! Group 0 of every pass: the view and the scene's depth.

use crate::frame::SceneDepth;
use crate::gpu_types::ViewUniform;
use crate::pass::{Layouts, uniform_buffer};
use crate::view::ViewGeometry;

/// The view's uniforms, and a bind group that is made anew when the host hands over another depth texture.
#[derive(Debug)]
pub(crate) struct FrameBindings {
    view: wgpu::Buffer,
    /// The depth view that the bind group shows, and the bind group.
    bound: Option<(wgpu::TextureView, wgpu::BindGroup)>,
}

impl FrameBindings {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { view: uniform_buffer(device, "haze view", size_of::<ViewUniform>() as u64), bound: None }
    }

    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        view: &ViewGeometry,
        scene_depth: &SceneDepth<'_>,
    ) {
        let linear = matches!(scene_depth, SceneDepth::Linear(_));
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view.uniform(linear)));
        let depth = scene_depth.texture_view();
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

    pub fn bind_group(&self) -> Option<&wgpu::BindGroup> {
        self.bound.as_ref().map(|(_, bind_group)| bind_group)
    }
}
