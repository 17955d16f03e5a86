//! Reads a glTF file: triangles with base color and their instances, perspective cameras, lights.
//!
//! glTF and haze agree on axes and unit: y up, right-handed, metres. Not read: emission, normal maps, roughness, metal,
//! animation, skins, morph targets. Surfaces are matte, and both sides are drawn. A note tells each part of a file that is not
//! shown.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::{Affine3A, Mat4, Quat, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles as _};
use gltf::material::AlphaMode;
use gltf::mesh::Mode;
use haze_core::assets::image::{Image, catch_decoder_panic};
use haze_core::error::{AssetError, one_line};
use haze_core::frame::MAX_LIGHTS;
use image::{ImageDecoder as _, ImageReader, Limits};

use super::bvh::Bvh;
use super::color_texture::{ColorTexture, Wrap};
use super::covered_triangles::remove_covered;
use super::decode_problem::decode_problem;
use super::file_limits::MAX_DISTANCE;
use super::gltf_accessor::vectors;
use super::gltf_files::{self, GltfFiles};
use super::gltf_json::{GltfJson, Instances};
use super::gltf_shape::{InstanceTransform, Shape};
use super::gltf_view::{camera_of, light_of, roll_of};
use super::scene_mesh::{SceneCamera, SceneMaterial, SceneMesh, SceneVertex};

/// Maximum number of triangles of a scene.
pub const MAX_TRIANGLES: usize = 1_000_000;
/// Maximum side of a texture, texels.
pub const MAX_TEXTURE_SIDE: u32 = 8192;
/// Side above which a texture is shown at half its size, texels.
const SHOWN_TEXTURE_SIDE: u32 = 4096;
/// Maximum memory of all textures as they are shown, bytes.
pub const MAX_TEXTURE_BYTES: u64 = 512 << 20;
/// Maximum number of materials that are cut out.
const MAX_MASKS: usize = 128;
/// Alpha below which a blended material is cut out.
const BLEND_CUTOFF: f32 = 0.5;
/// Alpha below which a masked material is cut out if the file does not say it: glTF's default.
const MASK_CUTOFF: f32 = 0.5;

/// Roll of a camera that a note tells, degrees: half a pixel at the edge of an image of 1920x1080.
const MIN_ROLL: f32 = 0.03;

