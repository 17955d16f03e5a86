//! Shaders and pipelines of passes, and the states that they share.

use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Shader of a pass. Clones share its module.
#[derive(Clone, Debug)]
pub(crate) struct Shader {
    /// Name of the pass, used as label.
    name: &'static str,
    /// Created on first use: most frames draw few of the passes.
    module: Arc<OnceLock<wgpu::ShaderModule>>,
    /// File of the pass.
    pub path: PathBuf,
    /// WGSL without imports.
    pub text: Arc<str>,
    /// True for haze's own shaders, whose loops end; false for sources of a host.
    loops_end: bool,
}

impl Shader {
    pub fn new(name: &'static str, path: PathBuf, text: Arc<str>, loops_end: bool) -> Self {
        Self { name, module: Arc::default(), path, text, loops_end }
    }

    /// Returns the module.
    pub fn module(&self, device: &wgpu::Device) -> &wgpu::ShaderModule {
        self.module.get_or_init(|| create_module(device, self.name, &self.text, self.loops_end))
    }

    /// True if both have the same module.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.module, &other.module)
    }

    /// Returns the shader with its text changed.
    pub fn with_text(&self, change: impl FnOnce(&str) -> String) -> Self {
        Self::new(self.name, self.path.clone(), change(&self.text).into(), self.loops_end)
    }
}

/// Creates a module. `loops_end`: true if no loop of the text runs forever. wgpu counts the rounds of all other loops, which
/// keeps drivers from unrolling them: on an H100 `tile_accumulate` then takes up to 1.8 times as long.
#[expect(unsafe_code, reason = "wgpu offers no safe way to leave out the counters")]
fn create_module(device: &wgpu::Device, name: &str, text: &str, loops_end: bool) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor { label: Some(name), source: wgpu::ShaderSource::Wgsl(text.into()) };
    if !loops_end {
        return device.create_shader_module(descriptor);
    }
    let mut checks = wgpu::ShaderRuntimeChecks::checked();
    checks.force_loop_bounding = false;
    // SAFETY: every loop of the text ends; `every_loop_of_the_shaders_ends` in tests/suite/shaders.rs. All other checks stay.
    unsafe { device.create_shader_module_trusted(descriptor, checks) }
}

/// Resources that the pipelines of all passes share.
#[derive(Clone, Debug)]
pub(crate) struct PipelineStore {
    pub device: wgpu::Device,
    /// Cache of the host, if the backend supports one.
    pub cache: Option<wgpu::PipelineCache>,
    count: Arc<AtomicUsize>,
}

impl PipelineStore {
    pub fn new(device: &wgpu::Device, cache: Option<&wgpu::PipelineCache>) -> Self {
        Self { device: device.clone(), cache: cache.cloned(), count: Arc::default() }
    }

    /// Counts a compiled pipeline.
    pub fn count_pipeline(&self) {
        self.count.fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the number of pipelines compiled so far.
    pub fn pipeline_count(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }
}

/// Properties that all pipelines of a pass share.
#[derive(Debug)]
pub(crate) struct Common {
    /// Name of the pass, used as label.
    pub name: &'static str,
    pub shader: Shader,
    pub layout: wgpu::PipelineLayout,
    pub store: PipelineStore,
}

/// Variant-specific parts of a pipeline; together with the properties that its pass shares, they create it.
pub(crate) trait PipelineDescription {
    /// Stages that read the pass's own bind group.
    const STAGES: wgpu::ShaderStages;
    type Pipeline: Clone + Debug;

    fn create(&self, common: &Common) -> Self::Pipeline;
}

/// The parts of a render pipeline that differ from variant to variant.
#[derive(Debug)]
pub(crate) struct RenderPipelineDescription {
    pub buffers: &'static [Option<wgpu::VertexBufferLayout<'static>>],
    pub primitive: wgpu::PrimitiveState,
    pub depth_stencil: Option<wgpu::DepthStencilState>,
    pub sample_count: u32,
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    pub constants: Vec<Constant>,
}

