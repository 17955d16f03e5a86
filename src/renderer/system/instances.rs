//! Instance buffer of a system whose particles are in CPU memory.

use haze_core::frame::{EmitterPaths, Particle};
use haze_core::settings::{BlendOrder, Settings};
use haze_core::view_setup::{DrawingOrder, ParticleSpace};

use crate::frame::Particles;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::pass::sprite_instances::Sprites;

/// Processor that sorts particles. If the CPU also draws (software adapters), sorting on the CPU directly is faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SortedBy {
    Cpu,
    Gpu,
}

/// Use of the uploaded particles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ParticleUse {
    pub sorted_by: SortedBy,
    /// True if compute shaders read the particles.
    pub read_by_compute: bool,
}

#[derive(Debug, Default)]
pub(crate) struct Instances {
    buffer: Option<wgpu::Buffer>,
    idle: IdleCounter,
    /// Particles of an emitter, evaluated on the CPU.
    evaluated: Vec<Particle>,
    paths: EmitterPaths,
}

impl Instances {
    /// Uploads a slice or an emitter's particles, sorted unless the GPU sorts them. Uses a host's buffer as is.
    /// `order`: keys of a slice; scratch memory otherwise. Returns `None` if there is nothing to draw.
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        space: &ParticleSpace,
        order: &mut DrawingOrder,
        particles: Particles<'_>,
        settings: &Settings,
        used: ParticleUse,
    ) -> Option<Sprites> {
        let loops = settings.debug.draw_count;
        self.evaluated.clear();
        let particles = match particles {
            Particles::Buffer(particles) => {
                self.buffer = None;
                return (particles.count > 0).then(|| Sprites::of_host(&particles, loops));
            }
            Particles::Slice(particles) => particles,
            Particles::Emitter(emission) => {
                emission.evaluate_along(&mut self.paths, &mut self.evaluated);
                order.read(space, &self.evaluated);
                &self.evaluated
            }
        };
        let is_sorted = settings.order() == BlendOrder::Sorted && used.sorted_by == SortedBy::Cpu;
        if is_sorted {
            order.sort();
        }
        let count = order.indices().len();
        let needed = (count * size_of::<Particle>()) as u64;
        let held = self.bytes();
        let should_release = self.idle.tick(needed.next_power_of_two() * 4 <= held);
        let mut usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        usage.set(wgpu::BufferUsages::STORAGE, used.read_by_compute);
        let fits = self.buffer.as_ref().is_some_and(|buffer| buffer.usage().contains(usage) && needed <= held);
        if !fits || should_release {
            self.buffer = None;
            order.shrink();
        }
        let size = wgpu::BufferSize::new(needed)?;
        let buffer = self.buffer.get_or_insert_with(|| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("haze particles"),
                size: needed.next_power_of_two().min(gpu.device.limits().max_buffer_size),
                usage,
                mapped_at_creation: false,
            })
        });
        let mut staging = gpu.queue.write_buffer_with(buffer, 0, size)?;
        if !is_sorted && count == particles.len() {
            staging.copy_from_slice(bytemuck::cast_slice(particles));
        } else {
            let (sprites, _) = staging.slice(..).into_chunks::<{ size_of::<Particle>() }>();
            sprites.write_iter(order.indices().map(|index| bytemuck::cast(particles[index])));
        }
        let buffer = buffer.clone();
        let count = count as u32;
        Some(Sprites { buffer, offset: 0, count, loops, is_sorted, by_view_depth: is_sorted })
    }

    /// Returns the emitter's particles of the last upload; empty for other particles.
    pub fn evaluated(&self) -> &[Particle] {
        &self.evaluated
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.buffer.as_ref().map_or(0, wgpu::Buffer::size)
    }
}
