//! Voxel grid of a bake, a quarter as deep as wide.

use glam::{UVec3, Vec3};

use crate::path_trace::voxel_center;

/// Number of voxels computed together.
pub(super) const LANES: usize = 16;

#[derive(Clone, Copy)]
pub(super) struct VoxelGrid {
    /// Voxels across and up.
    pub size: u32,
    pub depth: u32,
}

impl VoxelGrid {
    pub fn new(size: u32) -> Self {
        Self { size, depth: (size / 4).max(8) }
    }

    pub fn sides(self) -> UVec3 {
        UVec3::new(self.size, self.size, self.depth)
    }

    /// Returns the center of a voxel: x right, y up, z towards the viewer.
    pub fn voxel_center(self, voxel: UVec3) -> Vec3 {
        voxel_center(self.sides(), voxel)
    }

    /// Returns the number of boxes of [`LANES`] voxels along each axis.
    pub fn boxes(self) -> UVec3 {
        self.sides().map(|side| side.div_ceil(LANES as u32))
    }
}