/// The parts of a compute pipeline that differ from variant to variant.
#[derive(Debug)]
pub(crate) struct ComputePipelineDescription {
    pub entry_point: &'static str,
    pub constants: Vec<Constant>,
}

impl PipelineDescription for RenderPipelineDescription {
    const STAGES: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX_FRAGMENT;
    type Pipeline = wgpu::RenderPipeline;

    fn create(&self, common: &Common) -> wgpu::RenderPipeline {
        let module = common.shader.module(&common.store.device);
        let options = wgpu::PipelineCompilationOptions { constants: &self.constants, ..Default::default() };
        common.store.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(common.name),
            layout: Some(&common.layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vertex"),
                compilation_options: options.clone(),
                buffers: self.buffers,
            },
            primitive: self.primitive,
            depth_stencil: self.depth_stencil.clone(),
            multisample: wgpu::MultisampleState { count: self.sample_count, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some("fragment"),
                compilation_options: options,
                targets: &self.targets,
            }),
            multiview_mask: None,
            cache: common.store.cache.as_ref(),
        })
    }
}

impl PipelineDescription for ComputePipelineDescription {
    const STAGES: wgpu::ShaderStages = wgpu::ShaderStages::COMPUTE;
    type Pipeline = wgpu::ComputePipeline;

    fn create(&self, common: &Common) -> wgpu::ComputePipeline {
        common.store.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(common.name),
            layout: Some(&common.layout),
            module: common.shader.module(&common.store.device),
            entry_point: Some(self.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &self.constants, ..Default::default() },
            cache: common.store.cache.as_ref(),
        })
    }
}

/// A WGSL override constant: its name and its value.
pub(crate) type Constant = (&'static str, f64);

/// Returns a boolean override constant.
pub(crate) fn bool_constant(name: &'static str, on: bool) -> Constant {
    (name, if on { 1.0 } else { 0.0 })
}

/// Makes an override constant from a setting's enum: the value is the variant's index.
macro_rules! enum_constant {
    ($name:literal, $value:expr) => {
        ($name, f64::from($value as u32))
    };
}
pub(crate) use enum_constant;

/// ONE, ONE_MINUS_SRC_ALPHA: source over destination, both premultiplied.
pub(crate) const PREMULTIPLIED_OVER: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// ONE, ONE on color; alpha is not changed.
pub(crate) const ADDITIVE: wgpu::BlendState = wgpu::BlendState { color: ADD, alpha: KEEP_DESTINATION };

/// ONE, ONE on color; ONE, ONE_MINUS_SRC_ALPHA on alpha.
pub(crate) const WEIGHTED_SUM: wgpu::BlendState = wgpu::BlendState { color: ADD, alpha: wgpu::BlendComponent::OVER };

/// ONE, ONE on color and alpha.
pub(crate) const ADD_ALL: wgpu::BlendState = wgpu::BlendState { color: ADD, alpha: ADD };

/// DST, ZERO on color: destination times source; alpha is not changed.
pub(crate) const MULTIPLY: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: KEEP_DESTINATION,
};

const ADD: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

const KEEP_DESTINATION: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Zero,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// Returns a color target with or without blending.
pub(crate) fn color_target(
    format: wgpu::TextureFormat,
    blend: Option<wgpu::BlendState>,
) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
}

/// Returns a depth state that tests but does not write.
pub(crate) fn read_only_depth(format: wgpu::TextureFormat, compare: wgpu::CompareFunction) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(false),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// Returns the comparison "in front of the surface or on it".
pub(crate) fn depth_compare(reversed: bool) -> wgpu::CompareFunction {
    if reversed { wgpu::CompareFunction::GreaterEqual } else { wgpu::CompareFunction::LessEqual }
}

/// Primitive state of quads: a strip of four corners, visible from both sides.
pub(crate) const QUAD_STRIP: wgpu::PrimitiveState = wgpu::PrimitiveState {
    topology: wgpu::PrimitiveTopology::TriangleStrip,
    strip_index_format: None,
    front_face: wgpu::FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: wgpu::PolygonMode::Fill,
    conservative: false,
};
