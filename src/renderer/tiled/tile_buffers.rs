//! Buffers of one system, and the bind groups of its tiled passes.

use std::sync::Arc;

use haze_core::formula::uniforms::TilesUniform;
use haze_core::view_setup::MAX_TARGET_ATTACHMENTS;

use super::sort_buffers::SortBuffers;
use super::storage_buffers::{WORD_BYTES, storage, workgroups};
use super::tiled_pipelines::TiledPipelines;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::memory_use::TiledMemory;
use crate::renderer::pass::sprite_instances::Sprites;
use crate::renderer::targets::TiledFormats;

/// Bytes of a sprite: `TileSprite` in `shaders/lib/tile_sprite.wgsl`.
pub(crate) const TILE_SPRITE_BYTES: u64 = 64;
/// Bytes of a packed rectangle.
const RECT_BYTES: u64 = 8;
/// Bytes of a `SpriteValues` in `shaders/lib/sprite_vertex.wgsl`.
const SPRITE_VALUES_BYTES: u64 = 32;
/// Unit of `TilesUniform::first`, bytes.
pub(crate) const PARTICLE_ALIGNMENT: u64 = 16;

/// Buffers of the tiled passes, and their bind groups.
#[derive(Debug)]
pub(super) struct TileBuffers {
    pub capacity: Capacity,
    pub uniform: wgpu::Buffer,
    pub counters: wgpu::Buffer,
    /// Indirect dispatch size for the visible sprites.
    pub workgroups: wgpu::Buffer,
    sprites: wgpu::Buffer,
    /// Optical depths of the smoke in front of each sprite; one element if no system receives shadow.
    sprite_values: wgpu::Buffer,
    rects: wgpu::Buffer,
    pub sort: SortBuffers,
    sorted_rects: wgpu::Buffer,
    bin_counts: wgpu::Buffer,
    lists: wgpu::Buffer,
    bins: wgpu::Buffer,
    pub read_back: Arc<wgpu::Buffer>,
    pub gather: wgpu::BindGroup,
    pub bin: wgpu::BindGroup,
    /// Bind groups that include resources from outside, next to those resources; recreated when the resources change. The
    /// first ones: by the pair of buffers that the keys are written to.
    project: Option<(ParticleRange, [wgpu::BindGroup; 2])>,
    refine: Option<(wgpu::TextureView, wgpu::BindGroup)>,
    accumulate: Option<(Vec<wgpu::TextureView>, wgpu::BindGroup)>,
}

/// Range of a buffer that has a system's particles. It starts at an offset that can be bound.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ParticleRange {
    buffer: wgpu::Buffer,
    offset: u64,
    size: u64,
    /// Start of the first particle in the range, in units of `PARTICLE_ALIGNMENT`.
    pub first: u32,
}

/// Number of elements that the buffers can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Capacity {
    pub particles: u32,
    pub bins: u32,
    /// Sprite counts: one per bin and run.
    pub runs: u32,
    pub entries: u32,
    /// Sprites with optical depths.
    pub shaded: u32,
}

impl Capacity {
    /// Rounds up to leave room for growth. `max_words`: words of the largest buffer. Lists that do not fit into it are
    /// dropped; their bins read all sprites instead.
    pub fn rounded_up(self, max_words: u32) -> Self {
        Self {
            particles: self.particles.next_power_of_two(),
            bins: self.bins.next_power_of_two(),
            runs: self.runs.next_power_of_two().min(max_words),
            entries: self.entries.min(1 << 31).next_power_of_two().min(max_words),
            shaded: self.shaded.next_power_of_two(),
        }
    }

    fn all(&self) -> [u32; 5] {
        [self.particles, self.bins, self.runs, self.entries, self.shaded]
    }

    pub fn holds(&self, needed: &Self) -> bool {
        self.all().iter().zip(needed.all()).all(|(buffers, needed)| *buffers >= needed)
    }

    pub fn is_oversized_for(&self, needed: &Self) -> bool {
        self.all().iter().zip(needed.all()).any(|(buffers, needed)| buffers / 4 >= needed)
    }
}

impl TileBuffers {
    pub fn new(device: &wgpu::Device, tiled: &TiledPipelines, capacity: Capacity) -> Self {
        let storage = |name, count, bytes| storage(device, name, count, bytes);
        let Capacity { particles, bins, runs, entries, shaded } = capacity;
        let uniform = uniform_buffer(device, "haze tiles", size_of::<TilesUniform>() as u64);
        let counters = storage("haze tile counters", 2, WORD_BYTES);
        let rects = storage("haze sprite rectangles", particles, RECT_BYTES);
        let sort = SortBuffers::new(device, tiled, &uniform, particles);
        let sorted_rects = storage("haze sorted rectangles", particles, RECT_BYTES);
        let bin_counts = storage("haze bin counts", runs, WORD_BYTES);
        let lists = storage("haze bin lists", entries, WORD_BYTES);
        let bins = storage("haze bins", bins, RECT_BYTES);
        let read_back = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze tile counters"),
            size: 2 * WORD_BYTES,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let workgroups = workgroups(device, "haze bin workgroups");
        let [sorted_keys, sorted_indices] = sort.pair(0);
        let gather = [&uniform, sorted_keys, sorted_indices, &rects, &sorted_rects, &counters, &workgroups];
        let gather = tiled.passes.gather.bind(gather.map(wgpu::Buffer::as_entire_binding));
        let bin = [&uniform, sorted_indices, &sorted_rects, &bin_counts, &lists, &bins, &counters];
        let bin = tiled.passes.bin.bind(bin.map(wgpu::Buffer::as_entire_binding));
        Self {
            capacity,
            sprites: storage("haze tile sprites", particles, TILE_SPRITE_BYTES),
            sprite_values: storage("haze sprite values", shaded, SPRITE_VALUES_BYTES),
            read_back: Arc::new(read_back),
            gather,
            bin,
            project: None,
            refine: None,
            accumulate: None,
            uniform,
            counters,
            workgroups,
            rects,
            sort,
            sorted_rects,
            bin_counts,
            lists,
            bins,
        }
    }

