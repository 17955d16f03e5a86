//! Triangles of a glTF primitive in the space of its node, and the transform that an instance gives them.

use glam::{Affine3A, Mat3, Vec2, Vec3, Vec4};
use gltf::Semantic;

use super::gltf_accessor::{colors, vectors};

/// Data of a primitive, in the space of its node.
pub struct Shape {
    pub positions: Vec<Vec3>,
    /// Empty for flat ones.
    pub normals: Vec<Vec3>,
    /// Places in the texture, transformed. Empty if there are none.
    pub uvs: Vec<Vec2>,
    /// Linear colors and alpha of corners, times those of the material. Empty if there are none.
    pub colors: Vec<Vec4>,
    /// Linear color and alpha of the material.
    pub color: Vec4,
    pub indices: Vec<usize>,
}

impl Shape {
    /// `node`: its name in errors.
    pub fn read(primitive: &gltf::Primitive<'_>, buffers: &[Vec<u8>], node: &str) -> Result<Self, String> {
        let named = |reason| format!("{node}: {reason}");
        let pbr = primitive.material().pbr_metallic_roughness();
        let of_file = Vec4::from(pbr.base_color_factor());
        let color = if of_file.is_finite() { of_file.max(Vec4::ZERO) } else { Vec4::ONE };
        let info = pbr.base_color_texture();
        let transform = info.as_ref().and_then(gltf::texture::Info::texture_transform);
        let set = transform.as_ref().and_then(gltf::texture::TextureTransform::tex_coord);
        let set = set.or(info.as_ref().map(gltf::texture::Info::tex_coord)).unwrap_or_default();
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Err(format!("{node} has no positions; expected a whole file"));
        };
        let positions = vectors::<3>(&positions, buffers, positions.normalized()).map_err(named)?;
        let mut shape = Self {
            positions: positions.into_iter().map(Vec3::from).collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            color,
            indices: Vec::new(),
        };
        if let Some(normals) = primitive.get(&Semantic::Normals) {
            shape.normals = vectors::<3>(&normals, buffers, normals.normalized())
                .map_err(named)?
                .into_iter()
                .map(Vec3::from)
                .collect();
        }
        if let Some(uvs) = primitive.get(&Semantic::TexCoords(set)) {
            let moved = |uv: [f32; 2]| {
                let uv = Vec2::from(uv);
                let moved = transform.as_ref().map_or(uv, |transform| transformed(uv, transform));
                if moved.is_finite() { moved } else { Vec2::ZERO }
            };
            shape.uvs = vectors::<2>(&uvs, buffers, uvs.normalized()).map_err(named)?.into_iter().map(moved).collect();
        }
        if let Some(of_corners) = primitive.get(&Semantic::Colors(0)) {
            let painted = |of_corner: Vec4| match of_corner.is_finite() {
                true => color * of_corner.max(Vec4::ZERO),
                false => color,
            };
            shape.colors = colors(&of_corners, buffers).map_err(named)?.into_iter().map(painted).collect();
        }
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        shape.indices = match (reader.read_indices(), primitive.indices()) {
            (Some(indices), _) => indices.into_u32().map(|index| index as usize).collect(),
            (None, Some(_)) => return Err(format!("{node} has no indices; expected a whole file")),
            (None, None) => (0..shape.positions.len()).collect(),
        };
        Ok(shape)
    }
}

/// Transform of an instance, as its normals and corners need it.
pub struct InstanceTransform {
    /// True if it turns triangles over.
    pub is_mirrored: bool,
    pub normals: Mat3,
}

impl InstanceTransform {
    pub fn new(world: &Affine3A) -> Self {
        let linear = Mat3::from(world.matrix3);
        let is_mirrored = linear.determinant() < 0.0;
        // Adjugate transposed: like the inverse transposed, but defined for flattened nodes too.
        let normals = Mat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        Self { is_mirrored, normals: if is_mirrored { -normals } else { normals } }
    }
}

fn transformed(uv: Vec2, transform: &gltf::texture::TextureTransform<'_>) -> Vec2 {
    let (sin, cos) = transform.rotation().sin_cos();
    let scaled = uv * Vec2::from(transform.scale());
    Vec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x) + Vec2::from(transform.offset())
}
