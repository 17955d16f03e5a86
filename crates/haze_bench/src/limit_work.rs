//! Passes without any code of haze, and their execution time.

use std::time::Instant;

use glam::UVec2;
use haze::wgpu;
use haze_core::error::Error;
use haze_core::settings::AccumulationFormat;
use haze_demo::headless::Headless;

pub enum Work {
    /// Draws `layers` instances of the pipeline's triangle; without a pipeline it only clears the target.
    Draw {
        pipeline: Option<(wgpu::RenderPipeline, Option<wgpu::BindGroup>)>,
        target: wgpu::TextureView,
        layers: u32,
    },
    Compute {
        pipeline: wgpu::ComputePipeline,
        bindings: wgpu::BindGroup,
        groups: UVec2,
    },
    /// Copies the texture `times` times.
    Copy {
        from: wgpu::Texture,
        to: wgpu::Texture,
        times: u32,
    },
}

pub struct LimitBench<'a> {
    pub gpu: &'a Headless,
    /// A query set of two timestamps and the buffer that they are resolved to; `None` without timestamp queries, and on software
    /// adapters.
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
    module: wgpu::ShaderModule,
    sampler: wgpu::Sampler,
    source: wgpu::TextureView,
    depth: wgpu::TextureView,
    pub size: UVec2,
}

impl<'a> LimitBench<'a> {
    pub fn new(gpu: &'a Headless, size: UVec2) -> Self {
        let device = &gpu.device;
        let target =
            |format, usage| texture(gpu, size, format, usage).create_view(&wgpu::TextureViewDescriptor::default());
        // lavapipe's timestamps of compute passes leave their work out.
        let is_software = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let is_timed = device.features().contains(wgpu::Features::TIMESTAMP_QUERY) && !is_software;
        let queries = is_timed.then(|| {
            let set = wgpu::QuerySetDescriptor { label: None, ty: wgpu::QueryType::Timestamp, count: 2 };
            let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
            let buffer = wgpu::BufferDescriptor { label: None, size: 16, usage, mapped_at_creation: false };
            (device.create_query_set(&set), device.create_buffer(&buffer))
        });
        Self {
            gpu,
            queries,
            module: device.create_shader_module(wgpu::include_wgsl!("limits.wgsl")),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            source: disc(gpu),
            depth: target(wgpu::TextureFormat::Depth32Float, wgpu::TextureUsages::empty()),
            size,
        }
    }

    /// Prepares a pass of `layers` layers with a fragment entry point; `None` makes an empty pass.
    pub fn draw(&self, entry: Option<&str>, format: AccumulationFormat, layers: u32) -> Work {
        let format = texture_format(format);
        let target = texture(self.gpu, self.size, format, wgpu::TextureUsages::empty());
        let component = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
            operation: wgpu::BlendOperation::Add,
        };
        let pipeline = entry.map(|entry| {
            let pipeline = self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(entry),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &self.module,
                    entry_point: Some("cover"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: wgpu::TextureFormat::Depth32Float,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format,
                        blend: Some(wgpu::BlendState { color: component, alpha: component }),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            });
            let bindings = self.bindings(&pipeline, entry);
            (pipeline, bindings)
        });
        Work::Draw { pipeline, target: target.create_view(&Default::default()), layers }
    }

    /// Creates the bind group of an entry point. An automatic layout has only the bindings that the entry point uses.
    fn bindings(&self, pipeline: &wgpu::RenderPipeline, name: &str) -> Option<wgpu::BindGroup> {
        let entries = [
            entry(0, wgpu::BindingResource::TextureView(&self.source)),
            entry(1, wgpu::BindingResource::Sampler(&self.sampler)),
        ];
        let entries = match name {
            "constant" => return None,
            "joint_bilateral" => &entries[..1],
            _ => &entries[..],
        };
        let layout = &pipeline.get_bind_group_layout(0);
        Some(self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries }))
    }

    /// Prepares a dispatch that blends `layers` layers in registers.
    pub fn compute(&self, layers: u32) -> Work {
        let device = &self.gpu.device;
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("blend in registers"),
            layout: None,
            module: &self.module,
            entry_point: Some("blend_in_registers"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("layers", f64::from(layers))],
                ..Default::default()
            },
            cache: None,
        });
        let usage = wgpu::TextureUsages::STORAGE_BINDING;
        let written = texture(self.gpu, self.size, wgpu::TextureFormat::Rgba16Float, usage);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&self.source)),
                entry(1, wgpu::BindingResource::Sampler(&self.sampler)),
                entry(2, wgpu::BindingResource::TextureView(&written.create_view(&Default::default()))),
            ],
        });
        Work::Compute { pipeline, bindings, groups: (self.size + 7) / 8 }
    }
}

