//! Reads a glTF file: triangles with base color, the first perspective camera, lights.
//!
//! glTF and haze agree on axes and unit: y up, right-handed, metres. Not read: emission, normal maps, roughness, metal,
//! animation, skins, morph targets. Surfaces are matte, and both sides are drawn.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::{Affine3A, Mat3, Mat4, UVec2, Vec2, Vec3, Vec4};
use gltf::khr_lights_punctual::Kind;
use gltf::material::AlphaMode;
use gltf::mesh::Mode;
use haze_core::assets::image::{Image, catch_decoder_panic};
use haze_core::error::{Error, one_line};
use haze_core::frame::{Light, LightKind};
use haze_preset::Camera;
use image::{ImageDecoder as _, ImageReader, Limits};

use super::bvh::Bvh;
use super::color_texture::{ColorTexture, Wrap};
use super::gltf_files::{self, GltfFiles};
use super::scene_mesh::{SceneMaterial, SceneMesh, SceneVertex};

/// Maximum number of triangles of a scene.
pub const MAX_TRIANGLES: usize = 1_000_000;
/// Maximum side of a texture, texels.
pub const MAX_TEXTURE_SIDE: u32 = 8192;
/// Side above which a texture is shown at half its size, texels.
const SHOWN_TEXTURE_SIDE: u32 = 4096;
/// Maximum memory of all textures as they are shown, bytes.
pub const MAX_TEXTURE_BYTES: u64 = 512 << 20;
/// Maximum distance from the origin, metres. As of lights and cameras.
const MAX_DISTANCE: f32 = 1.0e5;
/// Luminous efficacy by which Blender and others export watts as lumens, lm/W.
const LUMENS_PER_WATT: f32 = 683.0;
/// Maximum number of materials that are cut out.
const MAX_MASKS: usize = 128;
/// Alpha below which a blended material is cut out.
const BLEND_CUTOFF: f32 = 0.5;
/// Alpha below which a masked material is cut out if the file does not say it: glTF's default.
const MASK_CUTOFF: f32 = 0.5;

/// Extensions whose data is read, or may be left out without harm to the shape.
const KNOWN_EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_unlit", "KHR_materials_emissive_strength"];

/// Loads a scene.
///
/// # Errors
/// [`Error::Io`] if a file cannot be read; [`Error::Image`] with the file and the reason.
pub fn load_scene(path: &Path) -> Result<SceneMesh, Error> {
    let bytes = gltf_files::read(path)?;
    let mut files = GltfFiles::new(path);
    let damaged = "damaged; expected a glTF 2.0 file";
    // The reader of accessors panics for some damaged files.
    let read = catch_decoder_panic(|| Import::read(&bytes, &mut files)).unwrap_or_else(|| Err(damaged.into()));
    let mut mesh = read.map_err(|reason| Error::Image { path: path.into(), reason })?;
    let corners: Vec<_> =
        mesh.vertices.as_chunks::<3>().0.iter().map(|[a, b, c]| [a.position, b.position, c.position]).collect();
    mesh.bvh = Bvh::new(&corners);
    mesh.make_masks();
    mesh.files = files.read;
    Ok(mesh)
}

/// Scene being read.
struct Import {
    buffers: Vec<Vec<u8>>,
    /// Triangles of each material.
    vertices: Vec<Vec<SceneVertex>>,
    triangles: usize,
    mesh: SceneMesh,
    /// Index in the mesh of a texture of the file.
    textures: HashMap<usize, usize>,
}

