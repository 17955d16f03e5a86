//! Pipeline variants, and the states that passes share.

use std::collections::HashMap;
use std::hash::Hash;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::error_scopes::with_error_scopes;
use crate::error::{Error, one_line};

/// Shader of a pass.
#[derive(Clone, Debug)]
pub(crate) struct Shader {
    pub module: wgpu::ShaderModule,
    /// File of the pass.
    pub path: PathBuf,
    /// WGSL without imports.
    pub text: Arc<str>,
    /// True for haze's own shaders, whose loops end; false for sources of a host.
    pub loops_end: bool,
}

impl Shader {
    /// Returns the shader with its text changed. `name`: name of the pass, used as label.
    pub fn with_text(&self, device: &wgpu::Device, name: &str, change: impl FnOnce(&str) -> String) -> Self {
        let text = change(&self.text);
        let module = create_module(device, name, &text, self.loops_end);
        Self { module, path: self.path.clone(), text: text.into(), loops_end: self.loops_end }
    }
}

/// Creates a module. `loops_end`: true if no loop of the text runs forever. wgpu counts the rounds of all other loops, which
/// keeps drivers from unrolling them: on an H100 `tile_accumulate` then takes up to 1.8 times as long.
#[expect(unsafe_code, reason = "wgpu offers no safe way to leave out the counters")]
pub(crate) fn create_module(device: &wgpu::Device, name: &str, text: &str, loops_end: bool) -> wgpu::ShaderModule {
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

    /// Returns the number of pipelines compiled so far.
    pub fn pipeline_count(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }
}

/// Shader of a pass, and its pipelines by key. A pipeline is compiled on first use, from any thread.
#[derive(Debug)]
pub(crate) struct PipelineVariants<K, P: PipelineDescription = RenderPipelineDescription> {
    common: Common,
    describe: fn(K) -> P,
    /// Shared by contexts with the same module.
    pipelines: Arc<Mutex<HashMap<K, P::Pipeline>>>,
}

/// Properties that all pipelines of a pass share.
#[derive(Debug)]
pub(crate) struct Common {
    /// Name of the pass, used as label.
    name: &'static str,
    module: wgpu::ShaderModule,
    path: PathBuf,
    layout: wgpu::PipelineLayout,
    store: PipelineStore,
}

/// Variant-specific parts of a pipeline; together with the properties that its pass shares, they create it.
pub(crate) trait PipelineDescription {
    type Pipeline: Clone + std::fmt::Debug;

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

impl<K: Copy + Eq + Hash, P: PipelineDescription> PipelineVariants<K, P> {
    /// `name`: name of the pass, used as label.
    pub fn new(
        store: &PipelineStore,
        name: &'static str,
        shader: Shader,
        describe: fn(K) -> P,
        groups: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let layout = store.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: groups,
            immediate_size: 0,
        });
        let Shader { module, path, text: _, loops_end: _ } = shader;
        let common = Common { name, module, path, layout, store: store.clone() };
        Self { common, describe, pipelines: Arc::default() }
    }

    /// Shares the pipelines of another context if its module is the same.
    pub fn share(&mut self, other: &Self) {
        if self.common.module == other.common.module {
            self.pipelines = other.pipelines.clone();
        }
    }

    /// Returns the pipeline for `key`; compiles it on first use. The lock is not held during compilation, so other
    /// threads do not wait.
    pub fn get(&self, key: K) -> P::Pipeline {
        let found = self.lock().get(&key).cloned();
        found.unwrap_or_else(|| self.keep(key, self.compile(key)))
    }

    /// Compiles the pipeline for `key`, or returns the shader error.
    pub fn check(&self, key: K) -> Result<(), Error> {
        if self.lock().contains_key(&key) {
            return Ok(());
        }
        let compiled = with_error_scopes(&self.common.store.device, || self.compile(key)).map_err(|reason| {
            let stages = [("VERTEX", "vertex"), ("FRAGMENT", "fragment"), ("COMPUTE", "compute")];
            let plain = |text: String, (stage, name): (&str, _)| text.replace(&format!("ShaderStages({stage})"), name);
            let reason = one_line(stages.into_iter().fold(reason, plain));
            Error::Shader { path: self.common.path.clone(), line: 1, column: 1, reason }
        })?;
        self.keep(key, compiled);
        Ok(())
    }

    /// Stores a compiled pipeline, unless another thread stored one first; returns the stored one.
    fn keep(&self, key: K, compiled: P::Pipeline) -> P::Pipeline {
        let count = &self.common.store.count;
        let stored = |compiled| {
            count.fetch_add(1, Ordering::Relaxed);
            compiled
        };
        self.lock().entry(key).or_insert_with(|| stored(compiled)).clone()
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<K, P::Pipeline>> {
        self.pipelines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn compile(&self, key: K) -> P::Pipeline {
        (self.describe)(key).create(&self.common)
    }
}

impl PipelineDescription for RenderPipelineDescription {
    type Pipeline = wgpu::RenderPipeline;

    fn create(&self, common: &Common) -> wgpu::RenderPipeline {
        let options = wgpu::PipelineCompilationOptions { constants: &self.constants, ..Default::default() };
        common.store.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(common.name),
            layout: Some(&common.layout),
            vertex: wgpu::VertexState {
                module: &common.module,
                entry_point: Some("vertex"),
                compilation_options: options.clone(),
                buffers: self.buffers,
            },
            primitive: self.primitive,
            depth_stencil: self.depth_stencil.clone(),
            multisample: wgpu::MultisampleState { count: self.sample_count, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &common.module,
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
    type Pipeline = wgpu::ComputePipeline;

    fn create(&self, common: &Common) -> wgpu::ComputePipeline {
        common.store.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(common.name),
            layout: Some(&common.layout),
            module: &common.module,
            entry_point: Some(self.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &self.constants, ..Default::default() },
            cache: common.store.cache.as_ref(),
        })
    }
}

/// Makes the [`PipelineVariants`] of a pass's module, which is named like its shader.
macro_rules! pipeline_variants {
    ($store:expr, $shader:expr, $pass:ident, $groups:expr) => {{
        let name = stringify!($pass);
        PipelineVariants::new($store, name, $shader(name)?, $pass::describe, $groups)
    }};
}
pub(crate) use pipeline_variants;

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
