//! Host passes with every supported format and sample count, and the passes and resources that are rejected.

use glam::Vec4;
use haze::{Context, Renderer, RendererDescriptor, wgpu};
use haze_core::error::Error;
use haze_core::settings::*;

use super::{SIZE, device_with_optional_features, encoder, rejected_field, slice};
use crate::gpu::{can_test, gpu, has_independent_devices, is_tiled_available};
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_host::{Host, HostKind};
use crate::test_scene::{BACKDROP, DepthKind, TestScene};

#[test]
fn one_prepare_serves_every_debug_view() {
    for path in [RenderPath::Raster, RenderPath::Forward] {
        let mut all = TestScene::new(SIZE);
        all.settings.path = path;
        all.debug_views = Some(DebugView::ALL);
        let mut host = Host::new(gpu(), &all).unwrap();
        let mut encoder = encoder(gpu());
        host.prepare(&mut encoder, &all, slice(&all)).unwrap();
        gpu().submit(encoder).unwrap();
        for &scene in DebugView::ALL {
            let separate = TestScene { debug_view: scene, debug_views: None, ..TestScene::new(SIZE) };
            let separate = TestScene { settings: all.settings, ..separate };
            all.debug_view = scene;
            let mut encoder = self::encoder(gpu());
            host.render(&mut encoder, &all);
            gpu().submit(encoder).unwrap();
            assert!(host.image(gpu()).unwrap() == separate.on_gpu(gpu()).image, "{path:?} {scene:?}");
        }
    }
    // A debug view that `prepare` was not told about draws nothing.
    let scene =
        TestScene { debug_views: Some(&[DebugView::Final]), debug_view: DebugView::Overdraw, ..TestScene::new(SIZE) };
    assert!(scene.on_gpu(gpu()).image.texels.iter().all(|texel| *texel == BACKDROP));
}

#[test]
fn every_target_format_and_sample_count_shows_the_same_smoke() {
    use wgpu::TextureFormat as Format;
    let host = HostKind::default;
    // (name, lowest PSNR against the reference, host). Rg11b10Ufloat rounds more coarsely than the other formats.
    let kinds = [
        ("four samples", MIN_PSNR, HostKind { samples: 4, ..host() }),
        ("four samples, sRGB", MIN_PSNR, HostKind { samples: 4, color_format: Format::Rgba8UnormSrgb, ..host() }),
        ("Depth24Plus", MIN_PSNR, HostKind { depth_format: Format::Depth24Plus, ..host() }),
        // One step of 16 bits is 2 cm at 12 m from the camera.
        ("Depth16Unorm", 50.0, HostKind { depth_format: Format::Depth16Unorm, ..host() }),
        ("Depth24PlusStencil8", MIN_PSNR, HostKind { depth_format: Format::Depth24PlusStencil8, ..host() }),
        ("Depth32FloatStencil8", MIN_PSNR, HostKind { depth_format: Format::Depth32FloatStencil8, ..host() }),
        ("Rg11b10Ufloat", 50.0, HostKind { color_format: Format::Rg11b10Ufloat, ..host() }),
        ("Rgb10a2Unorm, linear", MIN_PSNR, HostKind { color_format: Format::Rgb10a2Unorm, ..host() }),
        ("Rgba8UnormSrgb", MIN_PSNR, HostKind { color_format: Format::Rgba8UnormSrgb, ..host() }),
        ("Bgra8UnormSrgb", MIN_PSNR, HostKind { color_format: Format::Bgra8UnormSrgb, ..host() }),
        ("Rgba8Unorm, linear", MIN_PSNR, HostKind { color_format: Format::Rgba8Unorm, ..host() }),
        (
            "four samples and stencil",
            MIN_PSNR,
            HostKind { samples: 4, depth_format: Format::Depth24PlusStencil8, ..host() },
        ),
        ("velocity", MIN_PSNR, HostKind { additional_attachments: vec![Format::Rg16Float, Format::R8Unorm], ..host() }),
    ];
    for (name, least, kind) in kinds {
        for (path, attach_depth) in
            [(RenderPath::Raster, true), (RenderPath::Forward, true), (RenderPath::Raster, false)]
        {
            let mut scene = TestScene::new(SIZE);
            scene.depth = DepthKind::Both;
            scene.attach_depth = attach_depth;
            scene.settings.path = path;
            scene.host = kind.clone();
            let mut host = match Host::new(device_with_optional_features(), &scene) {
                Ok(host) => host,
                // The error names a format that the adapter does not support.
                Err(Error::Field(error)) => {
                    eprintln!("skipped: {name}: {error}");
                    continue;
                }
                Err(error) => panic!("{error}"),
            };
            host.draw(device_with_optional_features(), &scene).unwrap();
            device_with_optional_features().check().unwrap_or_else(|error| panic!("{name}: {error}"));
            let mut image = host.image(device_with_optional_features()).unwrap();
            let mut reference = scene.on_cpu();
            if kind.color_format != Format::Rgba16Float && kind.color_format != Format::Rg11b10Ufloat {
                reference.texels.iter_mut().for_each(|texel| *texel = texel.min(Vec4::ONE));
            }
            if kind.color_format == Format::Rg11b10Ufloat {
                reference.texels.iter_mut().for_each(|texel| texel.w = 1.0);
            }
            // Two bits of alpha.
            if kind.color_format == Format::Rgb10a2Unorm {
                image.texels.iter_mut().chain(&mut reference.texels).for_each(|texel| texel.w = 1.0);
            }
            let psnr = psnr(&image, &reference);
            println!("{name}, {}, depth {attach_depth}: {psnr:.1} dB", path.name());
            assert!(psnr >= least, "{name}, {}: {psnr:.1} dB", path.name());
            for (index, format) in kind.additional_attachments.iter().enumerate() {
                let untouched =
                    host.additional_attachments(device_with_optional_features(), index).texels.iter().all(|texel| {
                        // The host cleared the attachment to the backdrop.
                        (texel.x - BACKDROP.x).abs() < 1.0 / 255.0
                    });
                assert!(untouched, "the smoke was drawn to the additional attachment {format:?}");
            }
        }
    }
}

