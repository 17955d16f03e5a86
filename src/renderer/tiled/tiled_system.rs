//! Tiled state of one system, kept between frames.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use haze_core::formula::tiles::{BITS_PER_WORD, run_count};
use haze_core::formula::uniforms::TilesUniform;
use haze_core::glam::UVec2;

use super::storage_buffers::WORD_BYTES;
use super::tile_buffers::{Capacity, ParticleRange, TileBuffers};
use super::tiled_passes::TiledPasses;
use super::tiled_pipelines::{TiledKeys, TiledPipelines};
use crate::renderer::auto::PathWorkload;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::memory_use::TiledMemory;
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::sort::{BLOCK, Sort};
use crate::renderer::pass::sprite_instances::Sprites;
use crate::renderer::pass::tile_accumulate::{COOPERATIVE_TILE, TileAccumulate, TileAccumulateKey, TraversalMode};
use crate::renderer::pass::tile_bin::TileBin;
use crate::renderer::pass::tile_gather::TileGather;
use crate::renderer::pass::tile_project::TileProject;
use crate::renderer::pass::tile_refine::TileRefine;

/// Minimum number of entries of all lists together.
const MIN_ENTRIES: u32 = 1 << 16;
/// Safety factor on the estimated number of entries, used until a frame has been counted: sprites differ in size.
const ENTRY_SAFETY_FACTOR: f64 = 1.5;

/// Side of a bin, texels: for per-invocation traversal, tuned by how much of a bin's list each tile shows; for
/// cooperative traversal, tuned by how much of the list touches a workgroup's tile; and for more than
/// `LARGE_BIN_PARTICLES` particles, where counting for small bins would cost more than it saves.
const BIN_SIDE_PER_INVOCATION: u32 = 32;
const BIN_SIDE_COOPERATIVE: u32 = 32;
const BIN_SIDE_LARGE: u32 = 64;
const LARGE_BIN_PARTICLES: u32 = 1 << 16;

/// Fewest tiles of a target where an invocation has 2x2 texels. An H200 gains 16 to 36 % at 11,400 and 5 to 26 % at 7,200,
/// and loses at 4,080.
const QUAD_TILES: u32 = 11_000;
/// Most tiles of a target whose texels are shared by four invocations, and by eight; then the same for deep smoke, whose lists
/// are long. With four, an H200 gains at 1,800 tiles, and loses with most presets at 7,200. With eight, an H100 gains with all
/// presets at 120 tiles, and with deep smoke at 460. Smaller GPUs, which were not measured, have enough work with fewer tiles.
const SPLIT_TILES: (u32, u32) = (512, 128);
const SPLIT_TILES_OF_MANY_LAYERS: (u32, u32) = (2048, 512);
const MANY_LAYERS: f64 = 10.0;
/// Fewest sprites for either.
const MIN_SPLIT_SPRITES: f64 = 16.0;
/// Largest mean optical depth for either: `OPAQUE` in `shaders/tile_accumulate.wgsl`.
const OPAQUE_DEPTH: f64 = 10.0 * std::f64::consts::LN_2;

/// Larger than any view depth, metres. Twice this value is still finite in f32.
const BEYOND_ANY_DEPTH: f32 = 1.0e38;

/// Maximum number of workgroups per dimension of a dispatch, on every device.
const MAX_WORKGROUPS: u32 = 65535;

/// Buffers of one system, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct TiledSystem {
    buffers: Option<TileBuffers>,
    idle: IdleCounter,
    /// List entries that a frame some frames ago needed.
    entries: Arc<AtomicU32>,
}

/// Inputs of a system's tiled passes.
pub(crate) struct TiledInputs<'a> {
    pub sprites: &'a Sprites,
    /// Size of the part in use, texels.
    pub size: UVec2,
    /// Textures of the accumulation target, in the order of their roles.
    pub attachments: &'a [wgpu::TextureView],
    /// Depth that sprites are compared with.
    pub depth: &'a wgpu::TextureView,
    pub workload: Option<&'a PathWorkload>,
}

