//! Passes that write every texel of a system's targets, every cell or every pixel, by drawing or by computing.

use std::fmt::Debug;
use std::hash::Hash;

use haze_core::error::PrepareError;
use haze_core::glam::UVec2;

use super::groups::Groups;
use crate::renderer::gpu::binding::written_texture;
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::{
    ComputePipelineDescription, Constant, PipelineStore, RenderPipelineDescription, Shader, color_target,
    read_only_depth,
};
use crate::renderer::gpu::record::{color_attachment, set_viewport_and_scissor, written_depth};
use crate::renderer::layouts::{GroupSet, Layouts};
use crate::renderer::pipeline_variants::{PipelineKey, PipelineVariants};
use crate::renderer::targets::{InputGroups, PlannedTarget, SystemTextures, Target};

/// Declaration of a texel pass, in its file: the key of its pipelines implements it.
pub(crate) trait TexelKey: Copy + Debug + Eq + Hash {
    /// Name of the pass: of its shader, and in times and captures.
    const PASS: &'static str;
    /// Types of the textures that it reads: the first bindings of group 3.
    const READS: &'static [wgpu::BindingType];
    /// Targets of the compute shader, if there is one: the bindings after them. The first gives the number of invocations.
    const COMPUTED: &'static [Target];
    /// Entry point of the compute shader.
    const ENTRY_POINT: &'static str = "texels";

    /// False if the shader has no render pass.
    const IS_DRAWN: bool = true;

    /// Returns the targets of the render pass: one depth, or at most two colors.
    fn drawn(self) -> &'static [Target];

    /// Returns the textures of `READS`.
    fn reads(textures: SystemTextures<'_>) -> Vec<&wgpu::TextureView>;

    /// Returns the override constants of the shader.
    fn constants(self) -> Vec<Constant>;
}

/// A pass in the plan of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Planned<K> {
    pub key: K,
    /// True to compute it, false to draw it.
    pub computed: bool,
}

impl<K: TexelKey> Planned<K> {
    pub fn drawn(key: K) -> Self {
        Self { key, computed: false }
    }

    pub fn computed(key: K) -> Self {
        Self { key, computed: true }
    }

    /// Returns the targets that the pass writes.
    pub fn targets(self) -> impl Iterator<Item = PlannedTarget> {
        let Self { key, computed } = self;
        let targets = if computed { K::COMPUTED } else { key.drawn() };
        targets.iter().map(move |&target| PlannedTarget { target, computed })
    }
}

/// Key of the render pipelines of a texel pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Drawn<K>(K);

/// Key of its compute pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Computed<K>(K);

impl<K: TexelKey> PipelineKey for Drawn<K> {
    const PASS: &'static str = K::PASS;
    const GROUPS: GroupSet = GroupSet::Lighting;
    type Description = RenderPipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        K::READS.to_vec()
    }

    fn describe(self) -> RenderPipelineDescription {
        let formats = || self.0.drawn().iter().map(|target| target.drawn);
        let depth = formats().find(wgpu::TextureFormat::is_depth_stencil_format);
        RenderPipelineDescription {
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: depth.map(|format| wgpu::DepthStencilState {
                depth_write_enabled: Some(true),
                ..read_only_depth(format, wgpu::CompareFunction::Always)
            }),
            sample_count: 1,
            targets: formats()
                .filter(|format| Some(*format) != depth)
                .map(|format| color_target(format, None))
                .collect(),
            constants: self.0.constants(),
        }
    }
}

impl<K: TexelKey> PipelineKey for Computed<K> {
    const PASS: &'static str = K::PASS;
    const GROUPS: GroupSet = GroupSet::Lighting;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        let written = |target: &Target| written_texture(target.computed, wgpu::TextureViewDimension::D2);
        K::READS.iter().copied().chain(K::COMPUTED.iter().map(written)).collect()
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription { entry_point: K::ENTRY_POINT, constants: self.0.constants() }
    }
}

/// Pipelines of a texel pass.
#[derive(Debug)]
pub(crate) struct TexelPipelines<K: TexelKey> {
    /// `None` if the pass is only computed.
    drawn: Option<PipelineVariants<Drawn<K>>>,
    /// `None` if the pass or the device has no compute shaders.
    computed: Option<PipelineVariants<Computed<K>>>,
}

/// From what the texel passes of a system are built.
pub(crate) struct TexelInputs<'a> {
    pub groups: &'a Groups,
    pub textures: SystemTextures<'a>,
    pub inputs: &'a mut InputGroups,
    /// Size of the part of the accumulation target in use, texels.
    pub size: UVec2,
}