#[test]
fn multisampled_targets_show_the_same_smoke_with_any_depth_attachment() {
    let mut scene = TestScene::new(SIZE);
    let single = scene.on_gpu(gpu()).image;
    scene.host.samples = 4;
    let multisampled = scene.on_gpu(gpu()).image;
    let same = psnr(&multisampled, &single);
    // The blended samples of a pixel are averaged, and rounded once more.
    assert!(same >= 80.0, "{same:.1} dB from one sample");
    let mut with_stencil = scene.clone();
    with_stencil.host.depth_format = wgpu::TextureFormat::Depth24PlusStencil8;
    scene.attach_depth = false;
    for (name, scene) in [("not attached", scene), ("Depth24PlusStencil8", with_stencil)] {
        let same = psnr(&scene.on_gpu(gpu()).image, &multisampled);
        println!("{name}: {same:.1} dB");
        assert!(same >= 97.0, "{name}: {same:.1} dB");
    }
}

#[test]
fn multisampled_depth_is_resolved_to_the_farthest_sample() {
    use wgpu::TextureFormat::{Depth24PlusStencil8, Depth32Float};
    if !is_tiled_available() {
        // OpenGL cannot read multisampled depth.
        let mut scene = TestScene::new(SIZE);
        scene.depth = DepthKind::Multisampled;
        scene.host.samples = 4;
        assert_eq!(rejected_field(Host::new(gpu(), &scene).unwrap().draw(gpu(), &scene)), "scene_depth");
        return;
    }
    let reversed = glam::camera::rh::proj::directx::perspective(0.9, SIZE.x as f32 / SIZE.y as f32, 60.0, 0.1);
    for (path, depth_format, is_reversed) in [
        (RenderPath::Raster, Depth32Float, false),
        (RenderPath::Raster, Depth24PlusStencil8, true),
        (RenderPath::Tiled, Depth32Float, true),
        (RenderPath::Forward, Depth32Float, false),
    ] {
        for attach_depth in [true, false] {
            let mut scene = TestScene::new(SIZE);
            scene.depth = DepthKind::Multisampled;
            scene.attach_depth = attach_depth;
            scene.settings.path = path;
            scene.host.samples = 4;
            scene.host.depth_format = depth_format;
            // The hardware tests every sample of an attached buffer, and would hide a quarter of the smoke.
            scene.host.has_near_sample = !attach_depth;
            if is_reversed {
                scene.view.clip_from_view = reversed;
            }
            assert_eq!(scene.is_reversed(), is_reversed);
            let mut host = Host::new(gpu(), &scene).unwrap();
            host.draw(gpu(), &scene).unwrap();
            gpu().check().unwrap();
            let psnr = psnr(&host.image(gpu()).unwrap(), &scene.on_cpu());
            println!("{path:?} {depth_format:?} attached {attach_depth}: {psnr:.1} dB");
            assert!(psnr >= MIN_PSNR, "{path:?} {depth_format:?} attached {attach_depth}: {psnr:.1} dB");
        }
    }
}

