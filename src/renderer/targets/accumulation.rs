//! Accumulation target of a system, and the depth that its sprites are compared with.

use std::sync::Arc;

use glam::UVec2;
use wgpu::TextureUsages;

use super::attachments::{Attachment, attachments};
use super::texture_allocator::TextureAllocator;
use crate::formula::smoke_tiles::CELL_SIDE;
use crate::frame::MAX_LIGHTS;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::settings::AccumulationFormat;
use crate::view_setup::AttachmentSet;

/// A depth format, so that it can be attached and the hardware rejects hidden sprites. Every backend can render to it,
/// which does not hold for `R32Float`.
pub(crate) const REDUCED_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Format of the reduced depth if compute shaders write it, which no device can do to a depth format.
pub(crate) const COMPUTED_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Format of the copy that OpenGL tests against: half the size of the reduced depth, to limit the memory per system.
pub(crate) const DEPTH_COPY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// Format of lit smoke: light is HDR, whatever the format of the normals.
pub(crate) const LIT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Format of the cells with smoke and with slopes, if they are drawn: every backend can render to it.
pub(crate) const DRAWN_CELLS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Format of the cells if compute shaders mark them, and of the glow of lights.
pub(crate) const CELLS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
pub(crate) const GLOWS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Properties that decide, in addition to the size, whether a system's textures can be reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AccumulationKey {
    pub format: AccumulationFormat,
    pub attachments: AttachmentSet,
    /// True if the textures must have the size of the host's.
    pub is_host_sized: bool,
    /// True if sprites are compared with a reduced depth.
    pub reduced_depth: bool,
    /// True if layers are counted as well.
    pub overdraw: bool,
    /// True if smoke is lit at this resolution.
    pub lit: bool,
    /// True if slopes of the lit smoke are needed.
    pub depth_slopes: bool,
    /// True if the backend cannot test what it samples, so that a copy of the reduced depth is needed.
    pub depth_copy: bool,
    /// True if compute shaders write the target.
    pub tiled: bool,
    /// True if compute shaders write the reduced depth.
    pub computes_depth: bool,
    /// True if compute shaders light the target and fit its slopes.
    pub computes_texels: bool,
    /// Pixels per texel, if compute shaders write lit smoke at full resolution as well.
    pub pixels_scale: Option<u32>,
}

/// Textures of one system. The part in use starts at (0, 0) and has the size of the system's screen rectangle.
#[derive(Debug)]
pub(crate) struct AccumulationTarget {
    key: AccumulationKey,
    size: UVec2,
    idle: IdleCounter,
    /// In the order of their roles.
    pub attachments: Arc<[wgpu::TextureView]>,
    /// Counted layers, in the format of the first attachment.
    pub overdraw: Option<Arc<[wgpu::TextureView]>>,
    /// Light times amount in rgb and amount in a, if smoke is lit at this resolution.
    pub lit: Option<wgpu::TextureView>,
    /// Cells of the lit smoke that hold some.
    pub smoke_cells: Option<wgpu::TextureView>,
    /// Glow of lights, if compute shaders light the smoke.
    pub glows: Option<wgpu::TextureView>,
    /// Change of the lit smoke with depth.
    pub depth_slopes: Option<wgpu::TextureView>,
    /// Cells with such a change.
    pub slope_cells: Option<wgpu::TextureView>,
    /// Lit smoke at full resolution, if compute shaders upsample it.
    pub pixels: Option<wgpu::TextureView>,
    /// `None` if sprites are compared with the host's own depth.
    pub reduced_depth: Option<wgpu::TextureView>,
    /// Coarser copy of the reduced depth, if the backend cannot test what it samples.
    pub depth_copy: Option<wgpu::TextureView>,
    pub bytes: u64,
}

