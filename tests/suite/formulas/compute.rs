//! Compute runs of WGSL functions.

use std::sync::LazyLock;

use glam::{UVec2, UVec3};
use haze::wgpu;
use haze_core::assets::noise::NoiseVolume;
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::Sprite;
use haze_core::assets::sprite::alpha_bounds::AlphaBounds;
use haze_demo::headless::Headless;

use super::fixture::uniform_bytes;
use super::inputs::{test_noise, test_ramp, test_sprite};
use crate::gpu::gpu;

/// Resources that every run binds.
struct Fixture {
    layouts: [wgpu::BindGroupLayout; 2],
    ramp: wgpu::TextureView,
    sprite: wgpu::TextureView,
    noise: wgpu::TextureView,
    alpha_bounds: wgpu::TextureView,
    sampler: wgpu::Sampler,
    uniforms: wgpu::BindGroup,
}

impl Fixture {
    fn new(gpu: &Headless) -> Self {
        let layouts = layouts(&gpu.device);
        let uniforms = uniform_bytes().map(|bytes| {
            let usage = wgpu::BufferUsages::UNIFORM;
            let uniform = buffer(&gpu.device, bytes.len() as u64, usage);
            gpu.queue.write_buffer(&uniform, 0, &bytes);
            uniform
        });
        let resources = uniforms.each_ref().map(wgpu::Buffer::as_entire_binding);
        Self {
            ramp: upload_ramp(gpu, &test_ramp()),
            sprite: upload_sprite(gpu, &test_sprite()),
            noise: upload_noise(gpu, test_noise()),
            alpha_bounds: upload_alpha_bounds(gpu, &test_sprite().alpha_bounds(None)),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
            uniforms: bind(&gpu.device, &layouts[1], &resources),
            layouts,
        }
    }
}

fn buffer(device: &wgpu::Device, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("formula"),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Runs a compute shader on cases of `width` numbers each and returns as many results per case. Group 0 has the cases,
/// the results, and the test's textures and sampler; group 1 has the uniforms of the fixture.
pub fn compute(source: &str, cases: &[Vec<f32>], width: usize) -> Vec<Vec<f32>> {
    static FIXTURE: LazyLock<Fixture> = LazyLock::new(|| Fixture::new(gpu()));
    let gpu = gpu();
    let device = &gpu.device;
    let Fixture { layouts, ramp, sprite, noise, alpha_bounds, sampler, uniforms } = &*FIXTURE;
    let mut inputs = vec![0.0_f32; cases.len() * width];
    for (row, case) in inputs.chunks_mut(width).zip(cases) {
        row[..case.len()].copy_from_slice(case);
    }
    let bytes: &[u8] = bytemuck::cast_slice(&inputs);
    let input = buffer(device, bytes.len() as u64, wgpu::BufferUsages::STORAGE);
    let output = buffer(device, bytes.len() as u64, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    gpu.queue.write_buffer(&input, 0, bytes);
    let pipeline = pipeline(device, source, layouts);
    let group = bind(
        device,
        &layouts[0],
        &[
            input.as_entire_binding(),
            output.as_entire_binding(),
            wgpu::BindingResource::TextureView(ramp),
            wgpu::BindingResource::TextureView(sprite),
            wgpu::BindingResource::Sampler(sampler),
            wgpu::BindingResource::TextureView(noise),
            wgpu::BindingResource::TextureView(alpha_bounds),
        ],
    );
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_bind_group(1, uniforms, &[]);
        pass.dispatch_workgroups(cases.len() as u32, 1, 1);
    }
    gpu.submit(encoder).unwrap();
    let results: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&output).unwrap());
    results.chunks(width).map(<[f32]>::to_vec).collect()
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    fn entry<'a>((binding, resource): (u32, &wgpu::BindingResource<'a>)) -> wgpu::BindGroupEntry<'a> {
        wgpu::BindGroupEntry { binding, resource: resource.clone() }
    }
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("formula"), layout, entries: &entries })
}

