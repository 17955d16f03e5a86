//! Triangles of a scene file with their materials, its camera and its lights.

use std::ops::{Range, RangeInclusive};
use std::path::PathBuf;

use glam::{UVec2, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::frame::{Light, MAX_LIGHTS};
use haze_preset::Camera;

use super::bvh::{Bvh, Ray, RayHit, RayTriangle};
use super::color_texture::ColorTexture;

/// Corner of a triangle, as a vertex buffer holds it: three `vec4f` and a float.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SceneVertex {
    /// Place, in units of the file.
    pub position: Vec3,
    /// Place in the texture, across.
    pub u: f32,
    /// Unit normal of the side that the file calls the front.
    pub normal: Vec3,
    /// Place in the texture, down.
    pub v: f32,
    /// Linear color that multiplies the texture.
    pub color: Vec3,
    /// Texels of the texture per unit of the file, the same at all corners of a triangle.
    pub texel_density: f32,
    /// Multiplies the alpha of the texture, if the material is cut out.
    pub alpha: f32,
}

/// Camera of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCamera {
    /// Name of its node, or else its own: in Blender, that of the object.
    pub name: String,
    /// Its own name: in Blender, that of the object's data.
    pub own_name: Option<String>,
    /// Its position and planes are in units of the file; it has the default exposure.
    pub camera: Camera,
}

impl SceneCamera {
    fn is_named(&self, name: &str) -> bool {
        self.name == name || self.own_name.as_deref() == Some(name)
    }
}

/// Material of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneMaterial {
    /// Index of its texture; `None` for a plain color.
    pub texture: Option<usize>,
    /// Alpha, that of a corner times that of the texture, below which it is cut out; `None` for a solid surface.
    pub cutoff: Option<f32>,
    /// Index in [`SceneMesh::masks`] of the alpha of its texture, if it is cut out.
    pub mask: Option<usize>,
}

/// Side of the mask of a material, texels.
pub const MASK_SIDE: u32 = 256;

/// Triangles of a scene file; see the module's documentation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneMesh {
    /// Three corners per triangle, counter-clockwise on its front.
    pub vertices: Vec<SceneVertex>,
    /// Triangles of each material that has any, with its index.
    pub parts: Vec<(usize, Range<u32>)>,
    /// Materials.
    pub materials: Vec<SceneMaterial>,
    /// Textures.
    pub textures: Vec<ColorTexture>,
    /// Alpha of materials that are cut out, as rays to lights see it: [`MASK_SIDE`] squared, 255 for 1.
    pub masks: Vec<Image<u8>>,
    /// Hierarchy over all triangles.
    pub bvh: Bvh,
    /// Perspective cameras, in the order of the file's tree.
    pub cameras: Vec<SceneCamera>,
    /// Lights. Their positions and ranges are in units of the file.
    pub lights: Vec<Light>,
    /// Files that it was read from: the scene file first, then buffers and images beside it.
    pub files: Vec<PathBuf>,
    /// True if Blender wrote the file.
    pub is_from_blender: bool,
    /// Parts of the file that are not shown, in words.
    pub notes: Vec<String>,
}

/// Point of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Unit normal, interpolated, on the side that the ray comes from.
    pub normal: Vec3,
    /// Place in the texture.
    pub uv: Vec2,
    /// Linear color that multiplies the texture.
    pub color: Vec3,
    /// Texels per unit of the file.
    pub texel_density: f32,
}

impl SceneMesh {
    /// Number of triangles.
    pub fn triangle_count(&self) -> u32 {
        self.vertices.len() as u32 / 3
    }

    /// Its parts in words: `1204 triangles, a camera, 2 lights`, and what of the file is not shown.
    pub fn description(&self) -> String {
        let counted = |count: usize, noun: &str| match count {
            0 => String::new(),
            1 => format!(", a {noun}"),
            count => format!(", {count} {noun}s"),
        };
        let cameras = counted(self.cameras.len(), "camera");
        let lights = counted(self.lights.len(), "light");
        let notes: String = self.notes.iter().map(|note| format!("; {note}")).collect();
        format!("{} triangles{cameras}{lights}{notes}", self.triangle_count())
    }

