//! Bind group 0 of every pass: view uniforms and scene depth.

use haze_core::error::FieldError;
use haze_core::formula::uniforms::ViewUniform;
use haze_core::view_setup::ViewGeometry;

use super::context::Shared;
use super::gpu::error_scopes::with_error_scopes;
use super::gpu::record::uniform_buffer;
use crate::frame::SceneDepth;

/// View uniforms, bound with each kind of scene depth.
#[derive(Debug)]
pub(crate) struct FrameBindings {
    buffer: Source,
    linear: Source,
}

/// View uniforms for one kind of scene depth, and bind groups that are recreated when the host supplies another
/// texture.
#[derive(Debug)]
struct Source {
    view: wgpu::Buffer,
    bound: Option<DepthBindings>,
}

/// Bind groups of one depth texture of the host.
#[derive(Debug)]
pub(crate) struct DepthBindings {
    pub depth: wgpu::TextureView,
    /// Group 0.
    pub frame: wgpu::BindGroup,
    /// Group 3 of accumulate, if sprites are compared with the host's own depth.
    pub accumulate_inputs: wgpu::BindGroup,
}

impl FrameBindings {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { buffer: Source::new(device), linear: Source::new(device) }
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.buffer.view.size() + self.linear.view.size()
    }

    /// # Errors
    /// Names the field `scene_depth` if one of its views cannot be bound.
    pub fn write(
        &mut self,
        shared: &Shared,
        view: &ViewGeometry,
        scene_depth: &SceneDepth<'_>,
    ) -> Result<(), FieldError> {
        self.buffer.write(shared, &view.uniform(false), scene_depth.buffer())?;
        self.linear.write(shared, &view.uniform(true), scene_depth.linear())
    }

    /// Returns the bindings of the linear target if `linear` is true, else those of the depth buffer. `None` if the
    /// frame has no depth of that kind.
    pub fn get(&self, linear: bool) -> Option<&DepthBindings> {
        if linear { self.linear.bound.as_ref() } else { self.buffer.bound.as_ref() }
    }

    /// Returns bindings of either kind, for passes that do not read depth.
    pub fn any(&self) -> Option<&DepthBindings> {
        self.get(false).or(self.get(true))
    }
}

impl Source {
    fn new(device: &wgpu::Device) -> Self {
        Self { view: uniform_buffer(device, "haze view", size_of::<ViewUniform>() as u64), bound: None }
    }

    fn write(
        &mut self,
        shared: &Shared,
        view: &ViewUniform,
        depth: Option<&wgpu::TextureView>,
    ) -> Result<(), FieldError> {
        let Some(depth) = depth else {
            self.bound = None;
            return Ok(());
        };
        if self.bound.as_ref().is_none_or(|bound| bound.depth != *depth) {
            self.bound = None;
            let bound = with_error_scopes(&shared.device, || self.bind(shared, depth)).map_err(|reason| {
                let expected = format!("a 2D view of one layer and one aspect of a texture of this device ({reason})");
                let problem = format!("a view of a {:?} texture cannot be bound", depth.texture().format());
                FieldError::from_problem("scene_depth", problem, expected)
            })?;
            self.bound = Some(bound);
        }
        shared.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        Ok(())
    }

    fn bind(&self, shared: &Shared, depth: &wgpu::TextureView) -> DepthBindings {
        let frame = shared.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze frame"),
            layout: &shared.layouts.frame,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(depth) },
            ],
        });
        let accumulate_inputs = shared.pipelines.drawn.accumulate.bind_textures([depth]);
        DepthBindings { depth: depth.clone(), frame, accumulate_inputs }
    }
}
