//! Targets of texel passes.

use haze_core::glam::UVec2;

use haze_core::formula::smoke_tiles::CELL_SIDE;
use haze_core::frame::MAX_LIGHTS;

/// A texture of a system. The pass that writes it declares it; others read it by this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub label: &'static str,
    pub extent: Extent,
    /// Format if render passes write it, which every backend must be able to render to.
    pub drawn: wgpu::TextureFormat,
    /// Format if compute shaders write it.
    pub computed: wgpu::TextureFormat,
}

/// Elements of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Texels of the accumulation target.
    Texels,
    /// Cells of `CELL_SIDE` by `CELL_SIDE` texels.
    Cells,
    /// Pixels of the view.
    Pixels,
    /// Columns for lights, in two rows.
    Lights,
}

impl Extent {
    /// Returns the size that belongs to a number of texels. `scale`: pixels per texel.
    pub fn size(self, texels: UVec2, scale: u32) -> UVec2 {
        match self {
            Self::Texels => texels,
            Self::Cells => texels.map(|side| side.div_ceil(CELL_SIDE)),
            Self::Pixels => texels * scale,
            Self::Lights => UVec2::new(MAX_LIGHTS as u32, 2),
        }
    }
}

/// A target that a pass of a system writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PlannedTarget {
    pub target: Target,
    /// True if compute shaders write it, false if render passes do.
    pub computed: bool,
}

impl PlannedTarget {
    pub fn format(&self) -> wgpu::TextureFormat {
        if self.computed { self.target.computed } else { self.target.drawn }
    }

    pub fn usage(&self) -> wgpu::TextureUsages {
        if self.computed { wgpu::TextureUsages::STORAGE_BINDING } else { wgpu::TextureUsages::RENDER_ATTACHMENT }
    }
}

/// Most targets of a system.
const MAX_TARGETS: usize = 8;

/// Targets of a system. An array, so that a frame allocates nothing to compare them.
pub(crate) type PlannedTargets = [Option<PlannedTarget>; MAX_TARGETS];

/// Collects the targets of a system. `one_of_each_covers_every_pass` checks that none is left out.
pub(crate) fn planned_targets(targets: impl Iterator<Item = PlannedTarget>) -> PlannedTargets {
    let mut planned = [None; MAX_TARGETS];
    planned.iter_mut().zip(targets).for_each(|(slot, target)| *slot = Some(target));
    planned
}
