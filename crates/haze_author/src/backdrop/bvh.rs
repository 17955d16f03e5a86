//! Bounding volume hierarchy over triangles. A shader reads the same nodes.
//!
//! Nodes lie in depth-first order. A node that a ray misses is left by its `skip`, so that a traversal needs no stack.

use std::ops::RangeInclusive;

use glam::Vec3;

/// Most triangles of a leaf.
const LEAF_SIZE: usize = 4;
/// Bins per axis of the surface area heuristic. (Wald, "On fast construction of SAH-based bounding volume hierarchies",
/// 2007)
const BINS: usize = 12;
/// Determinant, relative to the edges, below which a ray counts as parallel to a triangle.
const PARALLEL: f32 = 1.0e-12;

/// Node of a hierarchy: two texels of four floats.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BvhNode {
    /// Lower corner.
    pub min: Vec3,
    /// Index of the node after this one and all below it.
    pub skip: f32,
    /// Upper corner.
    pub max: Vec3,
    /// 8 · first triangle + number of triangles, in the order of [`Bvh::triangles`]; 0 for an inner node.
    pub leaf: f32,
}

/// Hierarchy over triangles; see the module's documentation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    /// Nodes in depth-first order. Floats hold their indices exactly: there are fewer than 2^24.
    pub nodes: Vec<BvhNode>,
    /// Indices of the triangles in the order of the leaves.
    pub triangles: Vec<u32>,
}

/// Ray of points `origin + distance · direction`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Point at distance 0.
    pub origin: Vec3,
    /// Unit of distances; its length may be other than 1.
    pub direction: Vec3,
}

/// Triangle as a ray is tested against it.
#[derive(Clone, Copy, Debug)]
pub struct RayTriangle {
    /// First corner.
    pub corner: Vec3,
    /// Edges from it to the other two.
    pub edges: [Vec3; 2],
}

/// Intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Index of the triangle.
    pub triangle: u32,
    /// Distance in lengths of the ray's direction.
    pub distance: f32,
    /// Weights of the second and third corner.
    pub weights: [f32; 2],
}

#[derive(Clone, Copy)]
struct Extent {
    min: Vec3,
    max: Vec3,
}

impl Extent {
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn with(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn middle(self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    fn area(self) -> f32 {
        let size = (self.max - self.min).max(Vec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

impl Bvh {
    /// Builds a hierarchy over triangles of finite corners.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let extent = |&[a, b, c]: &[Vec3; 3]| Extent { min: a.min(b).min(c), max: a.max(b).max(c) };
        let extents: Vec<_> = triangles.iter().map(extent).collect();
        let mut order: Vec<_> = (0..triangles.len() as u32).collect();
        let mut nodes: Vec<BvhNode> = Vec::new();
        // Ranges of `order` that have no node yet, and nodes that end before the next range.
        let mut open = vec![Step::Build(0, order.len())];
        while let Some(step) = open.pop() {
            let (first, end) = match step {
                Step::Close(node) => {
                    nodes[node].skip = nodes.len() as f32;
                    continue;
                }
                Step::Build(first, end) if first < end => (first, end),
                Step::Build(..) => continue,
            };
            let range = &mut order[first..end];
            let all = range.iter().fold(Extent::EMPTY, |all, &index| all.with(extents[index as usize]));
            let node = nodes.len();
            open.push(Step::Close(node));
            let count = end - first;
            let leaf = if count <= LEAF_SIZE { (8 * first + count) as f32 } else { 0.0 };
            nodes.push(BvhNode { min: all.min, skip: 0.0, max: all.max, leaf });
            if count > LEAF_SIZE {
                let middle = first + split(range, &extents);
                open.extend([Step::Build(middle, end), Step::Build(first, middle)]);
            }
        }
        Self { nodes, triangles: order }
    }

    /// Returns the nearest triangle whose distance is in a range. `triangle` gives the corners of one, and `is_solid`
    /// whether a hit counts.
    pub fn nearest(
        &self,
        ray: Ray,
        distances: RangeInclusive<f32>,
        triangle: impl Fn(u32) -> RayTriangle,
        is_solid: impl Fn(&RayHit) -> bool,
    ) -> Option<RayHit> {
        let Ray { origin, direction } = ray;
        let near = *distances.start();
        let mut far = *distances.end();
        let mut nearest = None;
        self.traverse(origin, direction, |index, reach| {
            let found = index.and_then(|index| intersect(&triangle(index), index, origin, direction));
            if let Some(hit) = found.filter(|hit| (near..=far).contains(&hit.distance) && is_solid(hit)) {
                far = hit.distance;
                nearest = Some(hit);
            }
            index.is_some() || reach.0 <= far && reach.1 >= near
        });
        nearest
    }

    /// True if a triangle lies at a distance from 0 to `far`.
    pub fn is_blocked(
        &self,
        ray: Ray,
        far: f32,
        triangle: impl Fn(u32) -> RayTriangle,
        is_solid: impl Fn(&RayHit) -> bool,
    ) -> bool {
        let Ray { origin, direction } = ray;
        let mut is_blocked = false;
        self.traverse(origin, direction, |index, reach| {
            let found = index.and_then(|index| intersect(&triangle(index), index, origin, direction));
            is_blocked |= found.is_some_and(|hit| (0.0..=far).contains(&hit.distance) && is_solid(&hit));
            !is_blocked && (index.is_some() || reach.0 <= far && reach.1 >= 0.0)
        });
        is_blocked
    }

    /// Calls `visit` for each node that a ray meets, with the distances between which it is inside, and for each triangle
    /// of a leaf. A node is left if `visit` returns false for it; so is the rest of a leaf.
    fn traverse(&self, origin: Vec3, direction: Vec3, mut visit: impl FnMut(Option<u32>, (f32, f32)) -> bool) {
        let tiny = Vec3::splat(1.0e-12);
        let inverse = Vec3::select(direction.abs().cmplt(tiny), tiny, direction).recip();
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let a = (node.min - origin) * inverse;
            let b = (node.max - origin) * inverse;
            let reach = (a.min(b).max_element(), a.max(b).min_element());
            if reach.0 > reach.1 || !visit(None, reach) {
                at = node.skip as usize;
                continue;
            }
            let first = node.leaf as usize / 8;
            let count = node.leaf as usize % 8;
            let leaf = self.triangles[first..first + count].iter();
            let _ = leaf.copied().take_while(|&index| visit(Some(index), reach)).count();
            at += 1;
        }
    }
}

enum Step {
    /// Makes the nodes of a range of triangles.
    Build(usize, usize),
    /// Ends a node, below which all nodes are made.
    Close(usize),
}

/// Divides triangles in two, and returns the number of the first part: at least 1, and fewer than all.
fn split(order: &mut [u32], extents: &[Extent]) -> usize {
    let middle = |index: u32| extents[index as usize].middle();
    let centers =
        order.iter().fold(Extent::EMPTY, |all, &index| all.with(Extent { min: middle(index), max: middle(index) }));
    let size = centers.max - centers.min;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let scale = BINS as f32 / size[axis].max(f32::MIN_POSITIVE);
    let bin = |index: u32| (((middle(index) - centers.min)[axis] * scale) as usize).min(BINS - 1);
    let mut bins = [(Extent::EMPTY, 0_usize); BINS];
    for &index in order.iter() {
        let (extent, count) = &mut bins[bin(index)];
        *extent = extent.with(extents[index as usize]);
        *count += 1;
    }
    let cost = |bins: &[(Extent, usize)]| {
        let (extent, count) =
            bins.iter().fold((Extent::EMPTY, 0), |(all, sum), (extent, count)| (all.with(*extent), sum + count));
        (extent.area() * count as f32, count)
    };
    let costs = (1..BINS).filter_map(|at| {
        let (left, count) = cost(&bins[..at]);
        let (right, others) = cost(&bins[at..]);
        (count > 0 && others > 0).then_some((left + right, at))
    });
    match costs.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, at)) => {
            order.sort_by_key(|&index| bin(index) >= at);
            order.partition_point(|&index| bin(index) < at)
        }
        // All in one point.
        None => order.len() / 2,
    }
}