impl Import {
    fn read(bytes: &[u8], files: &mut GltfFiles) -> Result<SceneMesh, String> {
        let invalid = |error: gltf::Error| format!("{}; expected a glTF 2.0 file", one_line(error));
        let unvalidated = gltf::Gltf::from_slice_without_validation(bytes).map_err(invalid)?;
        let mut needed = unvalidated.extensions_required();
        if let Some(unknown) = needed.find(|name| !KNOWN_EXTENSIONS.contains(name)) {
            let expected = "an export without compression of meshes, with PNG or JPEG images";
            return Err(format!(
                "needs the extension {}, which haze does not read; expected {expected}",
                one_line(unknown)
            ));
        }
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(bytes).map_err(invalid)?;
        let mut blob = blob;
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let data = match buffer.source() {
                gltf::buffer::Source::Bin => blob.take().ok_or("its binary chunk is missing; expected a whole file")?,
                gltf::buffer::Source::Uri(uri) => files.bytes(uri)?,
            };
            if data.len() < buffer.length() {
                let (has, says) = (data.len(), buffer.length());
                return Err(format!("buffer {} has {has} of {says} bytes; expected a whole file", buffer.index()));
            }
            buffers.push(data);
        }
        let mut import =
            Self { buffers, vertices: Vec::new(), triangles: 0, mesh: SceneMesh::default(), textures: HashMap::new() };
        // The last material is glTF's default.
        for material in document.materials() {
            import.add_material(&material, files)?;
        }
        import.mesh.materials.push(SceneMaterial::default());
        import.vertices = vec![Vec::new(); import.mesh.materials.len()];
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let scene = scene.ok_or("has no scene; expected an export with a scene")?;
        import.add_nodes(&scene)?;
        import.finish()
    }

    fn add_nodes(&mut self, scene: &gltf::Scene<'_>) -> Result<(), String> {
        let mut open: Vec<_> = scene.nodes().map(|node| (node, Affine3A::IDENTITY)).collect();
        open.reverse();
        let mut seen = HashSet::new();
        while let Some((node, parent)) = open.pop() {
            if !seen.insert(node.index()) {
                return Err(format!("node {} has two parents; expected a tree of nodes", node.index()));
            }
            let local = Mat4::from_cols_array_2d(&node.transform().matrix());
            let world = parent * Affine3A::from_mat4(local);
            if !world.is_finite() {
                return Err(format!("the transform of {} is not finite; expected numbers", name_of(&node)));
            }
            if let Some(mesh) = node.mesh() {
                for primitive in mesh.primitives() {
                    self.add_primitive(&primitive, &world, &name_of(&node))?;
                }
            }
            if node.skin().is_some() {
                self.note("skins are shown in their rest pose");
            }
            if let Some(light) = node.light() {
                self.mesh.lights.push(light_of(&light, &world));
            }
            if let Some(camera) = node.camera().filter(|_| self.mesh.camera.is_none()) {
                self.mesh.camera = camera_of(&camera, &world);
            }
            let mut children: Vec<_> = node.children().map(|child| (child, world)).collect();
            children.reverse();
            open.extend(children);
        }
        Ok(())
    }

    fn add_primitive(&mut self, primitive: &gltf::Primitive<'_>, world: &Affine3A, node: &str) -> Result<(), String> {
        let corners: fn(usize) -> [usize; 3] = match primitive.mode() {
            Mode::Triangles => |triangle| [0, 1, 2].map(|corner| 3 * triangle + corner),
            // Every second triangle of a strip is turned.
            Mode::TriangleStrip => |triangle| {
                let odd = triangle % 2;
                [triangle, triangle + 1 + odd, triangle + 2 - odd]
            },
            Mode::TriangleFan => |triangle| [0, triangle + 1, triangle + 2],
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {
                self.note("points and lines are not shown");
                return Ok(());
            }
        };
        let is_list = primitive.mode() == Mode::Triangles;
        let too_many = || format!("more than {MAX_TRIANGLES} triangles; expected at most that many");
        let most = 3 * MAX_TRIANGLES;
        if primitive.attributes().any(|(_, accessor)| accessor.count() > most)
            || primitive.indices().is_some_and(|accessor| accessor.count() > most)
        {
            return Err(too_many());
        }
        let buffers = &self.buffers;
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let positions: Vec<_> = match reader.read_positions() {
            Some(positions) => positions.map(|position| world.transform_point3(position.into())).collect(),
            None => return Err(format!("{node} has no positions; expected a whole file")),
        };
        let is_far = |position: &Vec3| !position.is_finite() || position.abs().max_element() > MAX_DISTANCE;
        if let Some(index) = positions.iter().position(is_far) {
            let expected = format!("finite numbers up to {MAX_DISTANCE} m from the origin");
            return Err(format!("corner {index} of {node} is at {}; expected {expected}", positions[index]));
        }
        let material = primitive.material();
        let part = material.index().unwrap_or(self.mesh.materials.len() - 1);
        let pbr = material.pbr_metallic_roughness();
        let factor = Vec4::from(pbr.base_color_factor()).truncate();
        let factor = if factor.is_finite() { factor.max(Vec3::ZERO) } else { Vec3::ONE };
        let info = pbr.base_color_texture();
        let transform = info.as_ref().and_then(gltf::texture::Info::texture_transform);
        let set = transform.as_ref().and_then(gltf::texture::TextureTransform::tex_coord);
        let set = set.or(info.as_ref().map(gltf::texture::Info::tex_coord)).unwrap_or_default();
        let uvs: Vec<Vec2> =
            reader.read_tex_coords(set).map(|uvs| uvs.into_f32().map(Vec2::from).collect()).unwrap_or_default();
        let colors: Vec<Vec3> =
            reader.read_colors(0).map(|colors| colors.into_rgb_f32().map(Vec3::from).collect()).unwrap_or_default();
        let linear = Mat3::from(world.matrix3);
        let is_mirrored = linear.determinant() < 0.0;
        // Adjugate transposed: like the inverse transposed, but defined for flattened nodes too.
        let of_normals = Mat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        let sign = if is_mirrored { -1.0 } else { 1.0 };
        let normals: Vec<Vec3> = reader
            .read_normals()
            .map(|normals| normals.map(|normal| sign * (of_normals * Vec3::from(normal))).collect())
            .unwrap_or_default();
        let indices: Vec<usize> = match reader.read_indices() {
            Some(indices) => indices.into_u32().map(|index| index as usize).collect(),
            None => (0..positions.len()).collect(),
        };
        let count = if is_list { indices.len() / 3 } else { indices.len().saturating_sub(2) };
        self.triangles += count;
        if self.triangles > MAX_TRIANGLES {
            return Err(too_many());
        }
        let texture = self.mesh.materials.get(part).and_then(|material| material.texture);
        let texels = texture.and_then(|index| self.mesh.textures.get(index)).and_then(|texture| texture.levels.first());
        let texels = texels.map_or(Vec2::ZERO, |level| level.size.as_vec2());
        let vertices = self.vertices.get_mut(part).ok_or("a material is missing; expected a whole file")?;
        for triangle in 0..count {
            let mut corners = corners(triangle);
            if is_mirrored {
                corners.swap(1, 2);
            }
            let indices = corners.map(|corner| indices.get(corner).copied().unwrap_or(usize::MAX));
            if let Some(index) = indices.into_iter().find(|&index| index >= positions.len()) {
                return Err(format!("{node} names corner {index} of {}; expected a whole file", positions.len()));
            }
            let places = indices.map(|index| positions[index]);
            let across = (places[1] - places[0]).cross(places[2] - places[0]);
            if across == Vec3::ZERO {
                continue;
            }
            let flat = across.normalize_or(Vec3::Y);
            let uvs = indices.map(|index| {
                let uv = uvs.get(index).copied().unwrap_or_default();
                let moved = transform.as_ref().map_or(uv, |transform| transformed(uv, transform));
                if moved.is_finite() { moved } else { Vec2::ZERO }
            });
            let [first, second] = [uvs[1] - uvs[0], uvs[2] - uvs[0]].map(|edge| edge * texels);
            let texel_density = (first.perp_dot(second).abs() / across.length().max(f32::MIN_POSITIVE)).sqrt();
            for (corner, index) in indices.into_iter().enumerate() {
                let color = colors.get(index).copied().filter(|color| color.is_finite()).unwrap_or(Vec3::ONE);
                let normal = normals.get(index).copied().unwrap_or(flat).normalize_or(flat);
                vertices.push(SceneVertex {
                    position: places[corner],
                    u: uvs[corner].x,
                    normal: if normal.is_finite() { normal } else { flat },
                    v: uvs[corner].y,
                    color: factor * color.max(Vec3::ZERO),
                    texel_density: if texel_density.is_finite() { texel_density } else { 0.0 },
                });
            }
        }
        Ok(())
    }

    fn add_material(&mut self, material: &gltf::Material<'_>, files: &mut GltfFiles) -> Result<(), String> {
        let info = material.pbr_metallic_roughness().base_color_texture();
        let texture = info.map(|info| self.texture(&info.texture(), files)).transpose()?;
        let cutoff = match material.alpha_mode() {
            AlphaMode::Opaque => None,
            AlphaMode::Mask => Some(material.alpha_cutoff().unwrap_or(MASK_CUTOFF)),
            AlphaMode::Blend => {
                self.note("blended materials are cut out at half their alpha");
                Some(BLEND_CUTOFF)
            }
        };
        let alpha = material.pbr_metallic_roughness().base_color_factor()[3];
        // The factor multiplies the texture's alpha.
        let cutoff = cutoff.map(|cutoff| if alpha > 0.0 { cutoff / alpha } else { f32::INFINITY });
        self.mesh.materials.push(SceneMaterial { texture, cutoff: cutoff.filter(|cutoff| *cutoff > 0.0), mask: None });
        if material.emissive_factor().iter().any(|channel| *channel > 0.0) {
            self.note("surfaces that glow are shown without their glow");
        }
        Ok(())
    }

    fn texture(&mut self, texture: &gltf::Texture<'_>, files: &mut GltfFiles) -> Result<usize, String> {
        if let Some(&index) = self.textures.get(&texture.index()) {
            return Ok(index);
        }
        let source = texture.source();
        let held;
        let (bytes, name) = match source.source() {
            gltf::image::Source::View { view, .. } => {
                let range = view.offset()..view.offset().saturating_add(view.length());
                let bytes = self.buffers.get(view.buffer().index()).and_then(|buffer| buffer.get(range));
                let name = source.name().map_or_else(|| format!("image {}", source.index()), one_line);
                (bytes.ok_or("an image lies outside its buffer; expected a whole file")?, name)
            }
            gltf::image::Source::Uri { uri, .. } => {
                held = files.bytes(uri)?;
                let name = if uri.starts_with("data:") { format!("image {}", source.index()) } else { one_line(uri) };
                (held.as_slice(), name)
            }
        };
        let image = decode(bytes).map_err(|reason| format!("{name}: {reason}"))?;
        let wrap = |mode| match mode {
            gltf::texture::WrappingMode::Repeat => Wrap::Repeat,
            gltf::texture::WrappingMode::MirroredRepeat => Wrap::Mirror,
            gltf::texture::WrappingMode::ClampToEdge => Wrap::Clamp,
        };
        let sampler = texture.sampler();
        let wrap = [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())];
        self.mesh.textures.push(ColorTexture::new(image, wrap, SHOWN_TEXTURE_SIDE));
        let bytes: u64 = self.mesh.textures.iter().map(ColorTexture::bytes).sum();
        if bytes > MAX_TEXTURE_BYTES {
            let [found, most] = [bytes, MAX_TEXTURE_BYTES].map(|bytes| bytes >> 20);
            return Err(format!("up to {name}, textures take {found} MiB; expected at most {most} MiB"));
        }
        let index = self.mesh.textures.len() - 1;
        self.textures.insert(texture.index(), index);
        Ok(index)
    }

    fn note(&mut self, note: &str) {
        if !self.mesh.notes.iter().any(|known| known == note) {
            self.mesh.notes.push(note.into());
        }
    }

    fn finish(self) -> Result<SceneMesh, String> {
        let Self { vertices, mut mesh, .. } = self;
        for (material, vertices) in vertices.into_iter().enumerate().filter(|(_, vertices)| !vertices.is_empty()) {
            let first = mesh.triangle_count();
            mesh.vertices.extend(vertices);
            mesh.parts.push((material, first..mesh.triangle_count()));
        }
        if mesh.vertices.is_empty() {
            return Err("has no triangles; expected a scene with meshes".into());
        }
        let masks = mesh.materials.iter().filter(|material| material.cutoff.is_some()).count();
        if masks > MAX_MASKS {
            return Err(format!("{masks} materials are cut out by alpha; expected at most {MAX_MASKS}"));
        }
        Ok(mesh)
    }
}

