//! The GPU device that tests share.

use std::sync::{LazyLock, OnceLock};

use glam::UVec2;
use haze::shader::Sources;
use haze::{Context, wgpu};
use haze_demo::headless::Headless;

/// Returns the device that all tests of this process share. Panics on a machine without an adapter; the message
/// contains the command that installs one.
pub fn gpu() -> &'static Headless {
    static GPU: OnceLock<Headless> = OnceLock::new();
    GPU.get_or_init(|| match Headless::new() {
        Ok(gpu) => {
            eprintln!("adapter: {}", gpu.description());
            gpu
        }
        Err(error) => panic!("{error}"),
    })
}

/// Returns a context for tests that only compare images, so that no pipeline is compiled twice.
pub fn shared_context() -> Context {
    static CONTEXT: LazyLock<Context> = LazyLock::new(|| Context::new(&gpu().device, &gpu().queue));
    CONTEXT.clone()
}

/// Returns a context of its own, for tests that change it. It shares the pipelines of [`shared_context`].
pub fn own_context() -> Context {
    shared_context().with_shaders(&Sources::embedded()).unwrap()
}

/// Returns `is_available`, and prints that the test is skipped if it is false. Panics instead if the variable `HAZE_REQUIRE`
/// lists the capability: on a machine that is known to have it, a skipped test is a failure. The list is separated by commas;
/// `scripts/test` sets it.
pub fn can_test(capability: &str, is_available: bool) -> bool {
    let required = std::env::var("HAZE_REQUIRE").unwrap_or_default();
    let is_required = required.split(',').any(|name| name.trim() == capability);
    assert!(is_available || !is_required, "{} lacks {capability}, which HAZE_REQUIRE lists", gpu().description());
    if !is_available {
        eprintln!("skipped: {} lacks {capability}", gpu().description());
    }
    is_available
}

/// Returns true if the path `tiled` is available: it needs compute shaders, which the library does not use on OpenGL.
pub fn is_tiled_available() -> bool {
    can_test("compute", !is_opengl())
}

/// Returns true if the tests run on OpenGL.
pub fn is_opengl() -> bool {
    gpu().adapter.get_info().backend == wgpu::Backend::Gl
}

/// Returns true if the adapter's devices are independent. On OpenGL they share one context: resources that are dropped with
/// one device are lost for the others.
pub fn has_independent_devices() -> bool {
    can_test("devices", !is_opengl())
}

/// Counts the texels that contain a NaN or an infinity, within the first `size` texels of a texture.
pub fn non_finite_texels(gpu: &Headless, view: &wgpu::TextureView, size: UVec2) -> u32 {
    const SOURCE: &str = "
        @group(0) @binding(0) var texels: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read_write> count: atomic<u32>;
        @compute @workgroup_size(8, 8)
        fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
            // Tests bits: a compiler may remove comparisons with NaN. Texels out of range load as zero or a border.
            let bits = bitcast<vec4u>(textureLoad(texels, id.xy, 0)) & vec4u(0x7f800000u);
            if any(bits == vec4u(0x7f800000u)) { atomicAdd(&count, 1u); }
        }";
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("non-finite texels"),
        source: wgpu::ShaderSource::Wgsl(SOURCE.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("non-finite texels"),
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let count = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("non-finite texels"),
        size: 4,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("non-finite texels"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
            wgpu::BindGroupEntry { binding: 1, resource: count.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(size.x.div_ceil(8), size.y.div_ceil(8), 1);
    }
    gpu.submit(encoder).unwrap();
    bytemuck::pod_read_unaligned(&gpu.read_buffer(&count).unwrap())
}
