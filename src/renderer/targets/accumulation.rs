//! Accumulation target of a system, and the targets of its texel passes.

use std::sync::Arc;

use haze_core::glam::UVec2;
use haze_core::settings::AccumulationFormat;
use haze_core::view_setup::AttachmentSet;
use wgpu::TextureUsages;

use super::attachments::{Attachment, attachments};
use super::target::{Extent, PlannedTargets, Target};
use super::texture_allocator::TextureAllocator;
use crate::renderer::gpu::idle_counter::IdleCounter;

/// Properties that decide, in addition to the size, whether a system's textures can be reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AccumulationKey {
    pub format: AccumulationFormat,
    pub attachments: AttachmentSet,
    /// True if the textures must have the size of the host's.
    pub is_host_sized: bool,
    /// True if layers are counted as well.
    pub overdraw: bool,
    /// True if compute shaders write the attachments.
    pub tiled: bool,
    /// Pixels per texel, if one of `targets` has pixels.
    pub pixels_scale: Option<u32>,
    /// Targets of the texel passes.
    pub targets: PlannedTargets,
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
    /// Targets of the texel passes.
    written: Vec<(Target, wgpu::TextureView)>,
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

    /// Returns a texture, if a pass of the system writes it.
    pub fn get(&self, target: &Target) -> Option<&wgpu::TextureView> {
        self.written.iter().find(|(written, _)| written == target).map(|(_, view)| view)
    }

    /// Returns a texture, or the first attachment if no pass of the system writes it: bindings that no shader reads must be
    /// filled.
    pub fn get_or_first(&self, target: &Target) -> &wgpu::TextureView {
        self.get(target).unwrap_or(&self.attachments[0])
    }

    /// Returns the size of the part of a target that belongs to `texels`.
    pub fn size_in_use(&self, extent: Extent, texels: UVec2) -> UVec2 {
        extent.size(texels, self.key.pixels_scale.unwrap_or(1))
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
        let mut create = |set, tiled| -> Arc<[_]> {
            textures.written = if tiled { TextureUsages::STORAGE_BINDING } else { TextureUsages::RENDER_ATTACHMENT };
            let mut texture = |row: &Attachment| {
                let format = if tiled { row.tiled_format(key.format) } else { row.raster_format(key.format) };
                textures.create_whole(row.label, format, size)
            };
            attachments(set).map(&mut texture).collect()
        };
        let attachments = create(key.attachments, key.tiled);
        // Layers are always counted by hardware blending.
        let overdraw = key.overdraw.then(|| create(AttachmentSet::NORMAL_AND_AMOUNT, false));
        let largest = UVec2::splat(device.limits().max_texture_dimension_2d);
        let mut written = Vec::new();
        for planned in key.targets.into_iter().flatten() {
            textures.written = planned.usage();
            let size = planned.target.extent.size(size, key.pixels_scale.unwrap_or(1)).min(largest);
            let texture = textures.create_whole(planned.target.label, planned.format(), size);
            written.push((planned.target, texture));
        }
        let bytes = textures.bytes;
        Self { key, size, idle: IdleCounter::default(), attachments, overdraw, written, bytes }
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
        let mut size = UVec2::splat(64);
        let mut renewals = 0;
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
