//! GPU renderer: records a frame, pass by pass.

mod auto;
mod context;
mod counts;
mod descriptor;
mod frame_bindings;
mod frame_context;
mod frame_statistics;
mod gpu;
mod layouts;
mod material_upload;
mod memory_use;
mod pass;
mod path_probe;
mod pipeline_variants;
mod pipelines;
mod plan;
mod prepare_systems;
mod resolved_depth;
mod scene_shadow;
mod screen_shadow;
pub mod shader;
mod shadow_map_bindings;
mod sliced_shadow;
mod support;
mod system;
mod targets;
mod tiled;
mod validate_frame;
mod warm_up;

use haze_core::assets::ramp_steps::RampSteps;
use haze_core::error::{FieldError, PrepareError};
use haze_core::formula::shadow::SHADOWED_LIGHTS;
use haze_core::settings::DebugView;
use haze_core::view_setup::{AttachmentSet, DrawOrder, ResolvedSettings, ViewGeometry};

use crate::frame::FrameInput;

pub use auto::{PathChoice, PathCosts, PathModel, PathModelSource, PathReason, PathWorkload};
pub use context::Context;
pub use counts::{FrameCounts, Overdraw};
pub use descriptor::RendererDescriptor;
pub use gpu::capabilities::read_only_depth_is_supported;
pub use gpu::frame_times::{FrameTimes, PassTime};
pub use gpu::timing::{Timing, TimingDetail};
pub use memory_use::{MemoryUse, TiledMemory};
pub use plan::SceneDepthKind;
pub use targets::TargetViews;
pub use warm_up::WarmUp;

use frame_bindings::FrameBindings;
use gpu::frame_encoder::FrameEncoder;
use gpu::host_pass::HostPass;
use gpu::record::set_viewport_and_scissor;
use gpu::submission::SubmissionTracker;
use pass::depth_resolve::DepthResolveKey;
use plan::{PipelineInputs, plan};
use resolved_depth::ResolvedDepth;
use scene_shadow::SceneShadow;
use screen_shadow::ScreenShadowState;
use sliced_shadow::SlicedShadow;
use system::{SystemPasses, SystemState};
use tiled::ShadowVolume;

/// Draws particle systems into a host's frame.
///
/// One renderer serves one view. [`prepare`](Self::prepare) writes buffers and targets that [`render`](Self::render)
/// reads within the same submission: call `prepare` once, call `render` any number of times, and submit before the next
/// `prepare`. Each further view needs a renderer of its own; create it on the same [`Context`].
#[derive(Debug)]
pub struct Renderer {
    context: Context,
    host: HostPass,
    /// Pass that darkens the scene.
    scene_pass: HostPass,
    exact_filtering: bool,
    submission: SubmissionTracker,
    timing: Option<Timing>,
    /// Frame number of `timing` at the last `prepare`.
    timed_frame: Option<u64>,
    /// Present while the host's depth is multisampled.
    resolved_depth: Option<ResolvedDepth>,
    bindings: FrameBindings,
    shadow_volume: ShadowVolume,
    sliced_shadow: SlicedShadow,
    scene_shadow: SceneShadow,
    screen_shadow: ScreenShadowState,
    /// Lights of the frame that cast shadow.
    shadowed_lights: [Option<usize>; SHADOWED_LIGHTS],
    /// True between `prepare_shadow` and the `prepare` that completes the frame.
    has_cast: bool,
    states: Vec<SystemState>,
    /// Visible systems, in the order in which they are drawn.
    order: Vec<VisibleSystem>,
    /// View of the last successful `prepare`.
    view: Option<ViewGeometry>,
}

/// A visible system.
#[derive(Clone, Copy, Debug)]
struct VisibleSystem {
    state: usize,
    draw_order: DrawOrder,
}

