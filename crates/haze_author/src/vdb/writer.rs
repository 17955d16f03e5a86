//! Writes files that OpenVDB reads: version 224, float and vector grids, Zip with active masks.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3};

use super::sparse_grid::{GridTransform, voxel_of};
use super::values::{ACTIVE_MASK, ZIP};
use super::vdb_file::MAGIC;

/// Version of the format, and of the first library that wrote it.
const VERSION: u32 = 224;
const LIBRARY: [u32; 2] = [3, 0];
/// Identifier of the file. The same in all files, so that equal smoke makes equal bytes.
const IDENTIFIER: &str = "00000000-0000-0000-0000-000000000000";
/// Effort of the compression, 0 to 10.
const EFFORT: u8 = 6;
/// Bytes of the masks of nodes of 32³, 16³ and 8³ values.
const UPPER_MASK: usize = 4096;
const LOWER_MASK: usize = 512;
const LEAF_MASK: usize = 64;

/// Grid to write, of values of `N` numbers: 1 or 3. Voxels of the value 0 are inactive.
pub struct GridToWrite<'a, const N: usize> {
    /// Name.
    pub name: &'a str,
    /// Positions of voxels.
    pub transform: GridTransform,
    /// First and last voxel. Voxels outside are 0.
    pub bounds: [IVec3; 2],
    /// Value of a voxel.
    pub value: &'a dyn Fn(IVec3) -> [f32; N],
}

/// Contents of a file.
pub struct VdbWriter {
    bytes: Vec<u8>,
    /// Position of the number of grids.
    count_at: usize,
    count: u32,
}

/// Leaf with at least one active voxel.
struct Leaf<const N: usize> {
    active: [u8; LEAF_MASK],
    /// Values of the active voxels.
    values: Vec<[f32; N]>,
}

/// Children of a node by their index, in the order of a file.
type Lower<const N: usize> = BTreeMap<usize, Leaf<N>>;
type Upper<const N: usize> = BTreeMap<usize, Lower<N>>;

impl VdbWriter {
    /// Starts a file without grids. `creator`: name of the program.
    pub fn new(creator: &str) -> Self {
        let mut writer = Self { bytes: MAGIC.to_vec(), count_at: 0, count: 0 };
        for number in [VERSION].into_iter().chain(LIBRARY) {
            writer.u32(number);
        }
        // Grids have positions.
        writer.bytes.push(1);
        writer.bytes.extend_from_slice(IDENTIFIER.as_bytes());
        writer.metadata(&[("creator", creator)]);
        writer.count_at = writer.bytes.len();
        writer.u32(0);
        writer
    }

    /// Adds a grid.
    pub fn add<const N: usize>(&mut self, grid: &GridToWrite<'_, N>) {
        let kind = if N == 1 { "Tree_float_5_4_3" } else { "Tree_vec3s_5_4_3" };
        self.string(grid.name);
        self.string(kind);
        // No grid that it shares its tree with.
        self.string("");
        let positions_at = self.bytes.len();
        self.bytes.extend_from_slice(&[0; 24]);
        let start = self.bytes.len();
        self.u32(ZIP | ACTIVE_MASK);
        let class = if N == 1 { "fog volume" } else { "unknown" };
        self.metadata(&[("class", class), ("name", grid.name)]);
        self.transform(grid.transform);
        let roots = leaves(grid);
        self.topology(&roots);
        let start_of_leaves = self.bytes.len();
        for leaf in roots.values().flat_map(BTreeMap::values).flat_map(BTreeMap::values) {
            self.bytes.extend_from_slice(&leaf.active);
            self.values(&leaf.values);
        }
        let end = self.bytes.len();
        for (index, position) in [start, start_of_leaves, end].into_iter().enumerate() {
            self.set(positions_at + 8 * index, &(position as i64).to_le_bytes());
        }
        self.count += 1;
        self.set(self.count_at, &self.count.to_le_bytes());
    }

