//! Tiled passes of one system in a frame.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use super::storage_buffers::WORD_BYTES;
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::sort::Sort;
use crate::renderer::pass::tile_accumulate::TileAccumulate;
use crate::renderer::pass::tile_bin::TileBin;
use crate::renderer::pass::tile_gather::TileGather;
use crate::renderer::pass::tile_project::TileProject;
use crate::renderer::pass::tile_refine::TileRefine;

/// Tiled passes of one frame.
#[derive(Debug)]
pub(crate) struct TiledPasses {
    pub(super) groups: Groups,
    pub(super) project: TileProject,
    pub(super) sort: Option<Sort>,
    pub(super) gather: TileGather,
    pub(super) bin: TileBin,
    pub(super) refine: Option<TileRefine>,
    pub(super) accumulate: TileAccumulate,
    pub(super) counters: wgpu::Buffer,
    pub(super) read_back: Arc<wgpu::Buffer>,
    pub(super) entries: Arc<AtomicU32>,
}

impl TiledPasses {
    /// Clears the counters of list entries.
    pub fn clear_counters(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.counters, 0, None);
    }

    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        self.project.record(encoder.compute("tile_project"), &self.groups);
        if let Some(sort) = &self.sort {
            sort.record(encoder.compute("sort"));
        }
        self.record_bin(encoder.compute("tile_bin"));
        if let Some(refine) = &self.refine {
            refine.record(encoder.compute("tile_refine"), &self.groups);
        }
        self.accumulate.record(encoder.compute("tile_accumulate"), &self.groups);
    }

    fn record_bin(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.gather.record(pass);
        self.bin.record(pass);
    }

    /// Reads back how many list entries this frame needs, to size the buffer of later frames.
    pub fn read_entries(&self, encoder: &mut wgpu::CommandEncoder) {
        // One reference belongs to the system, one to this frame. More mean that a read-back is in flight.
        if Arc::strong_count(&self.read_back) > 2 {
            return;
        }
        encoder.copy_buffer_to_buffer(&self.counters, 0, &self.read_back, 0, 2 * WORD_BYTES);
        let read_back = self.read_back.clone();
        let entries = self.entries.clone();
        encoder.map_buffer_on_submit(&self.read_back, wgpu::MapMode::Read, .., move |mapped| {
            if mapped.is_ok() {
                if let Ok(view) = read_back.get_mapped_range(..) {
                    entries.store(
                        bytemuck::pod_read_unaligned(&view[WORD_BYTES as usize..][..WORD_BYTES as usize]),
                        Ordering::Relaxed,
                    );
                }
                read_back.unmap();
            }
        });
    }
}