impl<K: TexelKey> TexelPipelines<K> {
    /// `computes`: true if the device has compute shaders.
    pub fn new<E>(
        store: &PipelineStore,
        layouts: &Layouts,
        computes: bool,
        shader: impl Fn(&'static str) -> Result<Shader, E>,
    ) -> Result<Self, E> {
        let computes = computes && !K::COMPUTED.is_empty();
        Ok(Self {
            drawn: if K::IS_DRAWN { Some(PipelineVariants::new(store, layouts, shader(K::PASS)?)) } else { None },
            computed: if computes { Some(PipelineVariants::new(store, layouts, shader(K::PASS)?)) } else { None },
        })
    }

    /// Shares the pipelines of another context of the device that have the same module.
    pub fn share(&mut self, other: &Self) {
        if let (Some(drawn), Some(other)) = (&mut self.drawn, &other.drawn) {
            drawn.share(other);
        }
        if let (Some(computed), Some(other)) = (&mut self.computed, &other.computed) {
            computed.share(other);
        }
    }

    /// Compiles the pipeline of a planned pass, or returns the shader error.
    pub fn check(&self, planned: Planned<K>) -> Result<(), PrepareError> {
        if planned.computed {
            return self.computed.as_ref().map_or(Ok(()), |computed| computed.check(Computed(planned.key)));
        }
        self.drawn.as_ref().map_or(Ok(()), |drawn| drawn.check(Drawn(planned.key)))
    }

    /// Builds a planned pass. `None` if the system has no target for it.
    pub fn pass(&self, planned: Planned<K>, system: &mut TexelInputs<'_>) -> Option<TexelPass> {
        let TexelInputs { groups, textures, inputs, size } = system;
        let accumulation = textures.accumulation;
        let extent = planned.targets().next()?.target.extent;
        let written = || planned.targets().filter_map(|planned| accumulation.get(&planned.target));
        let reads = || K::reads(*textures).into_iter();
        let (pipeline, inputs) = if planned.computed {
            let computed = self.computed.as_ref()?;
            let bound = inputs.get(K::PASS, || computed.bind_textures(reads().chain(written())));
            (TexelPipeline::Computed(computed.get(Computed(planned.key))), Some(bound))
        } else {
            let drawn = self.drawn.as_ref()?;
            let bound = (!K::READS.is_empty()).then(|| inputs.get(K::PASS, || drawn.bind_textures(reads())));
            let mut targets = written().cloned();
            let targets = std::array::from_fn(|_| targets.next());
            (TexelPipeline::Drawn(drawn.get(Drawn(planned.key)), targets), bound)
        };
        let size = accumulation.size_in_use(extent, *size);
        Some(TexelPass { name: K::PASS, pipeline, size, groups: groups.clone(), inputs })
    }
}

/// A texel pass of one system.
#[derive(Debug)]
pub(crate) struct TexelPass {
    /// Name in times and captures.
    name: &'static str,
    pipeline: TexelPipeline,
    /// Size of the part in use.
    size: UVec2,
    groups: Groups,
    /// Group 3.
    inputs: Option<wgpu::BindGroup>,
}

#[derive(Debug)]
enum TexelPipeline {
    /// With the targets: one depth, or colors.
    Drawn(wgpu::RenderPipeline, [Option<wgpu::TextureView>; 2]),
    /// The targets are among the inputs.
    Computed(wgpu::ComputePipeline),
}

/// Invocations of a workgroup along each axis.
const WORKGROUP_SIDE: u32 = 8;

impl TexelPass {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        match &self.pipeline {
            TexelPipeline::Drawn(pipeline, targets) => self.draw(pipeline, targets, encoder),
            TexelPipeline::Computed(pipeline) => self.dispatch(pipeline, encoder),
        }
    }

    fn draw(
        &self,
        pipeline: &wgpu::RenderPipeline,
        targets: &[Option<wgpu::TextureView>; 2],
        encoder: &mut FrameEncoder<'_>,
    ) {
        let is_depth = |view: &&wgpu::TextureView| view.texture().format().is_depth_stencil_format();
        let depth = targets[0].as_ref().filter(is_depth);
        let colors = targets.each_ref().map(|target| target.as_ref().filter(|view| !is_depth(view)));
        let attachments = colors.map(|view| color_attachment(view?));
        let count = attachments.iter().flatten().count();
        let mut pass = encoder.render(self.name, &attachments[..count], depth.map(written_depth));
        set_viewport_and_scissor(&mut pass, UVec2::ZERO, self.size);
        pass.set_pipeline(pipeline);
        self.groups.bind_for_lighting(&mut pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        pass.draw(0..3, 0..1);
    }

    fn dispatch(&self, pipeline: &wgpu::ComputePipeline, encoder: &mut FrameEncoder<'_>) {
        let pass = encoder.compute(self.name);
        pass.set_pipeline(pipeline);
        self.groups.bind_to_compute_for_lighting(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        let workgroups = self.size.map(|side| side.div_ceil(WORKGROUP_SIDE));
        pass.dispatch_workgroups(workgroups.x, workgroups.y, 1);
    }
}
