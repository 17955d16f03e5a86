//! Embeds haze in a host without a window: own device, depth buffer and render pass. Writes `embed_headless.png`.

use glam::camera::rh;
use glam::{UVec2, Vec3, vec3};
use haze::preset::{ImageSource, MaterialSources};
use haze::{
    Context, FrameInput, Light, ParticleSystem, Particles, Renderer, RendererDescriptor, SceneDepth, Settings, View,
    wgpu,
};

const SIZE: UVec2 = UVec2::new(640, 360);
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The host creates a device, targets and a camera.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
    let target = |format, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    let color = target(COLOR, wgpu::TextureUsages::COPY_SRC);
    let depth = target(DEPTH, wgpu::TextureUsages::TEXTURE_BINDING); // haze reads the depth
    let color_view = color.create_view(&Default::default());
    let depth_view = depth.create_view(&Default::default());
    let view = View::new(
        rh::view::look_at_mat4(vec3(0.0, 1.6, 6.5), vec3(0.0, 1.7, 0.0), Vec3::Y),
        rh::proj::directx::perspective(0.8, SIZE.x as f32 / SIZE.y as f32, 0.1, 100.0),
        SIZE,
    );

    // haze setup, done once.
    let descriptor =
        RendererDescriptor { color_format: COLOR, depth_format: Some(DEPTH), ..RendererDescriptor::default() };
    let context = Context::new(&device, &queue);
    let mut smoke = Renderer::new(&context, &descriptor)?;
    let material = context.create_material(&MaterialSources::default().load(ImageSource::BuiltIn)?)?;

    // haze work of one frame.
    let mut particles = Vec::new();
    haze::emitter::Emitter::default().evaluate(8.0, &mut particles);
    let settings = Settings::default();
    let orange = vec3(1.0, 0.7, 0.4);
    let frame = FrameInput {
        lights: &[Light { position: vec3(-3.0, 3.0, 3.0), color: orange, intensity: 12.0, ..Light::default() }],
        systems: &[ParticleSystem::new(0, Particles::Slice(&particles), &settings, &material)],
        time: 8.0,
        ..FrameInput::new(view, SceneDepth::Buffer(&depth_view))
    };
    let mut encoder = device.create_command_encoder(&Default::default());
    // The host's scene is only a dark wall across the view; the smoke intersects it.
    let wall = view.clip_from_view.project_point3(vec3(0.0, 0.0, -6.6)).z;
    drop(host_pass(
        &mut encoder,
        &color_view,
        &depth_view,
        Some((wgpu::Color { r: 0.02, g: 0.03, b: 0.05, a: 1.0 }, wall)),
    ));
    smoke.prepare(&mut encoder, &frame)?;
    smoke.render(&mut host_pass(&mut encoder, &color_view, &depth_view, None));

    // The host submits, reads back and saves. Rows of 640 pixels are a multiple of 256 bytes, so they need no padding.
    let size = u64::from(4 * SIZE.x * SIZE.y);
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    let read = device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE.x), rows_per_image: None };
    let into = wgpu::TexelCopyBufferInfo { buffer: &read, layout };
    encoder.copy_texture_to_buffer(color.as_image_copy(), into, color.size());
    queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely())?;
    image::save_buffer("embed_headless.png", &read.get_mapped_range(..)?, SIZE.x, SIZE.y, image::ColorType::Rgba8)?;
    Ok(())
}

/// Begins a pass on the host's targets. With `clear` it writes color and depth; without, the depth buffer is attached
/// read-only (no `depth_ops`), as haze requires.
fn host_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: &wgpu::TextureView,
    depth: &wgpu::TextureView,
    clear: Option<(wgpu::Color, f32)>,
) -> wgpu::RenderPass<'a> {
    let load = clear.map_or(wgpu::LoadOp::Load, |(color, _)| wgpu::LoadOp::Clear(color));
    let depth_ops =
        clear.map(|(_, depth)| wgpu::Operations { load: wgpu::LoadOp::Clear(depth), store: wgpu::StoreOp::Store });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops,
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
