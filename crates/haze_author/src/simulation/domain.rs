//! Positions in the simulated box.

use glam::Vec3;

use super::grid::{CellBox, Grid};

/// Mapping between coordinates of a grid and positions in box widths.
#[derive(Clone, Copy, Debug)]
pub struct Domain {
    pub grid: Grid,
}

impl Domain {
    /// Width of a cell.
    pub fn cell_width(self) -> f32 {
        1.0 / self.grid.size.x as f32
    }

    /// Position of coordinate 0.5, the corner of the box.
    fn corner(self) -> Vec3 {
        let size = self.grid.size.as_vec3();
        Vec3::new(-0.5, 0.0, -0.5 * size.z / size.x)
    }

    pub fn position(self, coordinate: Vec3) -> Vec3 {
        (coordinate - 0.5) * self.cell_width() + self.corner()
    }

    pub fn coordinate(self, position: Vec3) -> Vec3 {
        (position - self.corner()) * self.grid.size.x as f32 + 0.5
    }

    /// Cells whose centers may be in a box of positions.
    pub fn cells(self, low: Vec3, high: Vec3) -> CellBox {
        let last = self.grid.size.as_vec3();
        let low = self.coordinate(low).floor().max(Vec3::ONE);
        let high = self.coordinate(high).ceil().min(last);
        if low.cmpgt(high).any() {
            return CellBox::EMPTY;
        }
        CellBox { low: low.as_uvec3(), high: high.as_uvec3() }
    }
}