    /// Corners of the box around all triangles, in units of the file; `None` without triangles.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bvh.nodes.first().map(|root| (root.min, root.max))
    }

    /// Camera of this name, or the first, in metres, with the point in the middle of its image at the depth of the scene's
    /// middle. `scale`: metres per unit of the file.
    pub fn camera_at_scale(&self, name: Option<&str>, scale: f32) -> Option<Camera> {
        let camera = self.cameras.iter().find(|camera| name.is_none_or(|name| camera.is_named(name)))?.camera;
        let forward = camera.target - camera.position;
        let middle = self.bounds().map_or(camera.target, |(min, max)| 0.5 * (min + max));
        let depth = forward.dot(middle - camera.position).max(1.0);
        Some(Camera {
            position: camera.position * scale,
            target: (camera.position + forward * depth) * scale,
            near: (camera.near * scale).clamp(0.001, 100.0),
            far: (camera.far * scale).clamp(0.1, 1.0e5).max((camera.near * scale).clamp(0.001, 100.0) * 1.01),
            ..camera
        })
    }

    /// Lights in metres, no more than a frame can have.
    pub fn lights_at_scale(&self, scale: f32) -> Vec<Light> {
        let scaled = |light: &Light| Light {
            position: light.position * scale,
            range: (light.range * scale).max(0.01),
            ..*light
        };
        self.lights.iter().take(MAX_LIGHTS).map(scaled).collect()
    }

    /// Material of a triangle.
    pub fn material(&self, triangle: u32) -> Option<&SceneMaterial> {
        let part = self.parts.partition_point(|(_, triangles)| triangles.end <= triangle);
        self.materials.get(self.parts.get(part)?.0)
    }

    /// Nearest surface whose distance is in a range. All in units of the file.
    pub fn nearest(&self, ray: Ray, distances: RangeInclusive<f32>) -> Option<RayHit> {
        self.bvh.nearest(ray, distances, |triangle| self.ray_triangle(triangle), |hit| self.is_solid(hit))
    }

    /// True if a surface lies at a distance from 0 to `far`. All in units of the file.
    pub fn is_blocked(&self, ray: Ray, far: f32) -> bool {
        self.bvh.is_blocked(ray, far, |triangle| self.ray_triangle(triangle), |hit| self.is_in_mask(hit))
    }

    /// Point at which a ray of this direction meets a surface.
    pub fn surface_point(&self, hit: &RayHit, direction: Vec3) -> SurfacePoint {
        let [a, b, c] = self.corners(hit.triangle);
        let [second, third] = hit.weights;
        let mix = |a: Vec3, b: Vec3, c: Vec3| a + (b - a) * second + (c - a) * third;
        let is_front = (b.position - a.position).cross(c.position - a.position).dot(direction) < 0.0;
        let normal = mix(a.normal, b.normal, c.normal).normalize_or(Vec3::Y);
        SurfacePoint {
            normal: if is_front { normal } else { -normal },
            uv: self.uv(hit),
            color: mix(a.color, b.color, c.color),
            texel_density: a.texel_density,
        }
    }

    /// Makes the masks of all materials that are cut out.
    pub fn make_masks(&mut self) {
        for material in self.materials.iter_mut().filter(|material| material.cutoff.is_some()) {
            let mut mask = Image::new(UVec2::splat(MASK_SIDE), 255);
            if let Some(texture) = material.texture.and_then(|index| self.textures.get(index)) {
                let side = texture.levels.first().map_or(1, |level| level.size.max_element());
                let level = (side as f32 / MASK_SIDE as f32).log2();
                mask.for_each(|at, texel| {
                    let uv = (at.as_vec2() + 0.5) / MASK_SIDE as f32;
                    *texel = (texture.sample(uv, level).w * 255.0).round() as u8;
                });
            }
            material.mask = Some(self.masks.len());
            self.masks.push(mask);
        }
    }

    fn is_in_mask(&self, hit: &RayHit) -> bool {
        let Some(material) = self.material(hit.triangle) else { return true };
        let Some(mask) = material.mask.and_then(|mask| self.masks.get(mask)) else { return true };
        let uv = self.uv(hit);
        let alpha = f32::from(mask.load(((uv - uv.floor()) * MASK_SIDE as f32).as_ivec2())) / 255.0;
        alpha * self.alpha(hit) >= material.cutoff.unwrap_or_default()
    }

    /// Texture of a triangle.
    pub fn texture(&self, triangle: u32) -> Option<&ColorTexture> {
        self.textures.get(self.material(triangle)?.texture?)
    }

    /// Corners of a triangle as a ray is tested against it.
    pub fn ray_triangle(&self, triangle: u32) -> RayTriangle {
        let [a, b, c] = self.corners(triangle);
        RayTriangle { corner: a.position, edges: [b.position - a.position, c.position - a.position] }
    }

    fn corners(&self, triangle: u32) -> [SceneVertex; 3] {
        let first = 3 * triangle as usize;
        [0, 1, 2].map(|corner| self.vertices.get(first + corner).copied().unwrap_or_default())
    }

    fn uv(&self, hit: &RayHit) -> Vec2 {
        let [a, b, c] = self.corners(hit.triangle).map(|corner| Vec2::new(corner.u, corner.v));
        a + (b - a) * hit.weights[0] + (c - a) * hit.weights[1]
    }

    fn alpha(&self, hit: &RayHit) -> f32 {
        let [a, b, c] = self.corners(hit.triangle).map(|corner| corner.alpha);
        a + (b - a) * hit.weights[0] + (c - a) * hit.weights[1]
    }

    /// False where the material is cut out.
    fn is_solid(&self, hit: &RayHit) -> bool {
        let Some(cutoff) = self.material(hit.triangle).and_then(|material| material.cutoff) else { return true };
        let alpha = self.texture(hit.triangle).map_or(1.0, |texture| texture.sample(self.uv(hit), 0.0).w);
        alpha * self.alpha(hit) >= cutoff
    }
}