impl LimitBench<'_> {
    /// Returns true if GPU timestamps measure this work; other work is measured by wall time.
    pub fn is_timed(&self, work: &Work) -> bool {
        self.queries.is_some() && !matches!(work, Work::Copy { .. })
    }

    /// Executes the work and returns its milliseconds; `None` if the GPU's timestamps are equal or reversed.
    pub fn frame(&self, work: &Work) -> Result<Option<f64>, Error> {
        let device = &self.gpu.device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let set = self.queries.as_ref().map(|(set, _)| set);
        match work {
            Work::Draw { pipeline, target, layers } => {
                let ops = wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                };
                let writes = |query_set| wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(0),
                    end_of_pass_write_index: Some(1),
                };
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: target,
                        depth_slice: None,
                        resolve_target: None,
                        ops,
                    })],
                    depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                        view: &self.depth,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(1.0),
                            store: wgpu::StoreOp::Discard,
                        }),
                        stencil_ops: None,
                    }),
                    timestamp_writes: set.map(writes),
                    ..Default::default()
                });
                if let Some((pipeline, bindings)) = pipeline {
                    pass.set_pipeline(pipeline);
                    if let Some(bindings) = bindings {
                        pass.set_bind_group(0, bindings, &[]);
                    }
                    pass.draw(0..3, 0..*layers);
                }
            }
            Work::Compute { pipeline, bindings, groups } => {
                let writes = |query_set| wgpu::ComputePassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(0),
                    end_of_pass_write_index: Some(1),
                };
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: None,
                    timestamp_writes: set.map(writes),
                });
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, bindings, &[]);
                pass.dispatch_workgroups(groups.x, groups.y, 1);
            }
            Work::Copy { from, to, times } => {
                for _ in 0..*times {
                    encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), from.size());
                }
            }
        }
        let queries = self.queries.as_ref().filter(|_| self.is_timed(work));
        if let Some((set, buffer)) = queries {
            encoder.resolve_query_set(set, 0..2, buffer, 0);
        }
        let started = Instant::now();
        self.gpu.submit(encoder)?;
        let wall = started.elapsed().as_secs_f64() * 1000.0;
        let Some((_, buffer)) = queries else { return Ok(Some(wall)) };
        let ticks: Vec<u64> = self.gpu.read_buffer(buffer)?.chunks_exact(8).map(bytemuck::pod_read_unaligned).collect();
        let ms_per_tick = f64::from(self.gpu.queue.get_timestamp_period()) * 1.0e-6;
        Ok((ticks[0] < ticks[1]).then(|| (ticks[1] - ticks[0]) as f64 * ms_per_tick))
    }
}

/// Side of the disc's texture, texels.
const DISC: u32 = 256;

/// Creates the simplest sprite: an amount that fades to zero within a circle. It has transparent corners because
/// transparent fragments cost less than others.
fn disc(gpu: &Headless) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let disc = texture(gpu, UVec2::splat(DISC), wgpu::TextureFormat::Rgba8Unorm, usage);
    let texel = |index: u32| {
        let position = (UVec2::new(index % DISC, index / DISC).as_vec2() + 0.5) * (2.0 / DISC as f32) - 1.0;
        let amount = (1.0 - position.length_squared()).max(0.0);
        [200, 160, 120, (amount * 255.0) as u8]
    };
    let texels: Vec<u8> = (0..DISC * DISC).flat_map(texel).collect();
    let rows = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * DISC), rows_per_image: None };
    gpu.queue.write_texture(disc.as_image_copy(), &texels, rows, disc.size());
    disc.create_view(&wgpu::TextureViewDescriptor::default())
}

pub fn texture(gpu: &Headless, size: UVec2, format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("limits"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn entry(binding: u32, resource: wgpu::BindingResource<'_>) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource }
}

/// Bytes per texel of a blend target.
pub fn bytes(format: AccumulationFormat) -> u32 {
    texture_format(format).block_copy_size(None).unwrap_or_default()
}

fn texture_format(format: AccumulationFormat) -> wgpu::TextureFormat {
    match format {
        AccumulationFormat::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        AccumulationFormat::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
    }
}