impl AccumulationTarget {
    /// Makes the target fit `size` texels. `limit`: size of the whole view at this scale; the textures never need to be
    /// larger. Returns the target, and true if it is new.
    pub fn ensure<'a>(
        target: &'a mut Option<Self>,
        device: &wgpu::Device,
        key: AccumulationKey,
        size: UVec2,
        limit: UVec2,
    ) -> (&'a Self, bool) {
        let old = target.as_ref().filter(|target| target.key == key).map_or(UVec2::ZERO, |target| target.size);
        if !target.as_mut().is_some_and(|target| target.key == key && target.is_suitable_for(size)) {
            // Drops the old textures before it creates new ones.
            *target = None;
        }
        let is_new = target.is_none();
        let target = target.get_or_insert_with(|| {
            // All attachments of a pass must have one size: with the host's depth, the host's size.
            Self::new(device, key, if key.is_host_sized { size } else { grown_size(old, size).min(limit) })
        });
        (target, is_new)
    }

    /// Returns the roles of the textures.
    pub fn roles(&self) -> AttachmentSet {
        self.key.attachments
    }

    /// Returns the number of pixels of `texels` that compute shaders write.
    pub fn pixels_in_use(&self, texels: UVec2) -> UVec2 {
        texels * self.key.pixels_scale.unwrap_or(0)
    }

    /// Returns true if the textures hold `size` texels and have not been much too large for more than 120 frames.
    fn is_suitable_for(&mut self, size: UVec2) -> bool {
        if self.key.is_host_sized {
            return self.size == size;
        }
        let is_idle = self.size.element_product() > 4 * padded(size).element_product();
        let tick = self.idle.tick(is_idle);
        size.cmple(self.size).all() && !tick
    }

    fn new(device: &wgpu::Device, key: AccumulationKey, size: UVec2) -> Self {
        let mut textures = TextureAllocator { device, bytes: 0, written: TextureUsages::RENDER_ATTACHMENT };
        let written =
            |computed| if computed { TextureUsages::STORAGE_BINDING } else { TextureUsages::RENDER_ATTACHMENT };
        let mut create = |set, tiled| -> Arc<[_]> {
            textures.written = written(tiled);
            let mut texture = |row: &Attachment| {
                let format = if tiled { row.tiled_format(key.format) } else { row.raster_format(key.format) };
                textures.create_whole(row.label, format, size)
            };
            attachments(set).map(&mut texture).collect()
        };
        let attachments = create(key.attachments, key.tiled);
        // Layers are always counted by hardware blending.
        let overdraw = key.overdraw.then(|| create(AttachmentSet::NORMAL_AND_AMOUNT, false));
        textures.written = written(key.computes_texels);
        let lit = key.lit.then(|| textures.create_whole("haze lit smoke", LIT_FORMAT, size));
        let cells_format = if key.computes_texels { CELLS_FORMAT } else { DRAWN_CELLS_FORMAT };
        let cells = size.map(|side| side.div_ceil(CELL_SIDE));
        let smoke_cells = key.lit.then(|| textures.create_whole("haze smoke cells", cells_format, cells));
        let lights = UVec2::new(MAX_LIGHTS as u32, 2);
        let computes_light = key.lit && key.computes_texels;
        let glows = computes_light.then(|| textures.create_whole("haze glows", GLOWS_FORMAT, lights));
        let depth_slopes = key.depth_slopes.then(|| textures.create_whole("haze depth slopes", LIT_FORMAT, size));
        // mark_cells writes both kinds of cells, even without slopes.
        let has_slope_cells = key.depth_slopes || (key.lit && !key.computes_texels);
        let slope_cells = has_slope_cells.then(|| textures.create_whole("haze slope cells", cells_format, cells));
        let pixels = key.pixels_scale.map(|scale| {
            let side = device.limits().max_texture_dimension_2d;
            textures.create_whole("haze lit pixels", LIT_FORMAT, (size * scale).min(UVec2::splat(side)))
        });
        textures.written = written(key.computes_depth);
        let depth_format = if key.computes_depth { COMPUTED_DEPTH_FORMAT } else { REDUCED_DEPTH_FORMAT };
        let reduced_depth = key.reduced_depth.then(|| textures.create_whole("haze reduced depth", depth_format, size));
        textures.written = TextureUsages::RENDER_ATTACHMENT;
        let depth_copy = (key.reduced_depth && key.depth_copy)
            .then(|| textures.create_whole("haze depth copy", DEPTH_COPY_FORMAT, size));
        let bytes = textures.bytes;
        Self {
            key,
            size,
            idle: IdleCounter::default(),
            attachments,
            overdraw,
            lit,
            smoke_cells,
            glows,
            depth_slopes,
            slope_cells,
            pixels,
            reduced_depth,
            depth_copy,
            bytes,
        }
    }
}

/// Rounds up to multiples of 64 texels, so that a box that grows or moves slightly keeps its textures.
fn padded(size: UVec2) -> UVec2 {
    let step = |side: u32| side.next_multiple_of(64);
    UVec2::new(step(size.x), step(size.y))
}

/// Returns the size of new textures. A side that is too short becomes at least half as long again, so that a growing
/// box does not need new textures every few frames. A side that is long enough stays, unless the area would exceed four
/// times the needed area.
fn grown_size(old: UVec2, needed: UVec2) -> UVec2 {
    let side = |old: u32, needed: u32| if needed <= old { old } else { needed.max(old + old / 2) };
    let grown = padded(UVec2::new(side(old.x, needed.x), side(old.y, needed.y)));
    if grown.element_product() > 4 * padded(needed).element_product() { padded(needed) } else { grown }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steadily_growing_box_needs_new_textures_only_a_few_times() {
        let (mut size, mut renewals) = (UVec2::splat(64), 0);
        for side in 64..2000 {
            let needed = UVec2::new(side, 64 + side / 3);
            if needed.cmpgt(size).any() {
                size = grown_size(size, needed);
                renewals += 1;
            }
            assert!(needed.cmple(size).all() && size.element_product() <= 4 * padded(needed).element_product());
        }
        // log(2000 / 64) / log(1.5) = 8.5 for each side; steps of 64 texels would need 31.
        assert!(renewals <= 17, "{renewals}");
    }
}
