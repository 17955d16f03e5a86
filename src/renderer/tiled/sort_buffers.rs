//! Buffers of a sort.

use super::storage_buffers::{WORD_BYTES, storage};
use super::tiled_pipelines::TiledPipelines;
use crate::renderer::pass::sort::{BLOCK, DIGITS};

/// Keys, the particle indices that belong to them, and digit counts.
#[derive(Debug)]
pub(super) struct SortBuffers {
    /// Two pairs, which the sort uses alternately. It ends in the first.
    keys: [wgpu::Buffer; 2],
    indices: [wgpu::Buffer; 2],
    digit_counts: wgpu::Buffer,
    digit_totals: wgpu::Buffer,
    pub ping_pong: [wgpu::BindGroup; 2],
}

impl SortBuffers {
    /// Creates buffers for `capacity` keys. `uniform` is bound with them.
    pub fn new(device: &wgpu::Device, tiled: &TiledPipelines, uniform: &wgpu::Buffer, capacity: u32) -> Self {
        let words = |name, count| storage(device, name, count, WORD_BYTES);
        let keys = ["haze sort keys", "haze sort keys, sorted"].map(|name| words(name, capacity));
        let indices = ["haze sort indices", "haze sort indices, sorted"].map(|name| words(name, capacity));
        let digit_counts = words("haze digit counts", capacity.div_ceil(BLOCK) * DIGITS);
        let digit_totals = words("haze digit totals", DIGITS);
        let ping_pong = [(0, 1), (1, 0)].map(|(from, to)| {
            let buffers = [uniform, &keys[from], &indices[from], &keys[to], &indices[to], &digit_counts, &digit_totals];
            tiled.passes.sort.bind(buffers.map(wgpu::Buffer::as_entire_binding))
        });
        Self { keys, indices, digit_counts, digit_totals, ping_pong }
    }

    /// Returns the keys of a pair and their indices.
    pub fn pair(&self, pair: usize) -> [&wgpu::Buffer; 2] {
        [&self.keys[pair], &self.indices[pair]]
    }

    /// Returns the bytes of keys and indices, and of counts.
    pub fn bytes(&self) -> [u64; 2] {
        let keys = self.keys.iter().chain(&self.indices).map(wgpu::Buffer::size).sum();
        [keys, self.digit_counts.size() + self.digit_totals.size()]
    }
}
