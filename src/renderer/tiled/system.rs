//! What the tiled passes of one system read and write, and the passes bound to it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::UVec2;

use super::shared::{Tiled, TiledKeys};
use crate::formula::uniforms::TilesUniform;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::record::{begin_compute, uniform_buffer};
use crate::renderer::gpu::spare::Spare;
use crate::renderer::gpu::timing::Timing;
use crate::renderer::memory::TiledMemory;
use crate::renderer::pass::Groups;
use crate::renderer::pass::sort::{BLOCK, DIGITS, Sort};
use crate::renderer::pass::sprites::Sprites;
use crate::renderer::pass::tile_accumulate::TileAccumulate;
use crate::renderer::pass::tile_bin::{RUN, TileBin};
use crate::renderer::pass::tile_project::TileProject;
use crate::settings::AccumulationFormat;

/// Bytes of a sprite: TileSprite in `shaders/lib/tile_sprite.wgsl`.
pub(crate) const SPRITE: u64 = 64;
/// Bytes of a packed rectangle, and of a key, number or count.
const RECT: u64 = 8;
const WORD: u64 = 4;
/// Bytes that `first` counts in.
pub(crate) const PARTICLE_STEP: u64 = 16;

/// Entries of all lists at first, for each particle and at the least.
const ENTRIES_EACH: u32 = 4;
const LEAST_ENTRIES: u32 = 1 << 16;

/// Texels along a bin's side: where workgroups walk alone, each by its bin's list; where they walk in step, by what of that
/// touches their tile; and for so many particles that counting by bins would cost more than it saves.
const BIN_ALONE: u32 = 32;
const BIN_IN_STEP: u32 = 32;
const BIN_OF_MANY: u32 = 64;
const MANY: u32 = 1 << 16;

/// Along each side of a dispatch, on every device.
const MOST_WORKGROUPS: u32 = 65535;

/// Buffers of one system, kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct TiledSystem {
    held: Option<Held>,
    spare: Spare,
    /// Entries that the lists of some frames ago would have needed.
    entries: Arc<AtomicU32>,
}

/// What a system's passes work on.
pub(crate) struct TiledInputs<'a> {
    pub sprites: &'a Sprites,
    /// Texels in use.
    pub size: UVec2,
    pub format: AccumulationFormat,
    pub attachments: &'a [wgpu::TextureView],
    /// The depth that sprites are compared with.
    pub depth: &'a wgpu::TextureView,
}

#[derive(Debug)]
struct Held {
    capacity: Capacity,
    uniform: wgpu::Buffer,
    tally: wgpu::Buffer,
    sprites: wgpu::Buffer,
    rects: wgpu::Buffer,
    /// Two pairs, sorted by turns.
    keys: [wgpu::Buffer; 2],
    numbers: [wgpu::Buffer; 2],
    sorted_rects: wgpu::Buffer,
    digit_counts: wgpu::Buffer,
    digit_totals: wgpu::Buffer,
    bin_counts: wgpu::Buffer,
    lists: wgpu::Buffer,
    bins: wgpu::Buffer,
    read_back: Arc<wgpu::Buffer>,
    there_and_back: [wgpu::BindGroup; 2],
    bin: wgpu::BindGroup,
    /// With the host's own things, made anew when they are others.
    project: Option<(Part, wgpu::BindGroup)>,
    accumulate: Option<(Vec<wgpu::TextureView>, wgpu::BindGroup)>,
}

/// The part of a buffer with a system's particles: from an offset that can be bound.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    buffer: wgpu::Buffer,
    offset: u64,
    size: u64,
    /// The first particle in it, in steps.
    first: u32,
}

/// How much fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Capacity {
    particles: u32,
    bins: u32,
    /// Runs of all bins.
    runs: u32,
    entries: u32,
}

/// One frame's passes.
#[derive(Debug)]
pub(crate) struct TiledPasses {
    groups: Groups,
    project: TileProject,
    sort: Option<Sort>,
    bin: TileBin,
    accumulate: TileAccumulate,
    tally: wgpu::Buffer,
    read_back: Arc<wgpu::Buffer>,
    entries: Arc<AtomicU32>,
}