impl Renderer {
    /// Creates a renderer for a view. Pipelines are compiled by the first [`prepare`](Self::prepare) that needs them, or
    /// by [`warm_up`](Self::warm_up).
    ///
    /// # Errors
    /// [`PrepareError::Field`] names the property that the device does not support: a format, or the sample count.
    pub fn new(context: &Context, descriptor: &RendererDescriptor<'_>) -> Result<Self, PrepareError> {
        let device = &context.shared().device;
        let host = descriptor.host_pass(device)?;
        Ok(Self {
            host,
            scene_pass: descriptor.scene_pass(host, device)?,
            exact_filtering: descriptor.exact_filtering,
            submission: SubmissionTracker::new(device),
            timing: None,
            timed_frame: None,
            resolved_depth: None,
            bindings: FrameBindings::new(device),
            shadow_volume: ShadowVolume::default(),
            sliced_shadow: SlicedShadow::default(),
            scene_shadow: SceneShadow::new(context.shared()),
            screen_shadow: ScreenShadowState::default(),
            shadowed_lights: [None; SHADOWED_LIGHTS],
            has_cast: false,
            states: Vec::new(),
            order: Vec::new(),
            view: None,
            context: context.clone(),
        })
    }

    /// Returns the context, for renderers of further views.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Compiles every pipeline that the described frames need, so that the first such frame compiles none. To compile
    /// outside the render thread, create a second renderer on another thread, with the same [`Context`] and the same
    /// [`RendererDescriptor`].
    ///
    /// # Errors
    /// [`PrepareError::Field`] names the view or setting that is not valid. [`PrepareError::Shader`] names the file of a pass whose
    /// pipeline the device rejects, because of a shader of [`Context::with_shaders`] or a driver error.
    pub fn warm_up(&self, expected: &WarmUp<'_>) -> Result<(), PrepareError> {
        let view = ViewGeometry::new(&expected.view)?;
        let inputs = self.pipeline_inputs(&view, expected.scene_depth, expected.debug_views);
        let shared = self.context.shared();
        if expected.scene_depth == SceneDepthKind::Multisampled {
            shared.pipelines.drawn.depth_resolve.check(DepthResolveKey { reversed: view.depth.reversed })?;
        }
        for (index, settings) in expected.settings.iter().enumerate() {
            let path = || format!("settings[{index}]");
            settings.validate(path)?;
            AttachmentSet::validate(settings, path)?;
            if settings.receives_shadow() {
                shared.pipelines.drawn.screen_shadow.check(self.scene_pass)?;
            }
            // The material is not known yet: compiles for one frame and for several, for smooth ramps and hard ones.
            for (frame_count, ramps) in
                [(1.0, RampSteps::default()), (2.0, RampSteps::default()), (2.0, RampSteps::HARD)]
            {
                let resolved = ResolvedSettings::new(settings, 1.0, view.size, frame_count, &ramps, shared.support);
                let paths = settings.path.candidates();
                let scales = resolved.candidate_scales();
                for (scale, path) in scales.flat_map(|scale| paths.iter().map(move |path| (scale, *path))) {
                    let settings = resolved.with_scale(scale).with_path(path);
                    for back_faces in [false, true] {
                        shared.pipelines.compile(&plan(&inputs, &settings, back_faces))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Records all work that precedes the host's pass: accumulates every system into a target of its own.
    ///
    /// Allocates and compiles only when a system, the view's size or a setting that selects a pipeline is new; a steady
    /// frame creates nothing. Memory that has not been needed for 120 frames is released.
    ///
    /// # Errors
    /// [`PrepareError::Field`] names the view, light, setting or system that is not valid. It names `prepare` if the commands
    /// of the previous call were neither submitted nor dropped. After an error, [`render`](Self::render) draws nothing
    /// until a `prepare` succeeds.
    pub fn prepare(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &FrameInput<'_>) -> Result<(), PrepareError> {
        let encoder = &mut FrameEncoder::new(encoder, self.timing.clone());
        if std::mem::take(&mut self.has_cast) && self.submission.is_outstanding() {
            self.submission.track(encoder.commands());
        } else {
            self.prepare_systems(encoder, frame)?;
        }
        let context = self.context.clone();
        let shared = context.shared();
        // Keeps the farthest sample of a multisampled scene depth.
        if let (Some(resolved), Some(view)) = (&self.resolved_depth, &self.view) {
            resolved.pass(shared, view).record(encoder);
        }
        for visible in &self.order {
            let Some(SystemPasses::Deferred(passes)) = self.states[visible.state].passes() else { continue };
            let texels = &passes.texels;
            // Downsamples the scene depth.
            if let Some(pass) = &texels.depth_downsample {
                pass.record(encoder);
            }
            // Writes a second copy if the backend cannot test what it samples.
            if let Some(pass) = &texels.depth_copy {
                pass.record(encoder);
            }
            // Bakes all lights by normal, for the diffuse modes cubemap and motif.
            if let Some(pass) = &passes.diffuse_bake {
                pass.record(encoder);
            }
            // Accumulates sprites as premultiplied normal + amount.
            passes.accumulate.record(encoder);
            // Counts layers, for the overdraw view.
            if let Some(pass) = &passes.overdraw {
                pass.record(encoder);
            }
            // Lights the target, if the lighting resolution is the target's.
            if let Some(pass) = &texels.light_target {
                pass.record(encoder);
            }
            // Fits how the lit smoke changes with depth, for its upsampling.
            if let Some(pass) = &texels.depth_slopes {
                pass.record(encoder);
            }
            // Marks where there is smoke, and where it has slopes.
            if let Some(pass) = &texels.mark_cells {
                pass.record(encoder);
            }
            // Computes the pixels that transfer draws, where drawing is slow.
            if let Some(pass) = &texels.upsample_lit {
                pass.record(encoder);
            }
        }
        // Reads back the lengths of the lists of tiles.
        for tiled in self.order.iter().filter_map(|visible| self.states[visible.state].tiled_passes()) {
            tiled.read_entries(encoder.commands());
        }
        // Systems of equal priority and distance keep the host's order.
        self.order.sort_by(|a, b| a.draw_order.compare(&b.draw_order));
        Ok(())
    }

    /// Records the shadow of the smoke ahead of [`prepare`](Self::prepare), so that a host's opaque pass can read it from
    /// [`scene_shadow_bind_group`](Self::scene_shadow_bind_group). Call `prepare` with the same frame afterwards, before the commands are
    /// submitted. The scene depth is not read yet. Without smoke that casts shadow, it records nothing of the shadow.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    pub fn prepare_shadow(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameInput<'_>,
    ) -> Result<(), PrepareError> {
        self.prepare_systems(&mut FrameEncoder::new(encoder, self.timing.clone()), frame)?;
        self.has_cast = true;
        Ok(())
    }

    /// Returns the bind group that [`shader::scene_shadow_wgsl`] reads, for the frame of the last
    /// [`prepare_shadow`](Self::prepare_shadow) or [`prepare`](Self::prepare). Its layout is
    /// [`Context::scene_shadow_layout`]. It may be another one in the next frame. Without shadow, light is full.
    pub fn scene_shadow_bind_group(&self) -> &wgpu::BindGroup {
        self.scene_shadow.group()
    }

    /// Returns the indices in [`FrameInput::lights`] of the lights that cast shadow, in the frame of the last
    /// [`prepare_shadow`](Self::prepare_shadow) or [`prepare`](Self::prepare). The three brightest come first.
    pub fn shadowed_lights(&self) -> impl Iterator<Item = usize> {
        self.shadowed_lights.into_iter().flatten()
    }

    /// Records the smoke into the host's pass, systems far to near. Sets its own pipelines, bind groups 0 to 3 and
    /// vertex buffer 0, and sets viewport and scissor rectangle to the view. Leaves stencil reference and blend
    /// constant unchanged.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_debug_view(pass, DebugView::Final);
    }

    /// Darkens the host's image by the shadow of the smoke, for hosts whose shaders do not call
    /// [`shader::scene_shadow_wgsl`]: record it in the pass of [`render`](Self::render), or in that of
    /// [`RendererDescriptor::scene_color_format`], after the opaque scene and before the smoke. Needs
    /// [`FrameInput::scene_ambient`]. State of the pass as in `render`.
    ///
    /// Each pixel is multiplied by the fraction of its light that is left, for a white matte surface whose normal comes from
    /// the scene depth, under the lights of the frame, in the shadow of [`FrameInput::shadow_maps`] of the three brightest.
    /// Reflections and glowing surfaces darken as well: a host's own shader does better.
    pub fn render_scene_shadow(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(view) = self.view.as_ref().filter(|_| !self.has_cast) else { return };
        let Some(frame) = self.bindings.any() else { return };
        let shared = self.context.shared();
        let Some(shadow) = self.screen_shadow.pass(shared, self.scene_pass, &frame.frame, self.scene_shadow.group())
        else {
            return;
        };
        self.submission.track_pass(pass);
        set_viewport_and_scissor(pass, view.origin, view.size);
        Timing::measure_in_pass(self.timing.as_ref(), "screen_shadow", pass, |pass| shadow.record(pass));
    }

    /// Records a debug view instead of the final image. Draws nothing unless `debug_view` is one of the frame's
    /// [`debug_views`](FrameInput::debug_views). After one `prepare`, any number of debug views can be drawn.
    pub fn render_debug_view(&self, pass: &mut wgpu::RenderPass<'_>, debug_view: DebugView) {
        self.record_systems(pass, self.order.iter(), debug_view);
    }

    /// Records the smoke of one system, for hosts that draw smoke between their own transparent objects: draw far to
    /// near, with [`depth_of`](Self::depth_of) as the smoke's depth. State of the pass as in [`render`](Self::render).
    /// Draws nothing if the system with this key is out of sight.
    pub fn render_system(&self, pass: &mut wgpu::RenderPass<'_>, key: u64) {
        let visible = self.order.iter().filter(|visible| self.states[visible.state].key == key);
        self.record_systems(pass, visible, DebugView::Final);
    }

    fn record_systems<'a>(
        &'a self,
        pass: &mut wgpu::RenderPass<'_>,
        systems: impl Iterator<Item = &'a VisibleSystem>,
        debug_view: DebugView,
    ) {
        let is_prepared = !self.order.is_empty() && !self.has_cast;
        let Some(view) = self.view.as_ref().filter(|_| is_prepared) else { return };
        self.submission.track_pass(pass);
        let timing = self.timing.as_ref();
        set_viewport_and_scissor(pass, view.origin, view.size);
        for visible in systems {
            match self.states[visible.state].passes() {
                // Path `forward`: lights every sprite fragment.
                Some(SystemPasses::Forward(forward)) if debug_view.shows_lit_smoke() => {
                    Timing::measure_in_pass(timing, "forward", pass, |pass| forward.record(pass));
                }
                Some(SystemPasses::Deferred(passes)) => {
                    // Draws the bounding box: lights each pixel once, or upsamples the lit target.
                    Timing::measure_in_pass(timing, "transfer", pass, |pass| passes.transfer.record(pass, debug_view));
                    // Adds the glow of lights behind the smoke, unless transfer did.
                    for glow in passes.specular_scatter.iter().filter(|glow| glow.is_drawn(debug_view)) {
                        Timing::measure_in_pass(timing, "specular_scatter", pass, |pass| glow.record(pass));
                    }
                }
                _ => {}
            }
        }
    }

    /// Measures the GPU time of this renderer's passes from the next [`prepare`](Self::prepare) on. `None`, the initial
    /// state, measures nothing and costs nothing.
    ///
    /// # Errors
    /// [`PrepareError::Field`] if the `Timing` was created on another device.
    pub fn set_timing(&mut self, timing: Option<&Timing>) -> Result<(), PrepareError> {
        if timing.is_some_and(|timing| timing.device_number() != self.context.shared().device_number) {
            let expected = "a Timing of the renderer's context, or of one with other shaders";
            return Err(FieldError::from_problem("timing", "was created on another device", expected).into());
        }
        self.timing = timing.cloned();
        self.timed_frame = None;
        Ok(())
    }

    fn pipeline_inputs<'a>(
        &self,
        view: &ViewGeometry,
        scene_depth: SceneDepthKind,
        debug_views: &'a [DebugView],
    ) -> PipelineInputs<'a> {
        PipelineInputs {
            host: self.host,
            exact_filtering: self.exact_filtering,
            read_only_depth: self.context.shared().read_only_depth,
            tiles: self.context.shared().tiles(),
            computes_pixels: self.context.shared().path_model().computes_pixels(),
            scene_depth,
            reversed: view.depth.reversed,
            mirrored: view.mirrored,
            debug_views,
        }
    }
}
