//! GPU renderer of a scene from a file: its pipelines, and what is uploaded of it. scene_renderer.rs records the passes.

use std::ops::Range;

use glam::{UVec2, Vec2};
use haze_core::assets::image::Image;
use wgpu::util::DeviceExt as _;

use super::scene_pipeline::{COLOR_FORMAT, LIGHT, LIGHT_PARTS, ScenePipeline, default_view, texture_entries};
use haze::shader;
use haze_author::backdrop::{ColorTexture, MASK_SIDE, SceneMaterial, SceneMesh, SceneVertex, Wrap};

/// Texels of a row of nodes and triangles. `ROW_BITS` in scene_mesh.wgsl.
const ROW: u32 = 1 << 11;

/// Pipelines for meshes, compiled when the first mesh is shown.
#[derive(Debug)]
pub(crate) struct MeshPipelines {
    material_layout: wgpu::BindGroupLayout,
    sample_layout: wgpu::BindGroupLayout,
    hierarchy_layout: wgpu::BindGroupLayout,
    /// Writes reflectance and normals at 2x2 samples per pixel.
    pub paint: wgpu::RenderPipeline,
    /// Lights the paint of a layer: surfaces behind outlines, objects in front.
    pub light: wgpu::RenderPipeline,
    /// Lights the paint of a layer, with up to three lights apart.
    pub light_parts: wgpu::RenderPipeline,
    /// Writes depth alone, as a light sees it.
    pub shadow: wgpu::RenderPipeline,
}

/// Mesh on the GPU.
#[derive(Debug)]
pub(crate) struct UploadedMesh {
    vertices: wgpu::Buffer,
    /// Materials, each with its vertices.
    parts: Vec<(wgpu::BindGroup, Range<u32>)>,
    hierarchy: wgpu::BindGroup,
    bytes: u64,
}

/// Uniform of a material. `MeshMaterial` in scene_mesh.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct MaterialUniform {
    cutoff: f32,
    level_bias: f32,
    padding: Vec2,
}

impl UploadedMesh {
    /// Memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Draws all triangles with a pipeline whose group 1 is a material.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        // A file of cameras and lights alone.
        if self.parts.is_empty() {
            return;
        }
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        for (material, vertices) in &self.parts {
            pass.set_bind_group(1, material, &[]);
            pass.draw(vertices.clone(), 0..1);
        }
    }

    /// Hierarchy of all triangles: group 2 of the light passes.
    pub fn hierarchy(&self) -> &wgpu::BindGroup {
        &self.hierarchy
    }
}