/// Layouts of groups 0 and 1.
fn layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 2] {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let storage = |read_only| buffer(wgpu::BufferBindingType::Storage { read_only });
    let uniform = buffer(wgpu::BufferBindingType::Uniform);
    let texture =
        |sample_type, view_dimension| wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    let float = |view_dimension| texture(wgpu::TextureSampleType::Float { filterable: true }, view_dimension);
    let layout = |types: &[wgpu::BindingType]| {
        let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let entries: Vec<_> = (0..).zip(types).map(entry).collect();
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("formula"), entries: &entries })
    };
    let inputs = layout(&[
        storage(true),
        storage(false),
        float(wgpu::TextureViewDimension::D2),
        float(wgpu::TextureViewDimension::D2Array),
        wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        float(wgpu::TextureViewDimension::D3),
        texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2),
    ]);
    [inputs, layout(&[uniform; 3])]
}

fn pipeline(device: &wgpu::Device, source: &str, layouts: &[wgpu::BindGroupLayout; 2]) -> wgpu::ComputePipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("formula"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("formula"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("formula"),
            bind_group_layouts: &layouts.each_ref().map(Some),
            immediate_size: 0,
        })),
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

fn upload_alpha_bounds(gpu: &Headless, alpha_bounds: &AlphaBounds) -> wgpu::TextureView {
    let size = alpha_bounds.size();
    let size = wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 };
    let levels = [(alpha_bounds.bytes().to_vec(), 16 * size.width, size)];
    upload(gpu, wgpu::TextureFormat::Rgba32Uint, size, &levels, wgpu::TextureViewDimension::D2)
}

fn upload_ramp(gpu: &Headless, ramp: &Ramp) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: ramp.size().x, height: ramp.size().y, depth_or_array_layers: 1 };
    let texel = |i: u32| ramp.texel(UVec2::new(i % size.width, i / size.width)).extend(1.0);
    let texels: Vec<_> =
        (0..size.width * size.height).flat_map(|i| texel(i).to_array().map(half::f16::from_f32)).collect();
    let bytes: Vec<u8> = texels.iter().flat_map(|channel| channel.to_le_bytes()).collect();
    upload(
        gpu,
        wgpu::TextureFormat::Rgba16Float,
        size,
        &[(bytes, 8 * size.width, size)],
        wgpu::TextureViewDimension::D2,
    )
}

fn upload_sprite(gpu: &Headless, sprite: &Sprite) -> wgpu::TextureView {
    let level = |level: u32| {
        let size = sprite.level_size(level);
        let layers = sprite.frame_count();
        let extent = wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers };
        let texels = (0..layers).flat_map(|f| (0..size).flat_map(move |y| (0..size).map(move |x| (f, x, y))));
        let bytes =
            texels.flat_map(|(f, x, y)| (sprite.texel(level, f, x, y) * 255.0).round().to_array().map(|c| c as u8));
        (bytes.collect(), 4 * size, extent)
    };
    let levels: Vec<_> = (0..sprite.level_count()).map(level).collect();
    let size = levels[0].2;
    upload(gpu, wgpu::TextureFormat::Rgba8Unorm, size, &levels, wgpu::TextureViewDimension::D2Array)
}

fn upload_noise(gpu: &Headless, noise: &NoiseVolume) -> wgpu::TextureView {
    let side = noise.size();
    let size = wgpu::Extent3d { width: side, height: side, depth_or_array_layers: side };
    let voxels = (0..side * side * side).map(|i| UVec3::new(i % side, i / side % side, i / side / side));
    let bytes = voxels.flat_map(|voxel| (noise.texel(voxel) * 255.0).round().to_array().map(|c| c as u8)).collect();
    let levels = [(bytes, 4 * side, size)];
    upload(gpu, wgpu::TextureFormat::Rgba8Unorm, size, &levels, wgpu::TextureViewDimension::D3)
}

fn upload(
    gpu: &Headless,
    format: wgpu::TextureFormat,
    size: wgpu::Extent3d,
    levels: &[(Vec<u8>, u32, wgpu::Extent3d)],
    dimension: wgpu::TextureViewDimension,
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("formula"),
        size,
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: match dimension {
            wgpu::TextureViewDimension::D3 => wgpu::TextureDimension::D3,
            _ => wgpu::TextureDimension::D2,
        },
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, (bytes, bytes_per_row, extent)) in (0..).zip(levels) {
        let target = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(*bytes_per_row),
            rows_per_image: Some(extent.height),
        };
        gpu.queue.write_texture(target, bytes, layout, *extent);
    }
    texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
}
