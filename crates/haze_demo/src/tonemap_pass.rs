//! Tonemapping from linear HDR to sRGB: on the CPU for files, on the GPU for windows. Only the demo program tonemaps;
//! the library never changes a host's colors.

use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::tonemap::{DisplayTransform, dither};
use image::{RgbImage, RgbaImage};

use super::shot::Shot;
use haze::shader;

/// Converts a rendered shot to 8-bit sRGB with dithering: exposure and the tonemap of its camera for colors, unchanged values for
/// data.
pub fn tonemap(image: &Image<Vec4>, shot: &Shot) -> RgbImage {
    let mut rounded = Image::new(image.size, [0_u8; 3]);
    let encoded = encoded(image, display_transform(shot));
    rounded.for_each(|at, out| *out = quantise(encoded.load(at.as_ivec2()).xyz(), at));
    // Never the default: there is one texel per pixel.
    RgbImage::from_raw(image.size.x, image.size.y, rounded.texels.into_flattened()).unwrap_or_default()
}

/// As [`tonemap`], but not rounded. Alpha stays.
pub fn encoded(image: &Image<Vec4>, transform: DisplayTransform) -> Image<Vec4> {
    let mut encoded = Image::new(image.size, Vec4::ZERO);
    encoded.for_each(|at, out| {
        let texel = image.load(at.as_ivec2());
        *out = transform.code(texel.xyz()).extend(texel.w);
    });
    encoded
}

/// Rounds an encoded image with alpha to 8 bits, with dithering.
pub fn rgba8(encoded: &Image<Vec4>) -> RgbaImage {
    let mut rounded = Image::new(encoded.size, [0_u8; 4]);
    rounded.for_each(|at, out| *out = rgba8_codes(encoded.load(at.as_ivec2()), at));
    // Never the default: there is one texel per pixel.
    RgbaImage::from_raw(encoded.size.x, encoded.size.y, rounded.texels.into_flattened()).unwrap_or_default()
}

/// As [`rgba8`], for the texel at a position.
pub fn rgba8_codes(encoded: Vec4, at: UVec2) -> [u8; 4] {
    let [r, g, b] = quantise(encoded.xyz(), at);
    [r, g, b, (encoded.w * 255.0 + 0.5) as u8]
}

/// Returns the exposure and the tonemap of a shot, at its time.
pub fn display_transform(shot: &Shot) -> DisplayTransform {
    if shot.debug_view.is_data() {
        return DisplayTransform::DATA;
    }
    let preset = &shot.preset;
    let camera = if preset.animation.is_empty() { preset.camera } else { preset.evaluate(preset.time).camera };
    DisplayTransform { exposure: camera.exposure.exp2(), tonemap: camera.tonemap }
}

/// Dithers and rounds to 8 bits.
fn quantise(encoded: Vec3, at: UVec2) -> [u8; 3] {
    // With the added 0.5 the cast rounds; it also clamps.
    ((encoded + dither(at)) * 255.0 + 0.5).to_array().map(|channel| channel as u8)
}

/// Pass that tonemaps images to targets of one format, as [`tonemap`] does on the CPU.
#[derive(Debug)]
pub struct TonemapPass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

/// Uniforms of the pass. `Tonemap` in tonemap_pass.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TonemapUniform {
    /// Upper left corner in the target, pixels.
    pub origin: Vec2,
    /// Size in the target, pixels. Images are stretched to it.
    pub size: Vec2,
    /// Exposure factors of the first and the second image.
    pub exposure: Vec2,
    /// Distance from the left, pixels, from which on the second image is shown.
    pub split: f32,
    /// Factor on the difference of the two images in sRGB code. 0 shows the images instead.
    pub difference: f32,
    /// Tonemap curves of the first and the second image.
    pub curves: UVec2,
    /// Zero.
    pub padding: UVec2,
}

impl TonemapUniform {
    /// Returns it with the transforms of the first and the second image.
    pub fn with_transforms(self, transforms: [DisplayTransform; 2]) -> Self {
        let [first, second] = transforms;
        Self {
            exposure: Vec2::new(first.exposure, second.exposure),
            curves: UVec2::new(first.tonemap as u32, second.tonemap as u32),
            ..self
        }
    }
}

/// Bind group of two images.
#[derive(Debug)]
pub struct TonemapBindGroup {
    buffer: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl TonemapPass {
    /// Creates the pass. `format` must store sRGB codes without conversion, so it must not end in `Srgb`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        // Cannot fail: the source is embedded, and tests compose it.
        let source = shader::compose(include_str!("tonemap_pass.wgsl")).unwrap_or_default();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("tonemap"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tonemap"),
            entries: &[entry(0, uniform), entry(1, texture), entry(2, texture), entry(3, sampler)],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("tonemap"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("tonemap"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("tonemap"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { layout, pipeline, sampler }
    }

    /// Binds two images; pass a single image twice.
    pub fn bind(&self, device: &wgpu::Device, first: &wgpu::Texture, second: &wgpu::Texture) -> TonemapBindGroup {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("tonemap"),
            size: size_of::<TonemapUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let [first, second] =
            [first, second].map(|texture| texture.create_view(&wgpu::TextureViewDescriptor::default()));
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tonemap"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&first) },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&second) },
                wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        });
        TonemapBindGroup { buffer, group }
    }

    /// Writes the uniforms for the next submission.
    pub fn prepare(&self, queue: &wgpu::Queue, group: &TonemapBindGroup, uniform: &TonemapUniform) {
        queue.write_buffer(&group.buffer, 0, bytemuck::bytes_of(uniform));
    }

    /// Draws within the current viewport and scissor rectangle.
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>, group: &TonemapBindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
