//! Shadow of the smoke on the scene: what a host's shaders read.

use haze_core::formula::uniforms::SceneShadowUniform;

use super::context::Shared;
use super::gpu::binding::bind_resources;
use super::gpu::record::uniform_buffer;
use super::tiled::FrameShadow;
use crate::frame::FrameInput;

/// Bind group for a host's shaders, kept between frames.
#[derive(Debug)]
pub(crate) struct SceneShadow {
    uniform: wgpu::Buffer,
    /// Optical depths and ramp that the group binds.
    bound: [wgpu::TextureView; 2],
    group: wgpu::BindGroup,
}

impl SceneShadow {
    pub fn new(shared: &Shared) -> Self {
        let uniform = uniform_buffer(&shared.device, "haze scene shadow", size_of::<SceneShadowUniform>() as u64);
        let bound = [shared.no_shadow.clone(), shared.no_ramp.clone()];
        let group = bind(shared, &uniform, &bound);
        Self { uniform, bound, group }
    }

    /// Prepares the group for a frame.
    pub fn write(&mut self, shared: &Shared, frame: &FrameInput<'_>, shadow: Option<FrameShadow<'_>>) {
        let cast = shadow.and_then(|grid| {
            let (system, _) = grid.shadow.on_scene?;
            let ramp = &frame.systems.get(system)?.material.shadow_ramp.view;
            Some((grid.shadow.scene_uniform(), [grid.optical_depths, ramp]))
        });
        let none = [&shared.no_shadow, &shared.no_ramp];
        let (uniform, views) = cast.unwrap_or((SceneShadowUniform::default(), none));
        shared.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        if self.bound.each_ref() != views {
            self.bound = views.map(Clone::clone);
            self.group = bind(shared, &self.uniform, &self.bound);
        }
    }

    pub fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.uniform.size()
    }
}

fn bind(shared: &Shared, uniform: &wgpu::Buffer, [optical_depths, ramp]: &[wgpu::TextureView; 2]) -> wgpu::BindGroup {
    let resources = [
        uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(optical_depths),
        wgpu::BindingResource::TextureView(ramp),
        wgpu::BindingResource::Sampler(&shared.textures.linear),
    ];
    bind_resources(&shared.device, "haze scene shadow", &shared.layouts.scene_shadow, resources)
}
