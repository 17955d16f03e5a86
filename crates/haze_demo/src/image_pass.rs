//! A pass over the final image on the GPU: the image and the depth buffer of its scene are read, another image is written.

use glam::UVec2;
use haze::shader;

use super::scene_pipeline::{COLOR_FORMAT, ScenePipeline, default_view, image_pass_layout, texture, texture_entries};
use super::scene_renderer::begin_pass;

/// Pipeline of a pass, shared by all renderers of a device.
#[derive(Debug)]
pub struct ImagePass {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// Inputs of a pass for an image of one size.
#[derive(Debug)]
pub struct ImagePassInputs {
    /// Image that the pass reads.
    pub image: wgpu::Texture,
    group: wgpu::BindGroup,
    uniform: wgpu::Buffer,
}

impl ImagePass {
    /// Compiles the pipeline. `shader`: has `fragment`, which reads the image at binding 0, the depth buffer at 1, and may read
    /// a uniform at 2.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, shader: &str) -> Self {
        let source = shader::compose(&format!("{shader}{}", include_str!("image_pass.wgsl")));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("demo image pass"),
            source: wgpu::ShaderSource::Wgsl(source.unwrap_or_default().into()),
        });
        let layout = image_pass_layout(device, "demo image pass", &[0, 1], 2);
        let pipeline = ScenePipeline {
            groups: &[Some(&layout)],
            vertex: "vertex",
            buffers: &[],
            fragment: Some(("fragment", &[COLOR_FORMAT])),
            depth: false,
            blend: None,
        };
        let pipeline = pipeline.create(device, &module);
        Self { device: device.clone(), queue: queue.clone(), layout, pipeline }
    }

    /// Creates an image of this size to read, and binds it. `depth`: depth buffer of its scene. `uniform_size`: bytes.
    pub fn inputs(&self, size: UVec2, depth: &wgpu::TextureView, uniform_size: usize) -> ImagePassInputs {
        let image = texture(&self.device, "demo image pass", size, COLOR_FORMAT);
        let uniform = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("demo image pass"),
            size: uniform_size.max(16) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let buffer = wgpu::BindGroupEntry { binding: 2, resource: uniform.as_entire_binding() };
        let view = default_view(&image);
        let textures = texture_entries([(0, &view), (1, depth)]);
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo image pass"),
            layout: &self.layout,
            entries: &textures.into_iter().chain([buffer]).collect::<Vec<_>>(),
        });
        ImagePassInputs { image, group, uniform }
    }

    /// Writes the target, which has the size of the image. `uniform`: may be empty.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &ImagePassInputs,
        uniform: &[u8],
        target: &wgpu::Texture,
    ) {
        self.queue.write_buffer(&inputs.uniform, 0, uniform);
        let mut pass = begin_pass(encoder, &[&default_view(target)], wgpu::Color::BLACK, None);
        pass.set_bind_group(0, &inputs.group, &[]);
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
