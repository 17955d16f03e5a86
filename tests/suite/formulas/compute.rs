//! Compute runs of WGSL functions.

use glam::{UVec2, UVec3};
use haze::noise::NoiseVolume;
use haze::ramp::Ramp;
use haze::sprite::Sprite;
use haze::wgpu;
use haze_demo::headless::Headless;

/// Runs a compute shader on cases of `width` numbers each and returns as many results per case. A ramp, a sprite, a
/// noise volume and a sampler are bound too.
pub fn compute(
    gpu: &Headless,
    source: &str,
    cases: &[Vec<f32>],
    width: usize,
    ramp: &Ramp,
    sprite: &Sprite,
    noise: &NoiseVolume,
) -> Vec<Vec<f32>> {
    let device = &gpu.device;
    let mut inputs = vec![0.0_f32; cases.len() * width];
    for (row, case) in inputs.chunks_mut(width).zip(cases) {
        row[..case.len()].copy_from_slice(case);
    }
    let bytes: &[u8] = bytemuck::cast_slice(&inputs);
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("formula"),
            size: bytes.len() as u64,
            usage: usage | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    };
    let (input, output) = (buffer(wgpu::BufferUsages::COPY_DST), buffer(wgpu::BufferUsages::COPY_SRC));
    gpu.queue.write_buffer(&input, 0, bytes);

    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("formula"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let entry =
        |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None };
    let storage = |read_only| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = |view_dimension| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension,
        multisampled: false,
    };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("formula"),
        entries: &[
            entry(0, storage(true)),
            entry(1, storage(false)),
            entry(2, texture(wgpu::TextureViewDimension::D2)),
            entry(3, texture(wgpu::TextureViewDimension::D2Array)),
            entry(4, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(5, texture(wgpu::TextureViewDimension::D3)),
        ],
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("formula"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("formula"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        })),
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &[("EXACT_FILTERING", 1.0)],
            ..Default::default()
        },
        cache: None,
    });
    let (ramp, sprite, noise) = (upload_ramp(gpu, ramp), upload_sprite(gpu, sprite), upload_noise(gpu, noise));
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("formula"),
        layout: &layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&ramp) },
            wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::TextureView(&sprite) },
            wgpu::BindGroupEntry { binding: 4, resource: wgpu::BindingResource::Sampler(&sampler) },
            wgpu::BindGroupEntry { binding: 5, resource: wgpu::BindingResource::TextureView(&noise) },
        ],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(cases.len() as u32, 1, 1);
    }
    gpu.submit(encoder).unwrap();
    let results: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&output).unwrap());
    results.chunks(width).map(<[f32]>::to_vec).collect()
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