fn name_of(node: &gltf::Node<'_>) -> String {
    node.name().map_or_else(|| format!("node {}", node.index()), |name| format!("{:?}", one_line(name)))
}

fn transformed(uv: Vec2, transform: &gltf::texture::TextureTransform<'_>) -> Vec2 {
    let (sin, cos) = transform.rotation().sin_cos();
    let scaled = uv * Vec2::from(transform.scale());
    Vec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x) + Vec2::from(transform.offset())
}

fn camera_of(camera: &gltf::Camera<'_>, world: &Affine3A) -> Option<Camera> {
    let gltf::camera::Projection::Perspective(perspective) = camera.projection() else { return None };
    let position: Vec3 = world.translation.into();
    let forward = world.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Z);
    let near = perspective.znear().clamp(0.001, 100.0);
    Some(Camera {
        position: position.clamp(Vec3::splat(-MAX_DISTANCE), Vec3::splat(MAX_DISTANCE)),
        target: position + forward,
        fov: perspective.yfov().to_degrees().clamp(1.0, 150.0),
        near,
        far: perspective.zfar().unwrap_or(Camera::default().far).clamp(near * 1.01, 1.0e5),
        ..Camera::default()
    })
}

/// Light in haze's unit: candela or lux, divided by π, and by the factor by which exporters turn watts into lumens. A white
/// matte surface is then as bright as in Blender at exposure 0.
fn light_of(light: &gltf::khr_lights_punctual::Light<'_>, world: &Affine3A) -> Light {
    let (kind, inner, outer) = match light.kind() {
        Kind::Directional => (LightKind::Directional, 0.0, 0.0),
        Kind::Point => (LightKind::Point, 0.0, 0.0),
        Kind::Spot { inner_cone_angle, outer_cone_angle } => (LightKind::Spot, inner_cone_angle, outer_cone_angle),
    };
    let finite = |value: f32| if value.is_finite() { value.max(0.0) } else { 0.0 };
    let intensity = finite(light.intensity() / (LUMENS_PER_WATT * std::f32::consts::PI)).min(1.0e9);
    // The distance at which it has faded to what no picture shows.
    let seen = (intensity / 1.0e-3).sqrt().clamp(5.0, 1.0e3);
    let mut found = Light {
        kind,
        position: Vec3::from(world.translation).clamp(Vec3::splat(-MAX_DISTANCE), Vec3::splat(MAX_DISTANCE)),
        direction: world.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Y),
        color: Vec3::from(light.color().map(finite)).min(Vec3::splat(100.0)),
        intensity,
        range: light.range().filter(|range| *range > 0.01).unwrap_or(seen),
        ..Light::default()
    };
    if kind == LightKind::Spot {
        found.outer_angle = finite(outer.to_degrees()).clamp(0.1, 89.9);
        found.inner_angle = finite(inner.to_degrees()).min(found.outer_angle).min(89.0);
    }
    found
}

fn decode(bytes: &[u8]) -> Result<Image<[u8; 4]>, String> {
    let refuse = |error: image::ImageError| format!("{}; expected a PNG or JPEG image", one_line(error));
    let reader = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|error| error.to_string())?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_TEXTURE_SIDE), Some(MAX_TEXTURE_SIDE));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    if width.max(height) > MAX_TEXTURE_SIDE || width.min(height) == 0 {
        return Err(format!("{width}x{height} texels; expected at most {MAX_TEXTURE_SIDE}x{MAX_TEXTURE_SIDE}"));
    }
    let pixels = image::DynamicImage::from_decoder(decoder).map_err(refuse)?.into_rgba8();
    let texels = pixels.pixels().map(|pixel| pixel.0).collect();
    Ok(Image { size: UVec2::new(width, height), texels })
}