/// Intersection of a ray with both sides of a triangle. (Möller and Trumbore, "Fast, minimum storage ray-triangle
/// intersection", 1997)
fn intersect(triangle: &RayTriangle, index: u32, origin: Vec3, direction: Vec3) -> Option<RayHit> {
    let [first, second] = triangle.edges;
    let across = direction.cross(second);
    let determinant = first.dot(across);
    if determinant.abs() < PARALLEL {
        return None;
    }
    let from_corner = origin - triangle.corner;
    let u = from_corner.dot(across) / determinant;
    let around = from_corner.cross(first);
    let v = direction.dot(around) / determinant;
    let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    let hit = RayHit { triangle: index, distance: second.dot(around) / determinant, weights: [u, v] };
    is_inside.then_some(hit)
}

#[cfg(test)]
mod tests {
    use glam::UVec3;
    use haze_core::assets::noise::{pcg3d, unit};

    use super::*;

    fn random(index: u32, salt: u32) -> Vec3 {
        let hash = pcg3d(UVec3::new(index, salt, 9));
        Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z)) * 2.0 - 1.0
    }

    #[test]
    fn the_hierarchy_finds_the_triangle_that_a_test_of_all_finds() {
        let corners: Vec<_> = (0..700)
            .map(|index| [0, 1, 2].map(|salt| 4.0 * random(index, 7) + 0.6 * random(index, salt)))
            // Some in one point, which no plane divides.
            .chain([[Vec3::ZERO, Vec3::X, Vec3::Y]; 9])
            .collect();
        let bvh = Bvh::new(&corners);
        let mut order = bvh.triangles.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..corners.len() as u32), "each triangle is in one leaf");
        let triangle = |index: u32| {
            let [a, b, c] = corners[index as usize];
            RayTriangle { corner: a, edges: [b - a, c - a] }
        };
        let mut hits = 0;
        let mut blocked = 0;
        for ray in 0..2000 {
            let origin = 6.0 * random(ray, 20);
            let direction = random(ray, 21);
            let all = (0..corners.len() as u32)
                .filter_map(|index| intersect(&triangle(index), index, origin, direction))
                .filter(|hit| (0.5..=40.0).contains(&hit.distance))
                .min_by(|a, b| a.distance.total_cmp(&b.distance));
            let found = bvh.nearest(Ray { origin, direction }, 0.5..=40.0, triangle, |_| true);
            assert_eq!(found.map(|hit| hit.distance), all.map(|hit| hit.distance));
            let far = 3.0;
            let is_blocked = bvh.is_blocked(Ray { origin, direction }, far, triangle, |_| true);
            let near = bvh.nearest(Ray { origin, direction }, 0.0..=far, triangle, |_| true);
            assert_eq!(is_blocked, near.is_some());
            hits += usize::from(found.is_some());
            blocked += usize::from(is_blocked);
        }
        assert!(hits > 300 && blocked > 50, "{hits} {blocked}");
        assert_eq!(
            Bvh::new(&[]).nearest(Ray { origin: Vec3::ZERO, direction: Vec3::X }, 0.0..=9.0, triangle, |_| true),
            None
        );
    }
}
