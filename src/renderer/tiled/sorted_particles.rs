//! Sort of a host's particles back to front on the GPU.

use haze_core::formula::uniforms::TilesUniform;
use haze_core::frame::Particle;

use super::sort_buffers::SortBuffers;
use super::tile_buffers::ParticleRange;
use super::tiled_pipelines::TiledPipelines;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::memory_use::TiledMemory;
use crate::renderer::pass::depth_sort::{DepthSort, DepthSortKey};
use crate::renderer::pass::sort::{BLOCK, Sort};
use crate::renderer::pass::sprite_instances::Sprites;

/// Buffers for the sorted particles of one system, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct SortedParticles {
    buffers: Option<DepthSortBuffers>,
    idle: IdleCounter,
}

#[derive(Debug)]
struct DepthSortBuffers {
    capacity: u32,
    uniform: wgpu::Buffer,
    sort: SortBuffers,
    particles: wgpu::Buffer,
    /// Bind groups with the host's own buffer, by the pair of keys; recreated when that is another.
    inputs: Option<(ParticleRange, [wgpu::BindGroup; 2])>,
}

impl SortedParticles {
    /// Prepares the buffers and the pass that sorts `sprites` into them. Returns the sorted sprites and the pass.
    pub fn write(&mut self, gpu: &Gpu<'_>, tiled: &TiledPipelines, sprites: &Sprites) -> (Sprites, DepthSort) {
        let count = sprites.count;
        let buffers = self.buffers.as_ref().map_or(0, |buffers| buffers.capacity);
        let should_release = self.idle.tick(count.next_power_of_two() <= buffers / 4);
        if count > buffers || should_release {
            self.buffers = None;
        }
        let buffers =
            self.buffers.get_or_insert_with(|| DepthSortBuffers::new(gpu.device, tiled, count.next_power_of_two()));
        let range = ParticleRange::new(&tiled.limits, sprites);
        let uniform =
            TilesUniform { count, first: range.first, blocks: count.div_ceil(BLOCK), ..TilesUniform::default() };
        gpu.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&uniform));
        let buffer = buffers.particles.clone();
        let sorted = Sprites { buffer, offset: 0, is_sorted: true, by_view_depth: true, ..*sprites };
        let [first, second] = buffers.bind(tiled, range);
        let sort = DepthSort {
            depth_keys: tiled.passes.depth_sort.get(DepthSortKey::DepthKeys),
            sort: Sort { pipelines: tiled.sort(count), ping_pong: buffers.sort.ping_pong.clone(), keys: count },
            gather_particles: tiled.passes.depth_sort.get(DepthSortKey::GatherParticles),
            unsorted: if tiled.unsorted_pair(count) == 0 { first.clone() } else { second },
            sorted: first,
            particles: count,
        };
        (sorted, sort)
    }

    /// Returns the bytes of GPU memory held.
    pub fn memory(&self) -> TiledMemory {
        self.buffers.as_ref().map_or(TiledMemory::default(), |buffers| {
            let [keys, counts] = buffers.sort.bytes();
            TiledMemory {
                sorted: buffers.particles.size() + buffers.uniform.size(),
                keys,
                counts,
                ..TiledMemory::default()
            }
        })
    }
}

impl DepthSortBuffers {
    fn new(device: &wgpu::Device, tiled: &TiledPipelines, capacity: u32) -> Self {
        let uniform = uniform_buffer(device, "haze depth_sort", size_of::<TilesUniform>() as u64);
        let particles = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze sorted particles"),
            size: u64::from(capacity) * size_of::<Particle>() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
            mapped_at_creation: false,
        });
        Self { capacity, sort: SortBuffers::new(device, tiled, &uniform, capacity), uniform, particles, inputs: None }
    }

    /// Returns the bind groups by the pair of keys.
    fn bind(&mut self, tiled: &TiledPipelines, range: ParticleRange) -> [wgpu::BindGroup; 2] {
        let bound = self.inputs.take().filter(|(bound, _)| *bound == range);
        let (_, groups) = self.inputs.insert(bound.unwrap_or_else(|| {
            let groups = [0, 1].map(|pair| {
                let [keys, indices] = self.sort.pair(pair);
                let own = [keys, indices, &self.particles].map(wgpu::Buffer::as_entire_binding);
                let resources = [self.uniform.as_entire_binding(), range.binding()];
                tiled.passes.depth_sort.bind(resources.into_iter().chain(own))
            });
            (range, groups)
        }));
        groups.clone()
    }
}
