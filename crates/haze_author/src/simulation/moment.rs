//! A moment of a simulation, as a VDB file.

use glam::{IVec3, UVec3, Vec3};

use super::domain::Domain;
use super::fluid::Fluid;
use super::grid::CellBox;
use crate::vdb::{GridToWrite, GridTransform, VdbWriter};

/// A moment of a simulation.
pub struct Moment<'a> {
    pub(super) fluid: &'a Fluid<'a>,
    /// Number of the moment, from 1.
    pub number: u32,
    pub(super) has_heat: bool,
}

impl Moment<'_> {
    /// Returns the gas as a VDB file: `density`, `temperature` if there is heat, and `vel`, on the grid of the velocity.
    /// Lengths are in box widths, times in seconds; y is up.
    pub fn to_vdb(&self) -> Vec<u8> {
        let Fluid { domain, fine, gas, centered, occupied, .. } = self.fluid;
        let mut writer = VdbWriter::new("haze");
        let gas_at = |voxel: IVec3| gas[fine.grid.index((voxel + 1).as_uvec3())];
        let mut add = |name: &str, value: &dyn Fn(IVec3) -> [f32; 1]| {
            writer.add(&GridToWrite { name, transform: transform(*fine), bounds: voxels(*occupied), value });
        };
        add("density", &|voxel| [gas_at(voxel).x]);
        if self.has_heat {
            add("temperature", &|voxel| [gas_at(voxel).y]);
        }
        let velocity = |voxel: IVec3| centered[domain.grid.index((voxel + 1).as_uvec3())].truncate().to_array();
        writer.add(&GridToWrite {
            name: "vel",
            transform: transform(*domain),
            bounds: voxels(self.cells_with_velocity()),
            value: &velocity,
        });
        writer.finish()
    }

    /// Cells of the velocity around the gas, so that velocities are interpolated everywhere in it.
    fn cells_with_velocity(&self) -> CellBox {
        let Fluid { domain, fine, occupied, .. } = self.fluid;
        if occupied.is_empty() {
            return CellBox::EMPTY;
        }
        let detail = (fine.grid.size / domain.grid.size).max(UVec3::ONE);
        let cell = |cell: UVec3| (cell - 1) / detail + 1;
        CellBox { low: cell(occupied.low), high: cell(occupied.high) }.grown(1, domain.grid)
    }
}

/// First and last voxel of cells, which are numbered from 1; of none if there are none.
fn voxels(cells: CellBox) -> [IVec3; 2] {
    if cells.is_empty() {
        return [IVec3::ZERO, IVec3::NEG_ONE];
    }
    [cells.low, cells.high].map(|cell| cell.as_ivec3() - 1)
}

fn transform(domain: Domain) -> GridTransform {
    GridTransform { voxel: domain.cell_width().into(), offset: domain.position(Vec3::ONE).as_dvec3() }
}
