//! Volume of a frame's shadow: optical depths from the cells of its density grid to its lights, and the lights' visibility
//! past the scene.

use std::ops::{Add, Mul};

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
    /// Optical depths towards a block of lights at a position, in cells, clamped to the centers of the outermost cells.
    pub fn sample(&self, block: usize, position: Vec3) -> Vec3 {
        self.blocks.get(block).map_or(Vec3::ZERO, |cells| self.sample_cells(cells, position))
    }

    /// Visibility of a block of lights at a position, in cells; 1 without shadow maps.
    pub fn sample_visible(&self, block: usize, position: Vec3) -> Vec3 {
        let cells = self.visible.as_ref().and_then(|blocks| blocks.get(block));
        cells.map_or(Vec3::ONE, |cells| self.sample_cells(cells, position))
    }

    /// Openness to sky and ground at a position, in cells; 1 if smoke does not shade ambient light.
    pub fn sample_openness(&self, position: Vec3) -> Vec3 {
        self.openness.as_ref().map_or(Vec3::ONE, |cells| self.sample_cells(cells, position))
    }

    fn sample_cells(&self, cells: &[Vec3], position: Vec3) -> Vec3 {
        trilinear(self.size, cells, position.clamp(Vec3::splat(0.5), self.size.as_vec3() - 0.5))
    }
}

/// Value at a position, in cells, between the centers of eight cells, x first; 0 outside the grid. `sample_density()` in
/// shadow_march.wgsl and shadow_march_slice.wgsl.
pub fn trilinear<T>(size: UVec3, cells: &[T], position: Vec3) -> T
where
    T: Copy + Default + Add<Output = T> + Mul<f32, Output = T>,
{
    let low = (position - 0.5).floor();
    let high_weight = position - 0.5 - low;
    let low_weight = 1.0 - high_weight;
    let low = low.as_ivec3();
    let size = size.as_ivec3();
    let mut sum = T::default();
    if low.cmpge(IVec3::ZERO).all() && (low + 1).cmplt(size).all() {
        // The usual case, in the same order as below.
        let row = ((low.z * size.y + low.y) * size.x + low.x) as usize;
        let next_y = size.x as usize;
        let next_z = (size.y * size.x) as usize;
        for (row, weight_z) in [(row, low_weight.z), (row + next_z, high_weight.z)] {
            for (row, weight_y) in [(row, low_weight.y), (row + next_y, high_weight.y)] {
                if let Some([first, second]) = cells.get(row..row + 2) {
                    sum = sum + *first * low_weight.x * weight_y * weight_z;
                    sum = sum + *second * high_weight.x * weight_y * weight_z;
                }
            }
        }
        return sum;
    }
    for (z, weight_z) in [(low.z, low_weight.z), (low.z + 1, high_weight.z)] {
        for (y, weight_y) in [(low.y, low_weight.y), (low.y + 1, high_weight.y)] {
            if !(0..size.y).contains(&y) || !(0..size.z).contains(&z) {
                continue;
            }
            let row = (z * size.y + y) * size.x;
            for (x, weight_x) in [(low.x, low_weight.x), (low.x + 1, high_weight.x)] {
                let cell = cells.get((row + x) as usize).filter(|_| (0..size.x).contains(&x));
                sum = cell.map_or(sum, |cell| sum + *cell * weight_x * weight_y * weight_z);
            }
        }
    }
    sum
}