impl TiledSystem {
    /// Prepares buffers and passes for a frame.
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        tiled: &TiledPipelines,
        keys: TiledKeys,
        groups: &Groups,
        inputs: &TiledInputs<'_>,
    ) -> TiledPasses {
        let TiledInputs { sprites, size, attachments, depth, workload } = *inputs;
        let max_words = max_storage_words(&tiled.limits);
        let cooperative = keys.accumulate.is_cooperative();
        let shared = workload.filter(|_| cooperative).map(|workload| shared_traversal(size, workload));
        let traversal = shared.unwrap_or(keys.accumulate.traversal);
        let keys = TiledKeys { accumulate: TileAccumulateKey { traversal, ..keys.accumulate }, ..keys };
        let BinLayout { side: bin_side, columns, rows, runs } =
            BinLayout::new(size, sprites.count, cooperative, max_words);
        let bins = columns * rows;
        let wanted = self.entries.load(Ordering::Relaxed);
        // If the lists do not fit, the image is still correct, but bins without a list iterate over all sprites, which
        // is slow.
        let touched =
            workload.map_or(0.0, |workload| workload.rectangles_touched(f64::from(bin_side), f64::from(bin_side)));
        let expected = (ENTRY_SAFETY_FACTOR * touched * f64::from(sprites.count)) as u32;
        // tile_refine needs as many words again, in whole batches per bin.
        let expected = if cooperative { expected } else { 2 * expected + BITS_PER_WORD * bins };
        let entries = wanted.max(expected).max(MIN_ENTRIES);
        let shaded = if keys.project.sprite.has_values() { sprites.count } else { 1 };
        let needed = Capacity { particles: sprites.count, bins, runs: bins * runs, entries, shaded };
        let buffers = self.ensure(gpu, tiled, needed.rounded_up(max_words));
        let capacity = buffers.capacity.entries;
        let particles = ParticleRange::new(&tiled.limits, sprites);
        let sorts = !keys.project.weighted && !sprites.is_sorted;
        let in_order = keys.project.sprite.is_flat() && (sorts || sprites.by_view_depth) && sprites.loops == 1;
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
            occlusion_margin: if in_order { 0.0 } else { BEYOND_ANY_DEPTH },
            padding: [0; 2],
        };
        gpu.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&uniform));
        let pipelines = tiled.pipelines(keys, sorts, sprites.count);
        let pair = if sorts { tiled.unsorted_pair(sprites.count) } else { 0 };
        let project = buffers.bind_project(tiled, particles, pair);
        let refine = pipelines.refine.map(|pipeline| {
            let inputs = buffers.bind_refine(tiled, depth);
            TileRefine { pipeline, inputs, bins }
        });
        let accumulate = buffers.bind_accumulate(tiled, keys.accumulate.formats(), attachments, depth);
        TiledPasses {
            groups: groups.clone(),
            project: TileProject { pipeline: pipelines.project, inputs: project, particles: sprites.count },
            sort: pipelines.sort.map(|pipelines| Sort {
                pipelines,
                ping_pong: buffers.sort.ping_pong.clone(),
                keys: sprites.count,
            }),
            gather: TileGather { pipeline: pipelines.gather, inputs: buffers.gather.clone(), particles: sprites.count },
            bin: TileBin {
                pipelines: pipelines.bin,
                inputs: buffers.bin.clone(),
                workgroups: buffers.workgroups.clone(),
                bins,
                runs,
            },
            refine,
            accumulate: TileAccumulate { pipeline: pipelines.accumulate, inputs: accumulate, size, traversal },
            counters: buffers.counters.clone(),
            read_back: buffers.read_back.clone(),
            entries: self.entries.clone(),
        }
    }

    /// Returns the bytes of GPU memory held.
    pub fn memory(&self) -> TiledMemory {
        self.buffers.as_ref().map_or(TiledMemory::default(), TileBuffers::memory)
    }

    fn ensure(&mut self, gpu: &Gpu<'_>, tiled: &TiledPipelines, needed: Capacity) -> &mut TileBuffers {
        let is_idle = self.buffers.as_ref().is_some_and(|buffers| buffers.capacity.is_oversized_for(&needed));
        let should_release = self.idle.tick(is_idle);
        if should_release || !self.buffers.as_ref().is_some_and(|buffers| buffers.capacity.holds(&needed)) {
            // Drops the old buffers before it creates new ones.
            self.buffers = None;
        }
        self.buffers.get_or_insert_with(|| TileBuffers::new(gpu.device, tiled, needed))
    }
}

/// Returns how many invocations of a GPU should share each texel of a target. They keep it busy where there are few texels;
/// elsewhere they cost time, as they do where the smoke in front hides the parts behind.
fn shared_traversal(size: UVec2, workload: &PathWorkload) -> TraversalMode {
    let tiles = size.x.div_ceil(COOPERATIVE_TILE.x) * size.y.div_ceil(COOPERATIVE_TILE.y);
    let is_deep = workload.layers() >= MANY_LAYERS;
    let (few, fewest) = if is_deep { SPLIT_TILES_OF_MANY_LAYERS } else { SPLIT_TILES };
    let is_hidden = workload.layers() * workload.optical_depth > OPAQUE_DEPTH;
    if tiles >= QUAD_TILES {
        TraversalMode::Quads
    } else if tiles > few || workload.sprites < MIN_SPLIT_SPRITES || is_hidden {
        TraversalMode::Cooperative
    } else if tiles > fewest {
        TraversalMode::Split
    } else {
        TraversalMode::SplitFinely
    }
}

/// Division of a target into bins, and of its sprites into runs.
struct BinLayout {
    /// Side of a bin, texels.
    side: u32,
    columns: u32,
    rows: u32,
    runs: u32,
}

impl BinLayout {
    /// Doubles the usual side of a bin until all counts fit into a buffer of `max_words` words.
    fn new(size: UVec2, sprites: u32, cooperative: bool, max_words: u32) -> Self {
        let runs = run_count(sprites);
        let mut side = match (cooperative, sprites > LARGE_BIN_PARTICLES) {
            (false, _) => BIN_SIDE_PER_INVOCATION,
            (true, false) => BIN_SIDE_COOPERATIVE,
            (true, true) => BIN_SIDE_LARGE,
        };
        let bins_of = |side| bins_along(size, side).element_product();
        while runs.saturating_mul(bins_of(side)) > max_words || bins_of(side) > MAX_WORKGROUPS {
            side *= 2;
        }
        let UVec2 { x: columns, y: rows } = bins_along(size, side);
        Self { side, columns, rows, runs }
    }
}

/// Returns the number of words in the largest buffer that a shader can read.
fn max_storage_words(limits: &wgpu::Limits) -> u32 {
    (limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / WORD_BYTES).try_into().unwrap_or(u32::MAX)
}

/// Returns the number of bins along the sides of a target.
fn bins_along(size: UVec2, bin_side: u32) -> UVec2 {
    UVec2::new(size.x.div_ceil(bin_side), size.y.div_ceil(bin_side))
}