impl MeshPipelines {
    /// Compiles the pipelines. `scene_layout`: that of group 0.
    pub fn new(device: &wgpu::Device, scene_layout: &wgpu::BindGroupLayout) -> Self {
        let source = shader::compose(concat!(
            include_str!("scene.wgsl"),
            include_str!("scene_samples.wgsl"),
            include_str!("scene_light.wgsl"),
            include_str!("scene_mesh.wgsl")
        ));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("demo scene mesh"),
            source: wgpu::ShaderSource::Wgsl(source.unwrap_or_default().into()),
        });
        let layout = |entries: &[(u32, wgpu::BindingType)]| {
            let entry = |&(binding, ty): &_| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty,
                count: None,
            };
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("demo scene mesh"),
                entries: &entries.iter().map(entry).collect::<Vec<_>>(),
            })
        };
        let texture = |filterable, view_dimension| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let plain = texture(false, wgpu::TextureViewDimension::D2);
        let material_layout = layout(&[
            (8, texture(true, wgpu::TextureViewDimension::D2)),
            (9, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            (
                10,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
            ),
        ]);
        let sample_layout = layout(&[(0, plain), (6, plain), (7, plain)]);
        let hierarchy_layout =
            layout(&[(0, plain), (1, plain), (2, texture(false, wgpu::TextureViewDimension::D2Array))]);
        let drawn = [Some(scene_layout), Some(&material_layout)];
        let lit = [Some(scene_layout), Some(&sample_layout), Some(&hierarchy_layout)];
        let attributes = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Float32];
        let vertices = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<SceneVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        })];
        let draws = |fragment, formats: &[_]| {
            let fragment = Some((fragment, formats));
            ScenePipeline {
                groups: &drawn,
                vertex: "mesh_vertex",
                buffers: &vertices,
                fragment,
                depth: true,
                blend: None,
            }
            .create(device, &module)
        };
        let lights = |fragment, formats: &[_]| {
            let fragment = Some((fragment, formats));
            ScenePipeline { groups: &lit, vertex: "layer_vertex", buffers: &[], fragment, depth: false, blend: None }
                .create(device, &module)
        };
        Self {
            paint: draws("mesh_paint_fragment", &[COLOR_FORMAT; 2]),
            shadow: draws("mesh_depth_fragment", &[]),
            light: lights(LIGHT, &[COLOR_FORMAT]),
            light_parts: lights(LIGHT_PARTS, &[COLOR_FORMAT; 4]),
            material_layout,
            sample_layout,
            hierarchy_layout,
        }
    }

    /// Group of paint, normals and depth at 2x2 samples per pixel, for the light passes.
    pub fn samples(&self, device: &wgpu::Device, [paint, normals, depth]: [&wgpu::TextureView; 3]) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene mesh samples"),
            layout: &self.sample_layout,
            entries: &texture_entries([(0, paint), (6, normals), (7, depth)]),
        })
    }

    /// Uploads a mesh.
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue, mesh: &SceneMesh) -> UploadedMesh {
        let mut bytes = 0;
        let vertices = buffer(device, bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX);
        bytes += vertices.size();
        let mut upload = |descriptor: &wgpu::TextureDescriptor<'_>, data: &[u8]| {
            bytes += data.len() as u64;
            device.create_texture_with_data(queue, descriptor, wgpu::util::TextureDataOrder::LayerMajor, data)
        };
        let max_side = device.limits().max_texture_dimension_2d;
        let white = ColorTexture::new(Image::new(UVec2::ONE, [255; 4]), [Wrap::Repeat; 2], 1);
        let textures: Vec<_> = mesh
            .textures
            .iter()
            .chain([&white])
            .map(|texture| {
                let fits = |level: &&Image<[u8; 4]>| level.size.max_element() <= max_side;
                let skipped = texture.levels.iter().take_while(|level| !fits(level)).count();
                let levels = texture.levels.get(skipped..).unwrap_or_default();
                let size = levels.first().map_or(UVec2::ONE, |level| level.size);
                let data: Vec<u8> = levels.iter().flat_map(|level| level.texels.as_flattened()).copied().collect();
                let format = wgpu::TextureFormat::Rgba8UnormSrgb;
                let descriptor = texture_2d(size, 1, format, levels.len() as u32);
                let view = default_view(&upload(&descriptor, &data));
                (view, sampler(device, texture.wrap), skipped)
            })
            .collect();
        let parts = mesh.parts.iter().filter_map(|(material, triangles)| {
            let material = mesh.materials.get(*material)?;
            let (view, sampler, skipped) = textures.get(material.texture.unwrap_or(mesh.textures.len()))?;
            let group = self.material(device, material, view, sampler, *skipped);
            Some((group, 3 * triangles.start..3 * triangles.end))
        });
        let parts = parts.collect();
        let nodes: Vec<[f32; 4]> = bytemuck::cast_slice(&mesh.bvh.nodes).to_vec();
        let triangles: Vec<[f32; 4]> =
            mesh.bvh.triangles.iter().flat_map(|&triangle| triangle_texels(mesh, triangle)).collect();
        let table = |mut texels: Vec<[f32; 4]>| {
            let rows = (texels.len() as u32).div_ceil(ROW).max(1);
            texels.resize((rows * ROW) as usize, [0.0; 4]);
            (texture_2d(UVec2::new(ROW, rows), 1, wgpu::TextureFormat::Rgba32Float, 1), texels)
        };
        let [nodes, triangles] = [nodes, triangles].map(|texels| {
            let (descriptor, texels) = table(texels);
            default_view(&upload(&descriptor, bytemuck::cast_slice(&texels)))
        });
        // OpenGL takes a texture of one layer for one without layers.
        let layers = mesh.masks.len().max(1) as u32 + 1;
        let mut masks: Vec<u8> = mesh.masks.iter().flat_map(|mask| &mask.texels).copied().collect();
        masks.resize((layers * MASK_SIDE * MASK_SIDE) as usize, 0);
        let descriptor = texture_2d(UVec2::splat(MASK_SIDE), layers, wgpu::TextureFormat::R8Unorm, 1);
        let masks = upload(&descriptor, &masks).create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let hierarchy = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene mesh hierarchy"),
            layout: &self.hierarchy_layout,
            entries: &texture_entries([(0, &nodes), (1, &triangles), (2, &masks)]),
        });
        UploadedMesh { vertices, parts, hierarchy, bytes }
    }

    fn material(
        &self,
        device: &wgpu::Device,
        material: &SceneMaterial,
        view: &wgpu::TextureView,
        sampler: &wgpu::Sampler,
        skipped: usize,
    ) -> wgpu::BindGroup {
        let uniform = MaterialUniform {
            cutoff: material.cutoff.unwrap_or_default(),
            level_bias: -(skipped as f32),
            padding: Vec2::ZERO,
        };
        let uniform = buffer(device, bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM);
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene mesh material"),
            layout: &self.material_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 8, resource: wgpu::BindingResource::TextureView(view) },
                wgpu::BindGroupEntry { binding: 9, resource: wgpu::BindingResource::Sampler(sampler) },
                wgpu::BindGroupEntry { binding: 10, resource: uniform.as_entire_binding() },
            ],
        })
    }
}

/// A triangle as `blocks` in scene_mesh.wgsl reads it.
fn triangle_texels(mesh: &SceneMesh, triangle: u32) -> [[f32; 4]; 5] {
    let shape = mesh.ray_triangle(triangle);
    let material = mesh.material(triangle);
    let mask = material.and_then(|material| material.mask).map_or(-1.0, |mask| mask as f32);
    let cutoff = material.and_then(|material| material.cutoff).unwrap_or_default();
    let corner = |corner: u32| mesh.vertices.get((3 * triangle + corner) as usize).copied().unwrap_or_default();
    let [a, b, c] = [0, 1, 2].map(corner);
    let [first, second] = shape.edges;
    [
        shape.corner.extend(mask).to_array(),
        first.extend(a.u).to_array(),
        second.extend(a.v).to_array(),
        [b.u, b.v, c.u, c.v],
        [a.alpha, b.alpha, c.alpha, cutoff],
    ]
}

fn buffer(device: &wgpu::Device, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let label = Some("demo scene mesh");
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage })
}

fn texture_2d(size: UVec2, layers: u32, format: wgpu::TextureFormat, levels: u32) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some("demo scene mesh"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    }
}

fn sampler(device: &wgpu::Device, wrap: [Wrap; 2]) -> wgpu::Sampler {
    let mode = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("demo scene mesh"),
        address_mode_u: mode(wrap[0]),
        address_mode_v: mode(wrap[1]),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}
