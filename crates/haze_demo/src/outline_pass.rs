//! Pass that completes an image on the GPU: objects in front at outlines, with the smoke in front of them.

use super::scene_pipeline::{COLOR_FORMAT, ScenePipeline, image_pass_layout, texture_entries};
use super::scene_renderer::{SceneTargets, begin_pass};
use haze::shader;

/// Binding of [`SmokeUniform`]. The textures have those before it.
const SMOKE: u32 = 14;

/// Pipeline of the pass, shared by all renderers of a device.
#[derive(Debug)]
pub(crate) struct OutlinePass {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// Inputs of the pass for an image of one size.
#[derive(Debug)]
pub(crate) struct OutlineInputs {
    /// Image with smoke, whose opacity is in alpha; without the objects in front.
    pub smoked: wgpu::TextureView,
    group: wgpu::BindGroup,
    uniform: wgpu::Buffer,
}

/// `Smoke` in scene_outline.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct SmokeUniform {
    depths: [f32; 2],
    padding: [f32; 2],
}

impl OutlinePass {
    /// Compiles the pipeline. `scene_layout`: that of group 0 of the scene.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene_layout: &wgpu::BindGroupLayout) -> Self {
        let source = shader::compose(concat!(
            include_str!("scene.wgsl"),
            include_str!("scene_samples.wgsl"),
            include_str!("scene_outline.wgsl")
        ));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("demo scene outline"),
            source: wgpu::ShaderSource::Wgsl(source.unwrap_or_default().into()),
        });
        let layout = image_pass_layout(device, "demo scene outline", &[7, 11, 12, 13], SMOKE);
        let pipeline = ScenePipeline {
            groups: &[Some(scene_layout), Some(&layout)],
            vertex: "fullscreen_vertex",
            buffers: &[],
            fragment: Some(("outline_fragment", &[COLOR_FORMAT])),
            depth: false,
            blend: None,
        };
        let pipeline = pipeline.create(device, &module);
        Self { device: device.clone(), queue: queue.clone(), layout, pipeline }
    }

    /// Binds the targets of a scene, and an image with smoke of the same size.
    pub fn inputs(
        &self,
        targets: &SceneTargets,
        behind: &wgpu::TextureView,
        smoked: wgpu::TextureView,
    ) -> OutlineInputs {
        let uniform = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("demo scene outline"),
            size: size_of::<SmokeUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let textures = texture_entries([(7, &targets.paint_depth), (11, &smoked), (12, behind), (13, &targets.front)]);
        let buffer = wgpu::BindGroupEntry { binding: SMOKE, resource: uniform.as_entire_binding() };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene outline"),
            layout: &self.layout,
            entries: &textures.into_iter().chain([buffer]).collect::<Vec<_>>(),
        });
        OutlineInputs { smoked, group, uniform }
    }

    /// Writes the completed image. `depths`: range of view depths of smoke, metres. Does nothing before the scene was
    /// recorded.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &SceneTargets,
        inputs: &OutlineInputs,
        depths: [f32; 2],
        image: &wgpu::TextureView,
    ) {
        let Some(scene) = &targets.scene_group else { return };
        self.queue.write_buffer(&inputs.uniform, 0, bytemuck::bytes_of(&SmokeUniform { depths, padding: [0.0; 2] }));
        let mut pass = begin_pass(encoder, &[image], wgpu::Color::BLACK, None);
        pass.set_bind_group(0, scene, &[]);
        pass.set_bind_group(1, &inputs.group, &[]);
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
