//! Volume of a frame's shadow: optical depths from the cells of its density grid to its lights, and the lights' visibility
//! past the scene.

use glam::{IVec3, UVec3, Vec3};

/// Optical depths from the cells of a frame's density grid to its lights with shadow.
pub struct OpticalDepths {
    /// Number of cells along each axis.
    pub size: UVec3,
    /// Cells of each block of lights, x first; a channel per light.
    pub blocks: Vec<Vec<Vec3>>,
    /// Visibility of the lights of each block, if shadow maps shade smoke.
    pub visible: Option<Vec<Vec<Vec3>>>,
    /// Openness to sky and ground in x and y, if smoke shades ambient light.
    pub openness: Option<Vec<Vec3>>,
}

impl OpticalDepths {
    /// Optical depths towards a block of lights at a place, in cells, clamped to the centres of the outermost cells.
    pub fn sample(&self, block: usize, place: Vec3) -> Vec3 {
        self.blocks.get(block).map_or(Vec3::ZERO, |cells| self.sample_cells(cells, place))
    }

    /// Visibility of a block of lights at a place, in cells; 1 without shadow maps.
    pub fn sample_visible(&self, block: usize, place: Vec3) -> Vec3 {
        let cells = self.visible.as_ref().and_then(|blocks| blocks.get(block));
        cells.map_or(Vec3::ONE, |cells| self.sample_cells(cells, place))
    }

    /// Openness to sky and ground at a place, in cells; 1 if smoke does not shade ambient light.
    pub fn sample_openness(&self, place: Vec3) -> Vec3 {
        self.openness.as_ref().map_or(Vec3::ONE, |cells| self.sample_cells(cells, place))
    }

    fn sample_cells(&self, cells: &[Vec3], place: Vec3) -> Vec3 {
        let inside = place.clamp(Vec3::splat(0.5), self.size.as_vec3() - 0.5);
        let load = |cell: IVec3, channel: usize| {
            cell_index(self.size, cell).and_then(|index| cells.get(index)).map_or(0.0, |depths| depths[channel])
        };
        Vec3::from([0, 1, 2].map(|channel| trilinear(inside, |cell| load(cell, channel))))
    }
}

/// Index of a cell; `None` outside the grid.
pub fn cell_index(size: UVec3, cell: IVec3) -> Option<usize> {
    let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(size.as_ivec3()).all();
    let at = cell.as_uvec3();
    inside.then(|| ((at.z * size.y + at.y) * size.x + at.x) as usize)
}

/// Value at a place, in cells, between the centres of eight cells. `sample_density()` in shadow_march.wgsl
/// and shadow_march_slice.wgsl.
pub fn trilinear(place: Vec3, load: impl Fn(IVec3) -> f32) -> f32 {
    let low = (place - 0.5).floor();
    let high_weight = place - 0.5 - low;
    let low_weight = 1.0 - high_weight;
    let mut sum = 0.0;
    for corner in 0..8 {
        let offset = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
        let weight = Vec3::select(offset.cmpeq(IVec3::ONE), high_weight, low_weight);
        sum += load(low.as_ivec3() + offset) * weight.x * weight.y * weight.z;
    }
    sum
}