    /// Returns the file.
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }

    fn set(&mut self, at: usize, bytes: &[u8]) {
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
    }

    fn u32(&mut self, number: u32) {
        self.bytes.extend_from_slice(&number.to_le_bytes());
    }

    fn string(&mut self, text: &str) {
        self.u32(text.len() as u32);
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn metadata(&mut self, texts: &[(&str, &str)]) {
        self.u32(texts.len() as u32);
        for (name, text) in texts {
            self.string(name);
            self.string("string");
            self.string(text);
        }
    }

    fn transform(&mut self, GridTransform { voxel, offset }: GridTransform) {
        self.string("UniformScaleTranslateMap");
        // The scale, the sides of a voxel, and three vectors that OpenVDB keeps for speed.
        let scales = [voxel, voxel, 1.0 / voxel, 1.0 / (voxel * voxel), 0.5 / voxel];
        for vector in [offset].into_iter().chain(scales.map(DVec3::splat)) {
            vector.to_array().iter().for_each(|number| self.bytes.extend_from_slice(&number.to_le_bytes()));
        }
    }

    fn origin(&mut self, origin: IVec3) {
        origin.to_array().iter().for_each(|number| self.bytes.extend_from_slice(&number.to_le_bytes()));
    }

    fn topology<const N: usize>(&mut self, roots: &BTreeMap<[i32; 3], Upper<N>>) {
        // One buffer, the background, and no cubes.
        self.u32(1);
        self.bytes.extend_from_slice(&[0; 4].repeat(N));
        self.u32(0);
        self.u32(roots.len() as u32);
        for (root, upper) in roots {
            self.origin(IVec3::from(*root) << 12_i32);
            self.node::<N>(UPPER_MASK, upper.keys());
            for lower in upper.values() {
                self.node::<N>(LOWER_MASK, lower.keys());
                lower.values().for_each(|leaf| self.bytes.extend_from_slice(&leaf.active));
            }
        }
    }

    /// Writes the masks of a node that has children and no active values.
    fn node<'k, const N: usize>(&mut self, mask_bytes: usize, children: impl Iterator<Item = &'k usize>) {
        let mut mask = vec![0; mask_bytes];
        children.for_each(|index| mask[index / 8] |= 1 << (index % 8));
        self.bytes.extend_from_slice(&mask);
        self.bytes.extend_from_slice(&vec![0; mask_bytes]);
        self.values::<N>(&[]);
    }

    /// Writes the active values of a node whose inactive ones are the background.
    fn values<const N: usize>(&mut self, values: &[[f32; N]]) {
        self.bytes.push(0);
        let raw: Vec<u8> = values.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(&raw, EFFORT);
        // A number below 0 is that of bytes that are not compressed.
        let (count, bytes) =
            if packed.len() < raw.len() { (packed.len() as i64, packed) } else { (-(raw.len() as i64), raw) };
        self.bytes.extend_from_slice(&count.to_le_bytes());
        self.bytes.extend_from_slice(&bytes);
    }
}

/// Returns the leaves with active voxels, by the position of their child of the root, and their indices below it.
fn leaves<const N: usize>(grid: &GridToWrite<'_, N>) -> BTreeMap<[i32; 3], Upper<N>> {
    let mut roots: BTreeMap<[i32; 3], Upper<N>> = BTreeMap::new();
    let [low, high] = grid.bounds;
    let [first, last] = grid.bounds.map(|voxel| voxel >> 3_i32);
    for x in first.x..=last.x {
        for y in first.y..=last.y {
            for z in first.z..=last.z {
                let origin = IVec3::new(x, y, z) << 3_i32;
                let mut leaf = Leaf { active: [0; LEAF_MASK], values: Vec::new() };
                for index in 0..512 {
                    let voxel = origin + voxel_of(index, 3);
                    let is_inside = voxel.cmpge(low).all() && voxel.cmple(high).all();
                    let value = if is_inside { (grid.value)(voxel) } else { [0.0; N] };
                    if value.iter().any(|number| *number != 0.0) {
                        leaf.active[index / 8] |= 1 << (index % 8);
                        leaf.values.push(value);
                    }
                }
                if !leaf.values.is_empty() {
                    let upper = roots.entry((origin >> 12_i32).to_array()).or_default();
                    upper.entry(index_of(origin >> 7_i32, 5)).or_default().insert(index_of(origin >> 3_i32, 4), leaf);
                }
            }
        }
    }
    roots
}

/// Index of an item within a node that has `1 << log_side` along each side.
fn index_of(item: IVec3, log_side: u32) -> usize {
    let [x, y, z] = (item & ((1 << log_side) - 1)).to_array();
    ((x << (2 * log_side)) + (y << log_side) + z) as usize
}