/// Loads a scene.
///
/// # Errors
/// [`AssetError::Io`] if a file cannot be read; [`AssetError::Image`] with the file and the reason.
pub fn load_scene(path: &Path) -> Result<SceneMesh, AssetError> {
    let bytes = gltf_files::read(path)?;
    let mut files = GltfFiles::new(path);
    let damaged = "damaged; expected a glTF 2.0 file";
    // The reader of accessors panics for some damaged files.
    let read = catch_decoder_panic(|| Import::read(&bytes, &mut files)).unwrap_or_else(|| Err(damaged.into()));
    let mut mesh = read.map_err(|reason| AssetError::Image { path: path.into(), reason })?;
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
        let GltfJson { document, blob, instances, notes } = GltfJson::read(bytes)?;
        let mut blob = blob;
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let data = match buffer.source() {
                gltf::buffer::Source::Bin => blob.take().ok_or("its binary chunk is missing; expected a whole file")?,
                gltf::buffer::Source::Uri(uri) => files.bytes(uri, "buffer", buffer.index())?,
            };
            if data.len() < buffer.length() {
                let has = data.len();
                let says = buffer.length();
                return Err(format!("buffer {} has {has} of {says} bytes; expected a whole file", buffer.index()));
            }
            buffers.push(data);
        }
        let mesh = SceneMesh { notes, ..SceneMesh::default() };
        let mut import = Self { buffers, vertices: Vec::new(), triangles: 0, mesh, textures: HashMap::new() };
        // The last material is glTF's default.
        for material in document.materials() {
            import.add_material(&material, files)?;
        }
        import.mesh.materials.push(SceneMaterial::default());
        import.vertices = vec![Vec::new(); import.mesh.materials.len()];
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let scene = scene.ok_or("has no scene; expected an export with a scene")?;
        let scenes = document.scenes().len();
        if scenes > 1 {
            import.note(&format!("scene {} of {scenes} is shown", scene.index() + 1));
        }
        import.add_nodes(&document, &scene, &instances)?;
        let generator = document.as_json().asset.generator.as_deref().unwrap_or_default();
        import.finish(generator)
    }

    fn add_nodes(
        &mut self,
        document: &gltf::Document,
        scene: &gltf::Scene<'_>,
        instances: &HashMap<usize, Instances>,
    ) -> Result<(), String> {
        let mut open: Vec<_> = scene.nodes().map(|node| (node, Affine3A::IDENTITY)).collect();
        open.reverse();
        let mut seen = HashSet::new();
        while let Some((node, parent)) = open.pop() {
            if !seen.insert(node.index()) {
                return Err(format!("node {} has two parents; expected a tree of nodes", node.index()));
            }
            let name = name_of(&node);
            let local = Mat4::from_cols_array_2d(&node.transform().matrix());
            let world = parent * Affine3A::from_mat4(local);
            if !world.is_finite() {
                return Err(format!("the transform of {name} is not finite; expected numbers"));
            }
            if let Some(mesh) = node.mesh() {
                let instances = instances.get(&node.index());
                let worlds = match instances {
                    Some(instances) => self.transforms(document, instances, &world, &name)?,
                    None => vec![world],
                };
                for primitive in mesh.primitives() {
                    self.add_primitive(&primitive, &worlds, &name)?;
                }
                let weights = node.weights().or_else(|| mesh.weights()).unwrap_or_default();
                if weights.iter().any(|weight| *weight != 0.0) {
                    self.note("morph targets are not shown, whatever their weights");
                }
            }
            if node.skin().is_some() {
                self.note("skins are shown in their rest pose");
            }
            if let Some(light) = node.light() {
                self.mesh.lights.push(light_of(&light, &world));
            }
            if let Some(camera) = node.camera() {
                self.add_camera(&node, &camera, &world);
            }
            let mut children: Vec<_> = node.children().map(|child| (child, world)).collect();
            children.reverse();
            open.extend(children);
        }
        Ok(())
    }

    fn add_camera(&mut self, node: &gltf::Node<'_>, camera: &gltf::Camera<'_>, world: &Affine3A) {
        let name = node.name().or(camera.name());
        let name = name.map_or_else(|| format!("camera {}", camera.index()), str::to_owned);
        let Some(found) = camera_of(camera, world) else {
            self.note(&format!("camera {name:?} is orthographic; haze has perspective cameras only"));
            return;
        };
        let roll = roll_of(&found, world).to_degrees();
        if roll.abs() > MIN_ROLL {
            self.note(&format!("camera {name:?} is rolled by {roll:.1} degrees; haze shows it upright"));
        }
        let own_name = camera.name().map(str::to_owned);
        let is_taken = self.mesh.cameras.iter().any(|other| other.name == name);
        let name = if is_taken { format!("{name} {}", self.mesh.cameras.len() + 1) } else { name };
        self.mesh.cameras.push(SceneCamera { name, own_name, camera: found });
    }

    /// Transforms of the instances of a node.
    fn transforms(
        &self,
        document: &gltf::Document,
        instances: &Instances,
        world: &Affine3A,
        node: &str,
    ) -> Result<Vec<Affine3A>, String> {
        let accessor = |index: Option<usize>| {
            let Some(index) = index else { return Ok(None) };
            let found = document.accessors().nth(index).filter(|accessor| accessor.count() <= MAX_TRIANGLES);
            let expected = format!("a whole file, with at most {MAX_TRIANGLES} instances");
            found
                .map(Some)
                .ok_or_else(|| format!("the instances of {node} have no accessor {index}; expected {expected}"))
        };
        let damaged = |reason| format!("the instances of {node}: {reason}");
        let read = |accessor: Option<gltf::Accessor<'_>>| {
            accessor
                .map(|accessor| vectors::<3>(&accessor, &self.buffers, accessor.normalized()))
                .transpose()
                .map_err(damaged)
        };
        let translations = read(accessor(instances.translation)?)?;
        let scales = read(accessor(instances.scale)?)?;
        let rotations =
            accessor(instances.rotation)?.map(|accessor| vectors::<4>(&accessor, &self.buffers, accessor.normalized()));
        let rotations = rotations.transpose().map_err(damaged)?;
        let counts =
            [translations.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
        let count = counts.into_iter().flatten().max().unwrap_or(1);
        if counts.into_iter().flatten().any(|other| other != count) {
            return Err(damaged("their attributes differ in number; expected a whole file".into()));
        }
        let position = |index: usize| {
            let of =
                |list: &Option<Vec<[f32; 3]>>| list.as_ref().and_then(|list| list.get(index)).copied().map(Vec3::from);
            let rotation = rotations.as_ref().and_then(|list| list.get(index)).copied();
            let rotation = rotation.map_or(Vec4::W, |rotation| Vec4::from(rotation).normalize_or(Vec4::W));
            let local = Affine3A::from_scale_rotation_translation(
                of(&scales).unwrap_or(Vec3::ONE),
                Quat::from_vec4(rotation),
                of(&translations).unwrap_or(Vec3::ZERO),
            );
            *world * local
        };
        Ok((0..count).map(position).collect())
    }

    /// Adds the triangles of a primitive, once for each transform.
    fn add_primitive(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        worlds: &[Affine3A],
        node: &str,
    ) -> Result<(), String> {
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
        let shape = Shape::read(primitive, &self.buffers, node)?;
        let count = if is_list { shape.indices.len() / 3 } else { shape.indices.len().saturating_sub(2) };
        self.triangles = self.triangles.saturating_add(count.saturating_mul(worlds.len()));
        if self.triangles > MAX_TRIANGLES {
            return Err(too_many());
        }
        let part = primitive.material().index().unwrap_or(self.mesh.materials.len() - 1);
        let texture = self.mesh.materials.get(part).and_then(|material| material.texture);
        let texels = texture.and_then(|index| self.mesh.textures.get(index)).and_then(|texture| texture.levels.first());
        let texels = texels.map_or(Vec2::ZERO, |level| level.size.as_vec2());
        let vertices = self.vertices.get_mut(part).ok_or("a material is missing; expected a whole file")?;
        for world in worlds.iter().filter(|_| count > 0) {
            let placed = InstanceTransform::new(world);
            for triangle in 0..count {
                let mut corners = corners(triangle);
                if placed.is_mirrored {
                    corners.swap(1, 2);
                }
                let indices = corners.map(|corner| shape.indices.get(corner).copied().unwrap_or(usize::MAX));
                let count = shape.positions.len();
                if let Some(index) = indices.into_iter().find(|&index| index >= count) {
                    return Err(format!("{node} names corner {index} of {count}; expected a whole file"));
                }
                let positions = indices.map(|index| world.transform_point3(shape.positions[index]));
                let is_far = |corner: &Vec3| !corner.is_finite() || corner.abs().max_element() > MAX_DISTANCE;
                if let Some((index, corner)) = indices.iter().zip(&positions).find(|(_, corner)| is_far(corner)) {
                    let expected = format!("finite numbers up to {MAX_DISTANCE} m from the origin");
                    return Err(format!("corner {index} of {node} is at {corner}; expected {expected}"));
                }
                let across = (positions[1] - positions[0]).cross(positions[2] - positions[0]);
                if across == Vec3::ZERO {
                    continue;
                }
                let flat = across.normalize_or(Vec3::Y);
                let uvs = indices.map(|index| shape.uvs.get(index).copied().unwrap_or_default());
                let [first, second] = [uvs[1] - uvs[0], uvs[2] - uvs[0]].map(|edge| edge * texels);
                let texel_density = (first.perp_dot(second).abs() / across.length().max(f32::MIN_POSITIVE)).sqrt();
                for (corner, index) in indices.into_iter().enumerate() {
                    let color = shape.colors.get(index).copied().unwrap_or(shape.color);
                    let normal = shape.normals.get(index).map_or(flat, |normal| placed.normals * *normal);
                    let normal = normal.normalize_or(flat);
                    vertices.push(SceneVertex {
                        position: positions[corner],
                        u: uvs[corner].x,
                        normal: if normal.is_finite() { normal } else { flat },
                        v: uvs[corner].y,
                        color: color.xyz(),
                        texel_density: if texel_density.is_finite() { texel_density } else { 0.0 },
                        alpha: color.w,
                    });
                }
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
        self.mesh.materials.push(SceneMaterial { texture, cutoff: cutoff.filter(|cutoff| *cutoff > 0.0), mask: None });
        if material.emissive_factor().iter().any(|channel| *channel > 0.0) {
            self.note("surfaces that glow are shown without their glow");
        }
        if material.normal_texture().is_some() {
            self.note("normal maps are not shown");
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
                held = files.bytes(uri, "image", source.index())?;
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

    fn finish(mut self, generator: &str) -> Result<SceneMesh, String> {
        match remove_covered(&mut self.vertices, &self.mesh.materials) {
            0 => {}
            1 => self.note("a triangle lies exactly on another and is not shown"),
            count => self.note(&format!("{count} triangles lie exactly on others and are not shown")),
        }
        for (material, vertices) in std::mem::take(&mut self.vertices).into_iter().enumerate() {
            if !vertices.is_empty() {
                let first = self.mesh.triangle_count();
                self.mesh.vertices.extend(vertices);
                self.mesh.parts.push((material, first..self.mesh.triangle_count()));
            }
        }
        let masks = self.mesh.materials.iter().filter(|material| material.cutoff.is_some()).count();
        if masks > MAX_MASKS {
            return Err(format!("{masks} materials are cut out by alpha; expected at most {MAX_MASKS}"));
        }
        let has_view = !self.mesh.cameras.is_empty() || !self.mesh.lights.is_empty();
        if self.mesh.vertices.is_empty() && !has_view {
            let notes: String = self.mesh.notes.iter().map(|note| format!(" ({note})")).collect();
            return Err(format!("has no triangles, cameras or lights{notes}; expected a scene with meshes"));
        }
        let lights = self.mesh.lights.len();
        if lights > MAX_LIGHTS {
            self.note(&format!("{MAX_LIGHTS} of {lights} lights can be used"));
        }
        // haze's own example has Blender's unit.
        if lights > 0 && !is_from_blender(generator) && generator != "haze" {
            self.note(
                "lights are read as Blender writes them, watts times 683: in another unit they are too dark or bright",
            );
        }
        self.mesh.is_from_blender = is_from_blender(generator);
        Ok(self.mesh)
    }
}

/// Program that wrote a file, as Blender names itself: `Khronos glTF Blender I/O v5.0.21`.
fn is_from_blender(generator: &str) -> bool {
    generator.contains("Blender")
}

fn name_of(node: &gltf::Node<'_>) -> String {
    node.name().map_or_else(|| format!("node {}", node.index()), |name| format!("{:?}", one_line(name)))
}

fn decode(bytes: &[u8]) -> Result<Image<[u8; 4]>, String> {
    let refuse = |error: image::ImageError| decode_problem(&error, "a whole PNG or JPEG image");
    let reader = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|error| refuse(error.into()))?;
    if reader.format().is_none() {
        return Err("neither PNG nor JPEG; expected one of the two".into());
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_TEXTURE_SIDE);
    limits.max_image_height = Some(MAX_TEXTURE_SIDE);
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