    pub fn memory(&self) -> TiledMemory {
        let bytes = |buffers: &[&wgpu::Buffer]| buffers.iter().map(|buffer| buffer.size()).sum();
        let [keys, counts] = self.sort.bytes();
        TiledMemory {
            sprites: bytes(&[&self.uniform, &self.sprites, &self.sprite_values, &self.rects, &self.sorted_rects]),
            keys,
            counts: counts + bytes(&[&self.bin_counts, &self.counters, &self.workgroups, &self.read_back]),
            lists: bytes(&[&self.lists, &self.bins]),
            ..TiledMemory::default()
        }
    }

    /// `pair`: pair of buffers that the keys are written to.
    pub fn bind_project(&mut self, tiled: &TiledPipelines, particles: ParticleRange, pair: usize) -> wgpu::BindGroup {
        let bound = self.project.take().filter(|(bound, _)| *bound == particles);
        let (_, groups) = self.project.insert(bound.unwrap_or_else(|| {
            let Self { uniform, sprites, sprite_values, rects, sort, .. } = self;
            let groups = [0, 1].map(|pair| {
                let [keys, indices] = sort.pair(pair);
                let buffers = [&*sprites, rects, keys, indices, sprite_values].map(wgpu::Buffer::as_entire_binding);
                let own = [uniform.as_entire_binding(), particles.binding()];
                tiled.passes.project.bind(own.into_iter().chain(buffers))
            });
            (particles, groups)
        }));
        groups[pair].clone()
    }

    pub fn bind_refine(&mut self, tiled: &TiledPipelines, depth: &wgpu::TextureView) -> wgpu::BindGroup {
        match &self.refine {
            Some((bound, group)) if bound == depth => group.clone(),
            _ => {
                let Self { uniform, sprites, rects, lists, bins, .. } = self;
                let read = [&*uniform, sprites, rects, bins].map(wgpu::Buffer::as_entire_binding);
                let depth_binding = wgpu::BindingResource::TextureView(depth);
                let resources = read.into_iter().chain([depth_binding, lists.as_entire_binding()]);
                let group = tiled.passes.refine.bind(resources);
                self.refine = Some((depth.clone(), group.clone()));
                group
            }
        }
    }

    pub fn bind_accumulate(
        &mut self,
        tiled: &TiledPipelines,
        formats: TiledFormats,
        attachments: &[wgpu::TextureView],
        depth: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let mut views = [depth; 1 + MAX_TARGET_ATTACHMENTS];
        let placeholders = tiled.accumulate.placeholders.iter().skip(attachments.len());
        views[1..].iter_mut().zip(attachments.iter().chain(placeholders)).for_each(|(bound, view)| *bound = view);
        match &self.accumulate {
            Some((bound, group)) if bound.iter().eq(views) => group.clone(),
            _ => {
                let Self { uniform, sprites, sprite_values, rects, sort, lists, bins, .. } = self;
                let [_, indices] = sort.pair(0);
                let buffers = [&*uniform, sprites, rects, indices, lists, bins];
                let textures = views.map(wgpu::BindingResource::TextureView);
                let resources = buffers.map(wgpu::Buffer::as_entire_binding).into_iter().chain(textures);
                let resources = resources.chain([sprite_values.as_entire_binding()]);
                let group = tiled.accumulate.get(formats).bind(resources);
                self.accumulate = Some((views.map(wgpu::TextureView::clone).to_vec(), group.clone()));
                group
            }
        }
    }
}

impl ParticleRange {
    pub fn new(limits: &wgpu::Limits, sprites: &Sprites) -> Self {
        let before = sprites.offset % u64::from(limits.min_storage_buffer_offset_alignment);
        let offset = sprites.offset - before;
        Self {
            buffer: sprites.buffer.clone(),
            offset,
            // Binds the rest of the buffer, so that a change of the particle count needs no new bind group.
            size: (sprites.buffer.size() - offset).min(limits.max_storage_buffer_binding_size) & !3,
            first: (before / PARTICLE_ALIGNMENT) as u32,
        }
    }

    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        let Self { buffer, offset, size, .. } = self;
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer,
            offset: *offset,
            size: wgpu::BufferSize::new(*size),
        })
    }
}
