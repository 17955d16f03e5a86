//! Evaluation of an emitter's particles on the GPU.

use haze_core::formula::uniforms::EmitterUniform;
use haze_core::frame::{EmitterSnapshot, Particle};

use super::tiled_pipelines::TiledPipelines;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::pass::emit::{Emit, EmitKey};
use crate::renderer::pass::sprite_instances::Sprites;

/// Buffer for the particles of one system, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct EmittedParticles {
    buffers: Option<EmitterBuffers>,
    idle: IdleCounter,
}

#[derive(Debug)]
struct EmitterBuffers {
    uniform: wgpu::Buffer,
    particles: wgpu::Buffer,
    inputs: wgpu::BindGroup,
}

impl EmittedParticles {
    /// Prepares the buffer and the pass that fills it. Returns `None` if there is nothing to draw.
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        tiled: &TiledPipelines,
        emission: &EmitterSnapshot,
        loops: u32,
    ) -> Option<(Sprites, Emit)> {
        let count = emission.count();
        let needed = u64::from(count.next_power_of_two()) * size_of::<Particle>() as u64;
        let buffers = self.buffers.as_ref().map_or(0, |buffers| buffers.particles.size());
        let should_release = self.idle.tick(needed * 4 <= buffers);
        if needed > buffers || should_release || count == 0 {
            self.buffers = None;
        }
        if count == 0 {
            return None;
        }
        let buffers = self.buffers.get_or_insert_with(|| EmitterBuffers::new(gpu.device, tiled, needed));
        gpu.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&emission.uniform));
        let buffer = buffers.particles.clone();
        let sprites = Sprites { buffer, offset: 0, count, loops, is_sorted: false, by_view_depth: false };
        Some((
            sprites,
            Emit { pipeline: tiled.passes.emit.get(EmitKey), inputs: buffers.inputs.clone(), births: count },
        ))
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.buffers.as_ref().map_or(0, |buffers| buffers.particles.size() + buffers.uniform.size())
    }
}

impl EmitterBuffers {
    fn new(device: &wgpu::Device, tiled: &TiledPipelines, size: u64) -> Self {
        let uniform = uniform_buffer(device, "haze emitter", size_of::<EmitterUniform>() as u64);
        let particles = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze emitted particles"),
            size,
            // A vertex buffer as well: the raster pass that counts layers draws from it.
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
            mapped_at_creation: false,
        });
        let inputs = tiled.passes.emit.bind([&uniform, &particles].map(wgpu::Buffer::as_entire_binding));
        Self { uniform, particles, inputs }
    }
}
