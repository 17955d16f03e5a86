//! Pipelines, formats and textures of scenes on the GPU.

use glam::UVec2;

pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
pub(crate) const LINEAR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Entry points that light a layer; the same with up to three lights apart.
pub(crate) const LIGHT: &str = "light_fragment";
pub(crate) const LIGHT_PARTS: &str = "light_parts_fragment";

/// Pipeline of entry points of a scene's shader.
pub(crate) struct ScenePipeline<'a> {
    pub groups: &'a [Option<&'a wgpu::BindGroupLayout>],
    pub vertex: &'a str,
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Entry point with the formats that it writes.
    pub fragment: Option<(&'a str, &'a [wgpu::TextureFormat])>,
    /// Tests and writes the depth buffer.
    pub depth: bool,
    /// Of all formats; `None` replaces.
    pub blend: Option<wgpu::BlendState>,
}

impl ScenePipeline<'_> {
    pub fn create(self, device: &wgpu::Device, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
        let Self { groups, vertex, buffers, fragment, depth, blend } = self;
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("demo scene"),
            bind_group_layouts: groups,
            immediate_size: 0,
        });
        let target = |&format| Some(wgpu::ColorTargetState { blend, ..wgpu::ColorTargetState::from(format) });
        let targets: Vec<_> = fragment.iter().flat_map(|(_, formats)| *formats).map(target).collect();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("demo scene"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: depth.then(|| wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::LessEqual),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: fragment.map(|(entry_point, _)| wgpu::FragmentState {
                module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Creates a texture that can be rendered to, sampled and copied.
pub(crate) fn texture(device: &wgpu::Device, label: &str, size: UVec2, format: wgpu::TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

pub(crate) fn default_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Returns entries of a bind group, each a binding with a texture.
pub(crate) fn texture_entries<const COUNT: usize>(
    textures: [(u32, &wgpu::TextureView); COUNT],
) -> [wgpu::BindGroupEntry<'_>; COUNT] {
    textures.map(|(binding, view)| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) })
}

/// Layout of the group of a pass over an image: textures, then a uniform, by their bindings.
pub(crate) fn image_pass_layout(
    device: &wgpu::Device,
    label: &str,
    textures: &[u32],
    uniform: u32,
) -> wgpu::BindGroupLayout {
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let buffer = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let visibility = wgpu::ShaderStages::FRAGMENT;
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let textures = textures.iter().map(|binding| entry(*binding, texture));
    let entries: Vec<_> = textures.chain([entry(uniform, buffer)]).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}
