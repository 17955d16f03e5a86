//! Triangles that lie exactly on others. A hierarchy cannot divide them, so that each ray would be tested against all.

use std::collections::HashSet;

use super::scene_mesh::{SceneMaterial, SceneVertex};

/// Bits of the corners, in an order that does not depend on the first one or on the winding.
type Corners = [[u32; 3]; 3];

/// Removes triangles that a later one covers in the order of drawing: one of the same corners that is solid, or the same again
/// if it is cut out. Returns the number of removed ones. `parts`: three corners per triangle, for each material.
pub fn remove_covered(parts: &mut [Vec<SceneVertex>], materials: &[SceneMaterial]) -> usize {
    let mut solid = HashSet::new();
    let mut removed = 0;
    for (part, vertices) in parts.iter_mut().enumerate().rev() {
        let is_cut_out = materials.get(part).is_some_and(|material| material.cutoff.is_some());
        let mut cut_out = HashSet::new();
        let mut kept = Vec::with_capacity(vertices.len());
        for triangle in vertices.as_chunks::<3>().0.iter().rev() {
            let corners = corners_of(triangle);
            let is_kept = !solid.contains(&corners)
                && if is_cut_out {
                    cut_out.insert(bytemuck::bytes_of(triangle).to_vec())
                } else {
                    solid.insert(corners)
                };
            if is_kept {
                kept.extend(triangle.iter().rev());
            } else {
                removed += 1;
            }
        }
        kept.reverse();
        *vertices = kept;
    }
    removed
}

fn corners_of(triangle: &[SceneVertex; 3]) -> Corners {
    // The sum makes 0 of -0.
    let mut corners = triangle.map(|corner| (corner.position + 0.0).to_array().map(f32::to_bits));
    corners.sort_unstable();
    corners
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// A triangle at a height, with a color to tell it.
    fn triangle(height: f32, color: f32, order: [usize; 3]) -> [SceneVertex; 3] {
        let corners = [Vec3::new(0.0, height, 0.0), Vec3::new(1.0, height, 0.0), Vec3::new(0.0, height, 1.0)];
        order.map(|corner| SceneVertex {
            position: corners[corner],
            color: Vec3::splat(color),
            ..SceneVertex::default()
        })
    }

    fn colors(vertices: &[SceneVertex]) -> Vec<f32> {
        vertices.as_chunks::<3>().0.iter().map(|triangle| triangle[0].color.x).collect()
    }

    const ORDER: [usize; 3] = [0, 1, 2];

    #[test]
    fn the_last_solid_triangle_of_a_place_is_kept() {
        let first = [triangle(0.0, 1.0, ORDER), triangle(1.0, 2.0, ORDER), triangle(-0.0, 3.0, [2, 1, 0])];
        let second = [triangle(0.0, 4.0, [1, 2, 0]), triangle(2.0, 5.0, ORDER)];
        let mut parts = [first.concat(), second.concat()];
        assert_eq!(remove_covered(&mut parts, &[SceneMaterial::default(), SceneMaterial::default()]), 2);
        assert_eq!([colors(&parts[0]), colors(&parts[1])], [vec![2.0], vec![4.0, 5.0]]);
        assert_eq!(parts[1], second.concat(), "in the same order");
    }

    #[test]
    fn cut_out_triangles_cover_their_equals_alone() {
        let cut_out = SceneMaterial { cutoff: Some(0.5), ..SceneMaterial::default() };
        let solid = [triangle(0.0, 1.0, ORDER)].concat();
        let leaves = [triangle(0.0, 2.0, ORDER), triangle(0.0, 3.0, ORDER), triangle(0.0, 2.0, ORDER)].concat();
        let mut parts = [solid.clone(), leaves.clone()];
        assert_eq!(remove_covered(&mut parts, &[SceneMaterial::default(), cut_out.clone()]), 1);
        assert_eq!([colors(&parts[0]), colors(&parts[1])], [vec![1.0], vec![3.0, 2.0]]);
        let mut parts = [leaves, solid];
        assert_eq!(remove_covered(&mut parts, &[cut_out, SceneMaterial::default()]), 3);
        assert_eq!([colors(&parts[0]), colors(&parts[1])], [vec![], vec![1.0]]);
    }
}
