//! Tree of a grid: a root, nodes of 32³ and 16³ children, and leaves of 8³ voxels.

use glam::IVec3;

use super::sparse_grid::{GridTransform, SparseGrid, is_same, voxel_of};
use super::values::{ValueFormat, is_set};
use crate::bytes::Bytes;

/// Most numbers of all leaves and cubes of a grid: 1 GiB.
pub const MAX_NUMBERS: usize = 1 << 28;
/// Binary logarithms of the children along a side of the nodes below the root, and of the sides of these children.
const UPPER: [u32; 2] = [5, 7];
const LOWER: [u32; 2] = [4, 3];
/// Binary logarithm of the side of a child of the root.
const ROOT_CHILD: u32 = 12;
/// Bytes of the mask of a leaf.
const LEAF_MASK: usize = 64;
/// Numbers that an entry for a cube takes about as much memory as.
const CUBE_NUMBERS: usize = 16;
/// Largest coordinate, voxels: sums of two stay within 32 bits.
const MAX_COORDINATE: i32 = 1 << 29;

/// Reads one tree.
pub struct TreeReader<'a, const N: usize> {
    bytes: Bytes<'a>,
    format: ValueFormat<N>,
    grid: SparseGrid<N>,
    /// Origins of the leaves, in their order.
    leaves: Vec<IVec3>,
    numbers: usize,
}

impl<'a, const N: usize> TreeReader<'a, N> {
    /// Reads the tree. The background of `format` is replaced.
    pub fn read(
        mut bytes: Bytes<'a>,
        mut format: ValueFormat<N>,
        transform: GridTransform,
    ) -> Result<SparseGrid<N>, String> {
        let buffers = bytes.i32()?;
        if buffers != 1 {
            return Err(format!("{buffers} buffers in a leaf; expected 1"));
        }
        format.background = format.value(&mut bytes)?;
        let grid = SparseGrid::new(transform, format.background);
        let mut reader = Self { bytes, format, grid, leaves: Vec::new(), numbers: 0 };
        reader.topology()?;
        for origin in std::mem::take(&mut reader.leaves) {
            reader.leaf(origin)?;
        }
        Ok(reader.grid)
    }

    /// Reads the nodes, cubes and masks.
    fn topology(&mut self) -> Result<(), String> {
        let cubes = self.bytes.u32()?;
        let children = self.bytes.u32()?;
        for _ in 0..cubes {
            let origin = self.origin()?;
            let value = self.format.value(&mut self.bytes)?;
            // An inactive cube has a value too.
            let _is_active = self.bytes.u8()?;
            self.cube(origin, ROOT_CHILD, value)?;
        }
        for _ in 0..children {
            let origin = self.origin()?;
            self.node(origin, UPPER)?;
        }
        Ok(())
    }

    fn origin(&mut self) -> Result<IVec3, String> {
        let origin = IVec3::new(self.bytes.i32()?, self.bytes.i32()?, self.bytes.i32()?);
        // The most negative number has no absolute value.
        let is_near = origin.cmpge(IVec3::splat(-MAX_COORDINATE)) & origin.cmple(IVec3::splat(MAX_COORDINATE));
        if !is_near.all() || origin & ((1 << ROOT_CHILD) - 1) != IVec3::ZERO {
            let side = 1 << ROOT_CHILD;
            return Err(format!("a node at {origin}; expected multiples of {side}, at most {MAX_COORDINATE}"));
        }
        Ok(origin)
    }

    /// Reads a node of `1 << log_children` children or cubes along each side, of the side `1 << log_side`.
    fn node(&mut self, origin: IVec3, [log_children, log_side]: [u32; 2]) -> Result<(), String> {
        let count = 1_usize << (3 * log_children);
        let children = self.bytes.take(count / 8)?;
        let active = self.bytes.take(count / 8)?;
        let values = self.format.array(&mut self.bytes, active)?;
        let origin_of = |index| origin + (voxel_of(index, log_children) << log_side as i32);
        for (index, value) in values.into_iter().enumerate() {
            if !is_set(children, index) {
                self.cube(origin_of(index), log_side, value)?;
            }
        }
        for index in (0..count).filter(|index| is_set(children, *index)) {
            if log_side == UPPER[1] {
                self.node(origin_of(index), LOWER)?;
            } else {
                // The mask is repeated with the values.
                self.bytes.take(LEAF_MASK)?;
                self.leaves.push(origin_of(index));
            }
        }
        Ok(())
    }

    fn cube(&mut self, origin: IVec3, log_side: u32, value: [f32; N]) -> Result<(), String> {
        if is_same(value, self.format.background) {
            return Ok(());
        }
        self.count(CUBE_NUMBERS)?;
        self.grid.insert_cube(origin, log_side, value);
        Ok(())
    }

    fn leaf(&mut self, origin: IVec3) -> Result<(), String> {
        let active = self.bytes.take(LEAF_MASK)?;
        let values = self.format.array(&mut self.bytes, active)?;
        self.count(values.len() * N)?;
        self.grid.insert_leaf(origin, values);
        Ok(())
    }

    fn count(&mut self, numbers: usize) -> Result<(), String> {
        self.numbers += numbers;
        if self.numbers > MAX_NUMBERS {
            return Err(format!("more than {MAX_NUMBERS} numbers; expected a coarser grid"));
        }
        Ok(())
    }
}
