//! Textures of the test host.

use glam::UVec2;
use haze::wgpu;
use haze::wgpu::util::DeviceExt;
use haze_core::assets::image::Image;
use haze_demo::headless::Headless;

use crate::test_scene::TestScene;

/// Writes values as depth.
const STORED_DEPTH: &str = "@fragment fn fragment(@builtin(position) p: vec4f) -> @builtin(frag_depth) f32 {
    return textureLoad(values, vec2i(p.xy), 0).r;
}";

pub(super) fn target(gpu: &Headless, size: UVec2, format: wgpu::TextureFormat, sample_count: u32) -> wgpu::Texture {
    // OpenGL cannot sample multisampled depth.
    let reads_samples = format.has_depth_aspect() && haze::read_only_depth_is_supported(&gpu.device);
    let is_sampled = sample_count == 1 || reads_samples;
    let sampled = if is_sampled { wgpu::TextureUsages::TEXTURE_BINDING } else { wgpu::TextureUsages::empty() };
    create(gpu, size, format, sample_count, sampled, &[])
}

/// Creates a color target that stores one format and is drawn to through a view of another.
pub(super) fn target_with_view_format(
    gpu: &Headless,
    size: UVec2,
    stored: wgpu::TextureFormat,
    viewed: wgpu::TextureFormat,
) -> wgpu::Texture {
    create(gpu, size, stored, 1, wgpu::TextureUsages::TEXTURE_BINDING, &[viewed])
}

fn create(
    gpu: &Headless,
    size: UVec2,
    format: wgpu::TextureFormat,
    sample_count: u32,
    sampled: wgpu::TextureUsages,
    view_formats: &[wgpu::TextureFormat],
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("host target"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | sampled,
        view_formats,
    })
}

/// Places a view's depth values at `origin` in a target of `size`. The rest of the target is 0, the nearest depth, so
/// that a value read from outside the view shows in the image.
pub(super) fn pad_to_target(values: &Image<f32>, origin: UVec2, size: UVec2) -> Image<f32> {
    let mut whole = Image::new(size, 0.0);
    whole.for_each(|at, texel| {
        let inside = at.cmpge(origin).all() && at.cmplt(origin + values.size).all();
        if inside {
            *texel = values.load((at - origin).as_ivec2());
        }
    });
    whole
}

pub(super) fn upload(gpu: &Headless, values: &Image<f32>) -> wgpu::Texture {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("host depth values"),
        size: wgpu::Extent3d { width: values.size.x, height: values.size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    gpu.device.create_texture_with_data(&gpu.queue, &descriptor, order, bytemuck::cast_slice(&values.texels))
}

/// Creates a depth buffer that contains the scene's scene.
pub(super) fn depth_buffer(gpu: &Headless, scene: &TestScene, size: UVec2, samples: u32) -> wgpu::Texture {
    let values = upload(gpu, &pad_to_target(&scene.ndc_depth(), scene.view.origin, size));
    let depth = target(gpu, size, scene.host.depth_format, samples);
    let nearest = f32::from(u8::from(scene.is_reversed()));
    let with_near_sample = format!(
        "@fragment fn fragment(@builtin(position) p: vec4f, @builtin(sample_index) i: u32) -> @builtin(frag_depth) f32 {{
            return select(textureLoad(values, vec2i(p.xy), 0).r, {nearest:.1}, i == 1u);
        }}"
    );
    let has_near_sample = samples > 1 && scene.host.has_near_sample;
    fill(gpu, &values, &depth, if has_near_sample { &with_near_sample } else { STORED_DEPTH });
    depth
}

/// Creates a depth texture with these values in its layers.
pub(super) fn depth_layers(gpu: &Headless, layers: &[Image<f32>]) -> wgpu::Texture {
    let size = layers[0].size;
    let depth = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("host shadow map"),
        // OpenGL takes a texture of one layer for one without layers, and six for the faces of a cube.
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers.len() as u32 + 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    for (layer, values) in (0..).zip(layers) {
        let view = depth.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        });
        fill_view(gpu, &upload(gpu, values), &depth, &view, STORED_DEPTH);
    }
    depth
}

/// Converts any color texture to `Rgba16Float`.
pub fn convert_to_rgba16float(gpu: &Headless, texture: &wgpu::Texture) -> wgpu::Texture {
    if texture.format() == wgpu::TextureFormat::Rgba16Float && texture.usage().contains(wgpu::TextureUsages::COPY_SRC) {
        return texture.clone();
    }
    let size = UVec2::new(texture.width(), texture.height());
    let floats = gpu.target("host image", size, wgpu::TextureFormat::Rgba16Float);
    let fragment = "@fragment fn fragment(@builtin(position) p: vec4f) -> @location(0) vec4f {
        return textureLoad(values, vec2i(p.xy), 0);
    }";
    fill(gpu, texture, &floats, fragment);
    floats
}

/// Draws a fragment shader, which reads `values`, over the whole target `into`.
fn fill(gpu: &Headless, values: &wgpu::Texture, into: &wgpu::Texture, fragment: &str) {
    fill_view(gpu, values, into, &into.create_view(&wgpu::TextureViewDescriptor::default()), fragment);
}

/// Draws a fragment shader, which reads `values`, over a view of the target `into`.
fn fill_view(gpu: &Headless, values: &wgpu::Texture, into: &wgpu::Texture, view: &wgpu::TextureView, fragment: &str) {
    let device = &gpu.device;
    let pipeline = fill_pipeline(device, into, fragment);
    let is_depth = into.format().is_depth_stencil_format();
    let values = values.create_view(&wgpu::TextureViewDescriptor::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("host fill"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&values) }],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let attachment = Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        });
        let has_stencil = into.format().has_stencil_aspect();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host fill"),
            color_attachments: if is_depth { &[] } else { std::slice::from_ref(&attachment) },
            depth_stencil_attachment: is_depth.then(|| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: has_stencil
                    .then_some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Store }),
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    gpu.submit(encoder).unwrap();
}

/// Pipeline of [`fill`] for the format and sample count of `into`.
fn fill_pipeline(device: &wgpu::Device, into: &wgpu::Texture, fragment: &str) -> wgpu::RenderPipeline {
    let source = format!(
        "@group(0) @binding(0) var values: texture_2d<f32>;
        @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {{
            return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
        }}
        {fragment}"
    );
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("host fill"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("host fill"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }],
    });
    let is_depth = into.format().is_depth_stencil_format();
    let target = [Some(into.format().into())];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host fill"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("host fill"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        })),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: is_depth.then(|| wgpu::DepthStencilState {
            format: into.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: into.sample_count(), ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: if is_depth { &[] } else { &target },
        }),
        multiview_mask: None,
        cache: None,
    })
}
