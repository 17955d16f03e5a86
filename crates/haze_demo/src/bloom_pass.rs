//! Bloom on the GPU, as `bloom.rs` does it on the CPU.

use glam::UVec2;

use super::bloom::levels;
use super::scene_pipeline::{COLOR_FORMAT, ScenePipeline, default_view, texture};

/// Pipelines of the passes, shared by all renderers of a device.
#[derive(Debug)]
pub struct BloomPass {
    device: wgpu::Device,
    layout: wgpu::BindGroupLayout,
    halve: wgpu::RenderPipeline,
    double: wgpu::RenderPipeline,
}

/// Pyramid of an image.
#[derive(Debug)]
pub struct BloomLevels {
    image: wgpu::Texture,
    from_image: wgpu::BindGroup,
    /// Finest first.
    levels: Vec<BloomLevel>,
}

#[derive(Debug)]
struct BloomLevel {
    view: wgpu::TextureView,
    group: wgpu::BindGroup,
    /// Part of it that comes from the next.
    spread: f32,
}

/// WGSL of the passes.
pub const BLOOM_SHADER: &str = include_str!("bloom.wgsl");

impl BloomPass {
    /// Compiles the pipelines. `shader`: [`BLOOM_SHADER`], or a changed one for a test.
    pub fn new(device: &wgpu::Device, shader: &str) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("demo bloom"),
            source: wgpu::ShaderSource::Wgsl(shader.into()),
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("demo bloom"),
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
        let pipeline = |fragment, blend| {
            let groups = [Some(&layout)];
            let fragment = Some((fragment, &[COLOR_FORMAT][..]));
            ScenePipeline { groups: &groups, vertex: "vertex", buffers: &[], fragment, depth: false, blend }
                .create(device, &module)
        };
        let by_constant = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        };
        // Alpha of the image stays.
        let kept = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        Self {
            device: device.clone(),
            halve: pipeline("halve_fragment", None),
            double: pipeline("double_fragment", Some(wgpu::BlendState { color: by_constant, alpha: kept })),
            layout,
        }
    }

    /// Creates the pyramid of an image, which must be `Rgba16Float`.
    pub fn levels(&self, image: &wgpu::Texture) -> BloomLevels {
        let size = UVec2::new(image.width(), image.height());
        let level = |(size, spread)| {
            let view = default_view(&texture(&self.device, "demo bloom", size, COLOR_FORMAT));
            let group = self.bind(&view);
            BloomLevel { view, group, spread }
        };
        BloomLevels {
            image: image.clone(),
            from_image: self.bind(&default_view(image)),
            levels: levels(size).into_iter().map(level).collect(),
        }
    }

    fn bind(&self, level: &wgpu::TextureView) -> wgpu::BindGroup {
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo bloom"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(level) }],
        })
    }

    /// Adds bloom to the image. `strength`: fraction of the light that spreads, 0..=1.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, levels: &BloomLevels, strength: f32) {
        let BloomLevels { image, from_image, levels } = levels;
        let mut finer = from_image;
        for level in levels {
            draw(encoder, &self.halve, finer, &level.view, 0.0);
            finer = &level.group;
        }
        for pair in levels.windows(2).rev() {
            let [level, coarser] = pair else { continue };
            draw(encoder, &self.double, &coarser.group, &level.view, level.spread);
        }
        if let Some(finest) = levels.first() {
            draw(encoder, &self.double, &finest.group, &default_view(image), strength);
        }
    }
}

impl BloomLevels {
    /// True if it is of this image.
    pub fn is_of(&self, image: &wgpu::Texture) -> bool {
        self.image == *image
    }

    /// Textures of the levels.
    pub fn textures(&self) -> impl Iterator<Item = &wgpu::Texture> {
        self.levels.iter().map(|level| level.view.texture())
    }
}

fn draw(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
    target: &wgpu::TextureView,
    constant: f32,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("demo bloom"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    });
    let constant = f64::from(constant);
    pass.set_blend_constant(wgpu::Color { r: constant, g: constant, b: constant, a: constant });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..3, 0..1);
}