#[test]
fn every_sample_in_front_of_the_smoke_of_a_multisampled_pass_stays_clear() {
    if !is_tiled_available() {
        return;
    }
    for path in [RenderPath::Raster, RenderPath::Tiled, RenderPath::Forward] {
        let mut scene = TestScene::new(SIZE);
        scene.depth = DepthKind::Multisampled;
        scene.host.samples = 4;
        scene.settings.path = path;
        // It is not tested by the hardware: it lies over whole pixels.
        scene.settings.specular_scatter.intensity = 0.0;
        let whole = scene.on_gpu(gpu()).image;
        // One sample of every pixel is an object's.
        scene.host.has_near_sample = true;
        let outlines = scene.on_gpu(gpu()).image;
        let expected = whole.texels.iter().map(|smoke| smoke.lerp(BACKDROP, 0.25));
        let errors = outlines.texels.iter().zip(expected).map(|(found, expected)| (found - expected).abs());
        let most = errors.map(|error| error.max_element()).fold(0.0, f32::max);
        println!("{path:?}: {most:.4} off");
        assert!(most <= 0.02, "{path:?}: {most} off");
    }
}

#[test]
fn depth_of_a_mip_level_is_measured_by_the_target_size() {
    let mut scene = TestScene::new(SIZE);
    scene.attach_depth = false;
    let mut host = Host::new(gpu(), &scene).unwrap();
    let expected = scene.on_gpu(gpu()).image;
    let texture = gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 2 * SIZE.x, height: 2 * SIZE.y, depth_or_array_layers: 1 },
        mip_level_count: 2,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let mut level = texture.as_image_copy();
    level.mip_level = 1;
    let linear = scene.linear_depth();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE.x), rows_per_image: None };
    let size = wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 };
    gpu().queue.write_texture(level, bytemuck::cast_slice(&linear.texels), layout, size);
    host.linear = texture.create_view(&wgpu::TextureViewDescriptor {
        base_mip_level: 1,
        mip_level_count: Some(1),
        ..Default::default()
    });
    scene.depth = DepthKind::Linear;
    scene.host.target_size = Some(SIZE);
    host.draw(gpu(), &scene).unwrap();
    let psnr = psnr(&host.image(gpu()).unwrap(), &expected);
    assert!(psnr >= MIN_PSNR, "{psnr:.1} dB");
    scene.host.target_size = Some(SIZE + 1);
    assert_eq!(rejected_field(host.draw(gpu(), &scene)), "target_size");
}

#[test]
fn srgb_view_of_a_gamma_target_blends_smoke_and_glow_in_linear_light() {
    let flags = gpu().adapter.get_downlevel_capabilities().flags;
    if !can_test("view_formats", flags.contains(wgpu::DownlevelFlags::VIEW_FORMATS)) {
        return;
    }
    for path in [RenderPath::Raster, RenderPath::Forward] {
        let mut scene = TestScene::new(SIZE);
        scene.settings.path = path;
        scene.lights.iter_mut().for_each(|light| light.intensity *= 0.1);
        let expected = scene.on_cpu();
        scene.host.color_format = wgpu::TextureFormat::Rgba8UnormSrgb;
        scene.host.stored_format = Some(wgpu::TextureFormat::Rgba8Unorm);
        let mut image = scene.on_gpu(gpu()).image;
        // The texture is read back as what it stores: code.
        image.for_each(|_, texel| {
            *texel = texel.truncate().map(haze_core::formula::color::linear_from_srgb).extend(texel.w);
        });
        let psnr = psnr(&image, &expected);
        assert!(psnr >= 55.0, "{}: {psnr:.1} dB", path.name());
    }
}

