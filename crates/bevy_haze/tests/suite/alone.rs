//! The scene drawn by haze and wgpu alone, on the device of a Bevy app.

use std::time::{Duration, Instant};

use bevy::camera::{CameraProjection, PerspectiveProjection};
use bevy::math::{Mat4, Vec3};
use bevy::prelude::Transform;
use bevy::render::RenderApp;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy_haze::haze::settings::Ambient;
use bevy_haze::haze::{
    Context, FrameInput, Light, LightKind, ParticleSystem, Particles, Renderer, RendererDescriptor, SceneDepth,
    Settings, View, glam, wgpu,
};

use crate::host::{
    AMBIENT, BACKGROUND, BOXES, CAMERA, EXPOSURE, Host, LAMP, RADIUS, RANGE, SECONDS, SIZE, SPOT, SPOT_ANGLES, SUN,
    TARGET, plume,
};
use crate::picture::Picture;

const BOX_SHADER: &str = "
    struct Box { clip_from_world: mat4x4f, center: vec4f, size: vec4f, color: vec4f }
    @group(0) @binding(0) var<uniform> shape: Box;
    // Corners of the 12 triangles of a cube, by the bits of their number.
    const CORNERS = array(0, 1, 3, 0, 3, 2, 4, 7, 5, 4, 6, 7, 0, 5, 1, 0, 4, 5, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3);
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
        let corner = CORNERS[index];
        let sign = vec3f(vec3i(corner & 1, (corner >> 1) & 1, corner >> 2)) - 0.5;
        return shape.clip_from_world * vec4f(shape.center.xyz + sign * shape.size.xyz, 1.0);
    }
    @fragment fn fragment() -> @location(0) vec4f { return shape.color; }
";

fn vec3(v: Vec3) -> glam::Vec3 {
    v.to_array().into()
}

fn mat4(m: Mat4) -> glam::Mat4 {
    glam::Mat4::from_cols_array(&m.to_cols_array())
}

/// Lights of the scene in haze's units: Φ/(4π²) for a point or spot light, E/π for the sun, times the exposure.
fn lights() -> [Light; 3] {
    let pi = std::f32::consts::PI;
    let exposure = EXPOSURE.exposure();
    let point = |(position, color, lumens): (Vec3, [f32; 3], f32)| Light {
        position: vec3(position),
        color: color.into(),
        intensity: lumens / (4.0 * pi * pi) * exposure,
        range: RANGE,
        radius: RADIUS,
        ..Light::default()
    };
    let [inner_angle, outer_angle] = SPOT_ANGLES.map(f32::to_degrees);
    let direction = vec3(TARGET - SPOT.0);
    let (sun, lux) = SUN;
    [
        point(LAMP),
        Light { kind: LightKind::Spot, direction, inner_angle, outer_angle, ..point(SPOT) },
        Light {
            kind: LightKind::Directional,
            direction: vec3(-sun),
            intensity: lux / pi * exposure,
            ..Light::default()
        },
    ]
}

/// Picture of the scene, as [`Host::scene`] draws it.
pub fn picture(host: &Host) -> Picture {
    draw(host, 1).0
}

/// Picture of the scene after some frames, and the time that `prepare` took in each.
pub fn draw(host: &Host, frames: u32) -> (Picture, Vec<Duration>) {
    let world = host.app.sub_app(RenderApp).world();
    let device = world.resource::<RenderDevice>().wgpu_device().clone();
    let queue: &wgpu::Queue = world.resource::<RenderQueue>();

    let world_from_view = Transform::from_translation(CAMERA).looking_at(TARGET, Vec3::Y).to_matrix();
    let view_from_world = world_from_view.inverse();
    let mut projection = PerspectiveProjection::default();
    projection.update(SIZE.x as f32, SIZE.y as f32);
    let clip_from_view = projection.get_clip_from_view();

    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
    let color = texture(&device, wgpu::TextureFormat::Rgba16Float, usage | wgpu::TextureUsages::COPY_SRC);
    let depth = texture(&device, wgpu::TextureFormat::Depth32Float, usage | wgpu::TextureUsages::TEXTURE_BINDING);
    let color_view = color.create_view(&Default::default());
    let depth_view = depth.create_view(&Default::default());

    let context = Context::new(&device, queue);
    let mut renderer = Renderer::new(&context, &RendererDescriptor::default()).unwrap();
    let smoke = &plume().systems[0];
    let material = context.create_material(&smoke.images).unwrap();
    let ambient = glam::Vec3::splat(AMBIENT * EXPOSURE.exposure());
    let ambient = Ambient { intensity: 1.0, sky_color: ambient, ground_color: ambient };
    let settings = Settings { ambient, ..smoke.preset.settings };
    let snapshot = smoke.preset.emitter_snapshot(SECONDS);
    let size = glam::UVec2::new(SIZE.x, SIZE.y);
    let frame = FrameInput {
        lights: &lights(),
        systems: &[ParticleSystem::new(0, Particles::Emitter(&snapshot), &settings, &material)],
        ..FrameInput::new(View::new(mat4(view_from_world), mat4(clip_from_view), size), SceneDepth::Buffer(&depth_view))
    };
    let mut times = Vec::new();
    loop {
        let mut encoder = device.create_command_encoder(&Default::default());
        draw_boxes(&device, &mut encoder, clip_from_view * view_from_world, &color_view, &depth_view);
        let started = Instant::now();
        renderer.prepare(&mut encoder, &frame).unwrap();
        times.push(started.elapsed());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[attachment(&color_view, wgpu::LoadOp::Load)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth_view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..Default::default()
        });
        renderer.render(&mut pass);
        drop(pass);
        let picture = read(&device, queue, encoder, &color);
        if times.len() as u32 == frames {
            return (picture, times);
        }
    }
}

fn texture(device: &wgpu::Device, format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

fn draw_boxes(
    device: &wgpu::Device,
    encoder: &mut wgpu::CommandEncoder,
    clip_from_world: Mat4,
    color: &wgpu::TextureView,
    depth: &wgpu::TextureView,
) {
    let source = wgpu::ShaderSource::Wgsl(BOX_SHADER.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(wgpu::TextureFormat::Rgba16Float.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let groups = BOXES.map(|(center, size, [r, g, b])| {
        let numbers = clip_from_world.to_cols_array().into_iter().chain(center.extend(0.0).to_array());
        let numbers = numbers.chain(size.extend(0.0).to_array()).chain([r, g, b, 1.0]);
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::UNIFORM,
            mapped_at_creation: true,
        });
        buffer.slice(..).get_mapped_range_mut().unwrap().copy_from_slice(&bytes);
        buffer.unmap();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        })
    });
    let [r, g, b] = BACKGROUND.map(f64::from);
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[attachment(color, wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }))],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    for group in &groups {
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..36, 0..1);
    }
}

fn read(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    color: &wgpu::Texture,
) -> Picture {
    let row = SIZE.x * 8;
    assert!(row.is_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * SIZE.y),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(color.as_image_copy(), to, color.size());
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    Picture::from_half(SIZE.x, SIZE.y, &buffer.slice(..).get_mapped_range().unwrap())
}