impl TiledSystem {
    /// Readies buffers and passes for a frame.
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        tiled: &Tiled,
        keys: TiledKeys,
        groups: &Groups,
        inputs: &TiledInputs<'_>,
    ) -> TiledPasses {
        let TiledInputs { sprites, size, format, attachments, depth } = *inputs;
        let most = most_words(&tiled.limits);
        let in_step = keys.accumulate.in_step;
        let runs = sprites.count.div_ceil(RUN);
        let mut bin_side = match (in_step, sprites.count > MANY) {
            (false, _) => BIN_ALONE,
            (true, false) => BIN_IN_STEP,
            (true, true) => BIN_OF_MANY,
        };
        let bins_of = |side| bins_along(size, side).element_product();
        while runs.saturating_mul(bins_of(bin_side)) > most || bins_of(bin_side) > MOST_WORKGROUPS {
            bin_side *= 2;
        }
        let UVec2 { x: columns, y: rows } = bins_along(size, bin_side);
        let bins = columns * rows;
        let wanted = self.entries.load(Ordering::Relaxed);
        let entries = wanted.max(sprites.count.saturating_mul(ENTRIES_EACH)).max(LEAST_ENTRIES);
        let needed = Capacity { particles: sprites.count, bins, runs: bins * runs, entries };
        let held = self.fit(gpu, tiled, needed.with_room(most));
        let capacity = held.capacity.entries;
        let particles = Part::new(&tiled.limits, sprites);
        let uniform = TilesUniform {
            count: sprites.count,
            loops: sprites.loops,
            first: particles.first,
            blocks: sprites.count.div_ceil(BLOCK),
            bin_side,
            columns,
            rows,
            runs,
            capacity,
            padding: [0; 3],
        };
        gpu.queue.write_buffer(&held.uniform, 0, bytemuck::bytes_of(&uniform));
        let sorts = !keys.project.weighted && !sprites.is_sorted;
        let pipelines = tiled.pipelines(gpu.device, keys, sorts);
        let project = held.bind_project(gpu, tiled, particles);
        let accumulate = held.bind_accumulate(gpu, tiled, format, attachments, depth);
        TiledPasses {
            groups: groups.clone(),
            project: TileProject { pipeline: pipelines.project, inputs: project, particles: sprites.count },
            sort: pipelines.sort.map(|pipelines| Sort {
                pipelines,
                there_and_back: held.there_and_back.clone(),
                blocks: uniform.blocks,
            }),
            bin: TileBin {
                pipelines: pipelines.bin,
                inputs: held.bin.clone(),
                particles: sprites.count,
                bins,
                runs,
                in_step,
            },
            accumulate: TileAccumulate { pipeline: pipelines.accumulate, inputs: accumulate, size, in_step },
            tally: held.tally.clone(),
            read_back: held.read_back.clone(),
            entries: self.entries.clone(),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> TiledMemory {
        self.held.as_ref().map_or(TiledMemory::default(), Held::memory)
    }

    fn fit(&mut self, gpu: &Gpu<'_>, tiled: &Tiled, needed: Capacity) -> &mut Held {
        let is_to_spare = self.held.as_ref().is_some_and(|held| held.capacity.is_wasted_on(&needed));
        let gives_back = self.spare.outlasts(is_to_spare);
        if gives_back || !self.held.as_ref().is_some_and(|held| held.capacity.holds(&needed)) {
            // The old ones go before the new ones come.
            self.held = None;
        }
        self.held.get_or_insert_with(|| Held::new(gpu.device, tiled, needed))
    }
}

impl Capacity {
    /// With room to grow. Lists that would be longer than a buffer can be are left out.
    fn with_room(self, most: u32) -> Self {
        Self {
            particles: self.particles.next_power_of_two(),
            bins: self.bins.next_power_of_two(),
            runs: self.runs.next_power_of_two().min(most),
            entries: self.entries.min(1 << 31).next_power_of_two().min(most),
        }
    }

    fn all(&self) -> [u32; 4] {
        [self.particles, self.bins, self.runs, self.entries]
    }

    fn holds(&self, needed: &Self) -> bool {
        self.all().iter().zip(needed.all()).all(|(held, needed)| *held >= needed)
    }

    fn is_wasted_on(&self, needed: &Self) -> bool {
        self.all().iter().zip(needed.all()).any(|(held, needed)| held / 4 >= needed)
    }
}

/// Most numbers of a buffer that a shader can read.
fn most_words(limits: &wgpu::Limits) -> u32 {
    (limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / WORD).try_into().unwrap_or(u32::MAX)
}

/// Bins along the sides of a target.
fn bins_along(size: UVec2, bin_side: u32) -> UVec2 {
    UVec2::new(size.x.div_ceil(bin_side), size.y.div_ceil(bin_side))
}

impl Held {
    fn new(device: &wgpu::Device, tiled: &Tiled, capacity: Capacity) -> Self {
        let storage = |name, count: u32, bytes: u64| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(name),
                size: u64::from(count) * bytes,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let Capacity { particles, bins, runs, entries } = capacity;
        let uniform = uniform_buffer(device, "haze tiles", size_of::<TilesUniform>() as u64);
        let tally = storage("haze tally", 2, WORD);
        let rects = storage("haze sprite rectangles", particles, RECT);
        let keys = ["haze sort keys", "haze sort keys, sorted"].map(|name| storage(name, particles, WORD));
        let numbers = ["haze sort numbers", "haze sort numbers, sorted"].map(|name| storage(name, particles, WORD));
        let sorted_rects = storage("haze sorted rectangles", particles, RECT);
        let digit_counts = storage("haze digit counts", particles.div_ceil(BLOCK) * DIGITS, WORD);
        let digit_totals = storage("haze digit totals", DIGITS, WORD);
        let bin_counts = storage("haze bin counts", runs, WORD);
        let lists = storage("haze bin lists", entries, WORD);
        let bins = storage("haze bins", bins, RECT);
        let read_back = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze tally"),
            size: 2 * WORD,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let there_and_back = [(0, 1), (1, 0)].map(|(from, to)| {
            let buffers =
                [&uniform, &keys[from], &numbers[from], &keys[to], &numbers[to], &digit_counts, &digit_totals];
            bind(device, &tiled.layouts.sort, buffers.map(wgpu::Buffer::as_entire_binding))
        });
        let buffers = [&uniform, &keys[0], &numbers[0], &rects, &sorted_rects, &bin_counts, &lists, &bins, &tally];
        let bin = bind(device, &tiled.layouts.bin, buffers.map(wgpu::Buffer::as_entire_binding));
        Self {
            capacity,
            sprites: storage("haze tile sprites", particles, SPRITE),
            read_back: Arc::new(read_back),
            there_and_back,
            bin,
            project: None,
            accumulate: None,
            uniform,
            tally,
            rects,
            keys,
            numbers,
            sorted_rects,
            digit_counts,
            digit_totals,
            bin_counts,
            lists,
            bins,
        }
    }

    fn memory(&self) -> TiledMemory {
        let bytes = |buffers: &[&wgpu::Buffer]| buffers.iter().map(|buffer| buffer.size()).sum();
        let ([keys, other_keys], [numbers, other_numbers]) = (&self.keys, &self.numbers);
        TiledMemory {
            emitted: 0,
            sprites: bytes(&[&self.uniform, &self.sprites, &self.rects, &self.sorted_rects]),
            keys: bytes(&[keys, other_keys, numbers, other_numbers]),
            counts: bytes(&[&self.digit_counts, &self.digit_totals, &self.bin_counts, &self.tally, &self.read_back]),
            lists: bytes(&[&self.lists, &self.bins]),
        }
    }

    fn bind_project(&mut self, gpu: &Gpu<'_>, tiled: &Tiled, particles: Part) -> wgpu::BindGroup {
        match &self.project {
            Some((bound, group)) if *bound == particles => group.clone(),
            _ => {
                let Self { uniform, sprites, rects, keys, numbers, .. } = self;
                let buffers = [sprites, rects, &keys[0], &numbers[0]].map(wgpu::Buffer::as_entire_binding);
                let own = [uniform.as_entire_binding(), particles.binding()];
                let group = bind(gpu.device, &tiled.layouts.project, own.into_iter().chain(buffers));
                self.project = Some((particles, group.clone()));
                group
            }
        }
    }

    fn bind_accumulate(
        &mut self,
        gpu: &Gpu<'_>,
        tiled: &Tiled,
        format: AccumulationFormat,
        attachments: &[wgpu::TextureView],
        depth: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let [float, byte, weights] = &tiled.unwritten;
        let (float, byte) = match format {
            AccumulationFormat::Rgba16Float => (attachments.first().unwrap_or(float), byte),
            AccumulationFormat::Rgba8Unorm => (float, attachments.first().unwrap_or(byte)),
        };
        let views = [depth, float, byte, attachments.get(1).unwrap_or(weights)];
        match &self.accumulate {
            Some((bound, group)) if bound.iter().eq(views) => group.clone(),
            _ => {
                let Self { uniform, sprites, rects, numbers, lists, bins, .. } = self;
                let buffers = [&*uniform, sprites, rects, &numbers[0], lists, bins];
                let textures = views.map(wgpu::BindingResource::TextureView);
                let resources = buffers.map(wgpu::Buffer::as_entire_binding).into_iter().chain(textures);
                let group = bind(gpu.device, &tiled.layouts.accumulate, resources);
                self.accumulate = Some((views.map(wgpu::TextureView::clone).to_vec(), group.clone()));
                group
            }
        }
    }
}

impl TiledPasses {
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        encoder.clear_buffer(&self.tally, 0, None);
        self.project.record(&mut begin_compute(encoder, "tile_project", timing), &self.groups);
        self.sort.iter().for_each(|sort| sort.record(&mut begin_compute(encoder, "sort", timing)));
        self.bin.record(&mut begin_compute(encoder, "tile_bin", timing));
        self.accumulate.record(&mut begin_compute(encoder, "tile_accumulate", timing), &self.groups);
        self.read_entries(encoder);
    }

    /// Learns how long the lists would have been, for frames to come.
    fn read_entries(&self, encoder: &mut wgpu::CommandEncoder) {
        // The system's share and this frame's; more while one is on its way.
        if Arc::strong_count(&self.read_back) > 2 {
            return;
        }
        encoder.copy_buffer_to_buffer(&self.tally, 0, &self.read_back, 0, 2 * WORD);
        let (read_back, entries) = (self.read_back.clone(), self.entries.clone());
        encoder.map_buffer_on_submit(&self.read_back, wgpu::MapMode::Read, .., move |mapped| {
            if mapped.is_ok() {
                if let Ok(view) = read_back.get_mapped_range(..) {
                    entries.store(
                        bytemuck::pod_read_unaligned(&view[WORD as usize..][..WORD as usize]),
                        Ordering::Relaxed,
                    );
                }
                read_back.unmap();
            }
        });
    }
}

impl Part {
    fn new(limits: &wgpu::Limits, sprites: &Sprites) -> Self {
        let before = sprites.offset % u64::from(limits.min_storage_buffer_offset_alignment);
        let offset = sprites.offset - before;
        Self {
            buffer: sprites.buffer.clone(),
            offset,
            // All of it, so that another number of particles needs no other binding.
            size: (sprites.buffer.size() - offset).min(limits.max_storage_buffer_binding_size) & !3,
            first: (before / PARTICLE_STEP) as u32,
        }
    }

    fn binding(&self) -> wgpu::BindingResource<'_> {
        let Self { buffer, offset, size, .. } = self;
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer,
            offset: *offset,
            size: wgpu::BufferSize::new(*size),
        })
    }
}

/// A bind group of resources in the order of its layout.
pub(super) fn bind<'a>(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("haze tiled"), layout, entries: &entries })
}
