//! Evaluation of an emitter's particles on the GPU.

use super::shared::Tiled;
use super::storage::bind;
use crate::formula::uniforms::EmitterUniform;
use crate::frame::{Emission, Particle};
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::gpu::spare::Spare;
use crate::renderer::pass::emit::Emit;
use crate::renderer::pass::sprites::Sprites;

/// Buffer for the particles of one system, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct Emitted {
    held: Option<Held>,
    spare: Spare,
}

#[derive(Debug)]
struct Held {
    uniform: wgpu::Buffer,
    particles: wgpu::Buffer,
    inputs: wgpu::BindGroup,
}

impl Emitted {
    /// Prepares the buffer and the pass that fills it. Returns `None` if there is nothing to draw.
    pub fn write(&mut self, gpu: &Gpu<'_>, tiled: &Tiled, emission: &Emission, loops: u32) -> Option<(Sprites, Emit)> {
        let count = emission.count();
        let needed = u64::from(count.next_power_of_two()) * size_of::<Particle>() as u64;
        let held = self.held.as_ref().map_or(0, |held| held.particles.size());
        let gives_back = self.spare.outlasts(needed * 4 <= held);
        if needed > held || gives_back || count == 0 {
            self.held = None;
        }
        if count == 0 {
            return None;
        }
        let held = self.held.get_or_insert_with(|| Held::new(gpu.device, tiled, needed));
        gpu.queue.write_buffer(&held.uniform, 0, bytemuck::bytes_of(&emission.uniform));
        let buffer = held.particles.clone();
        let sprites = Sprites { buffer, offset: 0, count, loops, is_sorted: false, by_view_depth: false };
        Some((sprites, Emit { pipeline: tiled.emit(gpu.device), inputs: held.inputs.clone(), births: count }))
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.held.as_ref().map_or(0, |held| held.particles.size() + held.uniform.size())
    }
}

impl Held {
    fn new(device: &wgpu::Device, tiled: &Tiled, size: u64) -> Self {
        let uniform = uniform_buffer(device, "haze emitter", size_of::<EmitterUniform>() as u64);
        let particles = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze emitted particles"),
            size,
            // A vertex buffer as well: the raster pass that counts layers draws from it.
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
            mapped_at_creation: false,
        });
        let inputs = bind(device, &tiled.layouts.emit, [&uniform, &particles].map(wgpu::Buffer::as_entire_binding));
        Self { uniform, particles, inputs }
    }
}