#[test]
fn unsupported_pass_descriptors_are_rejected_with_the_name_of_the_field() {
    use wgpu::TextureFormat as Format;
    let context = Context::new(&gpu().device, &gpu().queue);
    let new = |descriptor: &RendererDescriptor<'_>| Renderer::new(&context, descriptor);
    let refused = |descriptor: RendererDescriptor<'_>| rejected_field(new(&descriptor));
    let plain = RendererDescriptor::default();
    new(&plain).unwrap();
    for color_format in
        [Format::Rgba8Uint, Format::Rgba8Snorm, Format::Rgb9e5Ufloat, Format::Depth32Float, Format::Bc1RgbaUnorm]
    {
        assert_eq!(refused(RendererDescriptor { color_format, ..plain }), "color_format", "{color_format:?}");
    }
    assert_eq!(refused(RendererDescriptor { depth_format: Some(Format::Rgba8Unorm), ..plain }), "depth_format");
    assert_eq!(refused(RendererDescriptor { depth_format: Some(Format::Stencil8), ..plain }), "depth_format");
    for sample_count in [0, 3, 64] {
        assert_eq!(refused(RendererDescriptor { sample_count, ..plain }), "sample_count", "{sample_count}");
    }
    let additional_attachments = [None, Some(Format::Rgb9e5Ufloat)];
    assert_eq!(
        refused(RendererDescriptor { other_color_formats: &additional_attachments, ..plain }),
        "other_color_formats[1]"
    );
    assert_eq!(refused(RendererDescriptor { other_color_formats: &[None; 8], ..plain }), "other_color_formats");
    let scene_color_format = Some(Format::Rgba8Uint);
    assert_eq!(refused(RendererDescriptor { scene_color_format, ..plain }), "scene_color_format");
    let error = new(&RendererDescriptor { color_format: Format::Rgba8Uint, ..plain }).unwrap_err().to_string();
    assert!(error.contains("Rgba8Uint") && error.contains("Rgba16Float") && !error.contains('\n'), "{error}");
    // The host's error handler received no error.
    gpu().check().unwrap();
}

#[test]
fn resources_of_another_device_are_rejected() {
    let scene = TestScene::new(SIZE);
    let here = gpu();
    if !has_independent_devices() {
        return;
    }
    let (device, queue) = pollster::block_on(here.adapter.request_device(&wgpu::DeviceDescriptor::default())).unwrap();
    let context = Context::new(&device, &queue);
    let mut host = Host::new(here, &scene).unwrap();
    let material = context.create_material(&scene.material).unwrap();
    let own = std::mem::replace(&mut host.material, material);
    assert_eq!(rejected_field(host.draw(here, &scene)), "systems[0].material");
    // The same for another wgpu instance; wgpu itself may confuse devices of different instances.
    host.material = Host::new(device_with_optional_features(), &scene).unwrap().material;
    assert_eq!(rejected_field(host.draw(here, &scene)), "systems[0].material");
    host.material = own;
    let depth = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: host.depth.texture().size(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
    let own = std::mem::replace(&mut host.depth, depth);
    assert_eq!(rejected_field(host.draw(here, &scene)), "scene_depth");
    host.depth = own;
    host.draw(here, &scene).unwrap();
    here.check().unwrap();
}

#[test]
fn unreadable_scene_depth_is_rejected() {
    let mut scene = TestScene::new(SIZE);
    scene.host.depth_format = wgpu::TextureFormat::Depth24PlusStencil8;
    scene.depth = DepthKind::Buffer;
    scene.attach_depth = false;
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    let texture = |layers, samples, usage| {
        gpu().device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage,
            view_formats: &[],
        })
    };
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT;
    let whole = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let both_aspects = whole(host.depth.texture());
    let cases = [
        ("both aspects", both_aspects),
        ("two layers", whole(&texture(2, 1, usage))),
        ("four samples", whole(&texture(1, 4, usage))),
        ("not to be sampled", whole(&texture(1, 1, wgpu::TextureUsages::RENDER_ATTACHMENT))),
        ("a color", whole(&host.color)),
    ];
    for (name, view) in cases {
        let own = std::mem::replace(&mut host.depth, view);
        assert_eq!(rejected_field(host.draw(gpu(), &scene)), "scene_depth", "{name}");
        // The previous frame is not drawn in its place.
        let mut encoder = encoder(gpu());
        host.render(&mut encoder, &scene);
        gpu().submit(encoder).unwrap();
        assert!(host.image(gpu()).unwrap().texels.iter().all(|&texel| texel == BACKDROP), "{name}");
        host.depth = own;
    }
    // A view of one layer of an array texture is accepted.
    let array = texture(3, 1, usage);
    host.depth = array.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: 1,
        array_layer_count: Some(1),
        ..Default::default()
    });
    host.draw(gpu(), &scene).unwrap();
    gpu().check().unwrap();
}
