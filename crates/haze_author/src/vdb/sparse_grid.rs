//! Sparse grid of values: leaves of 8³ voxels, and larger cubes of one value.

use std::collections::HashMap;

use glam::{DVec3, IVec3};

/// Binary logarithms of the sides of leaves and cubes.
const LEVELS: [u32; 3] = [3, 7, 12];
/// Binary logarithm of the side of a leaf.
const LEAF: u32 = LEVELS[0];
/// Distance to a voxel's center, voxels, below which its value is taken: rounding of transforms is far below.
const SNAP: f64 = 1.0e-6;
/// Largest coordinate of a voxel that is looked up.
const MAX_INDEX: f64 = (1_u32 << 30) as f64;

/// Positions of voxels: the center of voxel `i` is at `i * voxel + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridTransform {
    /// Side of a voxel, units of the file.
    pub voxel: f64,
    /// Center of voxel 0, units of the file.
    pub offset: DVec3,
}

impl GridTransform {
    /// Position of a coordinate in voxels, units of the file.
    pub fn position(&self, index: DVec3) -> DVec3 {
        index * self.voxel + self.offset
    }

    /// Coordinate in voxels of a position.
    pub fn index(&self, position: DVec3) -> DVec3 {
        (position - self.offset) / self.voxel
    }
}

/// Values of a leaf or a cube.
enum Node<const N: usize> {
    Constant([f32; N]),
    /// z first, then y, then x.
    Leaf(Box<[[f32; N]]>),
}

/// Grid of values of `N` numbers.
pub struct SparseGrid<const N: usize> {
    /// Positions of voxels.
    pub transform: GridTransform,
    /// Value of voxels that are not stored.
    pub background: [f32; N],
    /// By side, and by position in units of the side.
    nodes: [HashMap<IVec3, Node<N>>; 3],
}

/// Looks up values, fast where voxels follow each other.
pub struct Sampler<'a, const N: usize> {
    grid: &'a SparseGrid<N>,
    /// Node of the last leaf position that was looked up.
    last: Option<(IVec3, Option<&'a Node<N>>)>,
}

impl<const N: usize> SparseGrid<N> {
    /// Creates a grid that has the background everywhere.
    pub fn new(transform: GridTransform, background: [f32; N]) -> Self {
        Self { transform, background, nodes: Default::default() }
    }

    /// Adds a leaf. `values`: 512, z first. Values that are all the same take no memory.
    pub(super) fn insert_leaf(&mut self, origin: IVec3, values: Vec<[f32; N]>) {
        let first = values.first().copied().unwrap_or(self.background);
        let is_constant = values.len() != 1 << (3 * LEAF) || values.iter().all(|value| is_same(*value, first));
        let node = if is_constant { Node::Constant(first) } else { Node::Leaf(values.into()) };
        self.nodes[0].insert(origin >> LEAF as i32, node);
    }

    /// Adds a cube of one value, whose side has the binary logarithm 3, 7 or 12.
    pub(super) fn insert_cube(&mut self, origin: IVec3, log_side: u32, value: [f32; N]) {
        for (level, nodes) in LEVELS.into_iter().zip(&mut self.nodes) {
            if level == log_side {
                nodes.insert(origin >> level as i32, Node::Constant(value));
            }
        }
    }

    fn node(&self, voxel: IVec3) -> Option<&Node<N>> {
        let mut levels = LEVELS.into_iter().zip(&self.nodes).filter(|(_, nodes)| !nodes.is_empty());
        levels.find_map(|(level, nodes)| nodes.get(&(voxel >> level as i32)))
    }

    /// Returns a sampler.
    pub fn sampler(&self) -> Sampler<'_, N> {
        Sampler { grid: self, last: None }
    }
}

impl SparseGrid<1> {
    /// Returns the largest value that is stored; 0 if none is above.
    pub fn max(&self) -> f32 {
        let mut max = 0.0_f32;
        for node in self.nodes.iter().flat_map(HashMap::values) {
            match node {
                Node::Constant([value]) => max = max.max(*value),
                Node::Leaf(values) => max = values.iter().fold(max, |max, [value]| max.max(*value)),
            }
        }
        max
    }

    /// Returns the first and the last voxel of the box around all stored values above a value.
    pub fn bounds(&self, above: f32) -> Option<[IVec3; 2]> {
        let mut low = IVec3::MAX;
        let mut high = IVec3::MIN;
        for (level, nodes) in LEVELS.into_iter().zip(&self.nodes) {
            for (key, node) in nodes {
                let origin = *key << level as i32;
                match node {
                    Node::Constant([value]) if *value > above => {
                        low = low.min(origin);
                        high = high.max(origin + ((1 << level) - 1));
                    }
                    Node::Constant(_) => {}
                    Node::Leaf(values) => {
                        for (index, _) in (0..).zip(values.iter()).filter(|(_, value)| value[0] > above) {
                            let voxel = origin + voxel_of(index, LEAF);
                            low = low.min(voxel);
                            high = high.max(voxel);
                        }
                    }
                }
            }
        }
        low.cmple(high).all().then_some([low, high])
    }
}

/// True if the bits of two values are the same.
pub fn is_same<const N: usize>(one: [f32; N], other: [f32; N]) -> bool {
    one.map(f32::to_bits) == other.map(f32::to_bits)
}

/// Position of an item within a cube of a side with this binary logarithm, by its index.
pub fn voxel_of(index: usize, log_side: u32) -> IVec3 {
    let mask = (1 << log_side) - 1;
    let [x, y, z] = [2 * log_side, log_side, 0].map(|shift| (index >> shift & mask) as i32);
    IVec3::new(x, y, z)
}

impl<const N: usize> Sampler<'_, N> {
    /// Returns the value of a voxel.
    pub fn value(&mut self, voxel: IVec3) -> [f32; N] {
        let key = voxel >> LEAF as i32;
        let node = match self.last {
            Some((last, node)) if last == key => node,
            _ => self.grid.node(voxel),
        };
        self.last = Some((key, node));
        match node {
            None => self.grid.background,
            Some(Node::Constant(value)) => *value,
            Some(Node::Leaf(values)) => {
                let at = voxel & ((1 << LEAF) - 1);
                values[((at.x << (2 * LEAF)) + (at.y << LEAF) + at.z) as usize]
            }
        }
    }

    /// Returns the value at a coordinate in voxels, interpolated between the centers of eight.
    pub fn sample(&mut self, index: DVec3) -> [f32; N] {
        if !index.is_finite() || index.abs().max_element() > MAX_INDEX {
            return self.grid.background;
        }
        let mut base = index.floor();
        let mut fraction = index - base;
        for axis in 0..3 {
            if fraction[axis] < SNAP {
                fraction[axis] = 0.0;
            } else if fraction[axis] > 1.0 - SNAP {
                fraction[axis] = 0.0;
                base[axis] += 1.0;
            }
        }
        let base = base.as_ivec3();
        if fraction == DVec3::ZERO {
            return self.value(base);
        }
        let mut sum = [0.0; N];
        for corner in 0..8 {
            let step = voxel_of(corner, 1);
            let weights = DVec3::select(step.cmpeq(IVec3::ONE), fraction, 1.0 - fraction);
            let weight = weights.element_product();
            if weight > 0.0 {
                let value = self.value(base + step);
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value * weight as f32);
            }
        }
        sum
    }
}
