//! The frame on the GPU, pass by pass.

mod auto;
mod context;
mod counts;
mod descriptor;
mod draw;
mod frame_bindings;
mod gpu;
mod instances;
mod layouts;
mod material;
mod memory;
mod pass;
mod passes;
mod path_probe;
mod plan;
pub mod shader;
mod slot;
mod system_targets;
mod targets;
mod tiled;
mod validate;
mod warm_up;

use crate::assets::material::MaterialAssets;
use crate::error::{Error, FieldError};
use crate::frame::{Frame, Material};
use crate::in_view::ViewGeometry;
use crate::settings::{Settings, ShadeTree};

pub use auto::{PathChoice, PathCosts, PathLoad, PathModel, PathModelSource, PathReason};
pub use context::Context;
pub use counts::{FrameCounts, Overdraw};
pub use descriptor::Descriptor;
pub use gpu::capabilities::read_only_depth_is_supported;
pub use gpu::frame_times::{FrameTimes, PassTime};
pub use gpu::timing::Timing;
pub use memory::{MemoryUse, TiledMemory};
pub use plan::SceneDepthKind;
pub use targets::TargetViews;
pub use warm_up::WarmUp;

use draw::Draw;
use frame_bindings::FrameBindings;
use gpu::Gpu;
use gpu::host_pass::HostPass;
use gpu::record::set_part;
use gpu::submission::Submission;
use plan::{Situation, plan};
use slot::{FrameContext, Slot};
use validate::{host_size, validate};

/// Draws particle systems into a host's frame.
///
/// One renderer serves one view: [`prepare`](Self::prepare) writes buffers and targets that the [`render`](Self::render) of the
/// same submission reads, so prepare once, render as often as the pass needs, submit, and begin again. Further views have
/// renderers of their own on the same [`Context`].
#[derive(Debug)]
pub struct Renderer {
    context: Context,
    host: HostPass,
    exact_filtering: bool,
    submission: Submission,
    timing: Option<Timing>,
    /// The frame of `timing` that was prepared last.
    timed_frame: Option<u64>,
    bindings: FrameBindings,
    slots: Vec<Slot>,
    /// The slots in sight, farthest first.
    order: Vec<Seen>,
    /// Of the last frame.
    view: Option<ViewGeometry>,
}

/// A slot that is in sight.
#[derive(Clone, Copy, Debug)]
struct Seen {
    slot: usize,
    /// View depth.
    distance: f32,
}

impl Renderer {
    /// Makes a renderer for a view. Without a context in the descriptor it makes one of its own and compiles the shaders;
    /// with one it is cheap. Pipelines are compiled by the first [`prepare`](Self::prepare) that needs them, or by
    /// [`warm_up`](Self::warm_up).
    ///
    /// # Errors
    /// [`Error::Field`] naming what the device does not take: a format, a number of samples, or a context of another device.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, descriptor: &Descriptor<'_>) -> Result<Self, Error> {
        let host = descriptor.host_pass(device)?;
        let context = descriptor.context.cloned().unwrap_or_else(|| Context::new(device, queue, None));
        context.validate_device(device)?;
        Ok(Self {
            host,
            exact_filtering: descriptor.exact_filtering,
            submission: Submission::new(device),
            timing: None,
            timed_frame: None,
            bindings: FrameBindings::new(device),
            slots: Vec::new(),
            order: Vec::new(),
            view: None,
            context,
        })
    }

    /// What this renderer shares, for renderers of further views.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// As [`Context::create_material`].
    ///
    /// # Errors
    /// As there.
    pub fn create_material(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        assets: &MaterialAssets,
    ) -> Result<Material, Error> {
        self.context.create_material(device, queue, assets)
    }

    /// Compiles every pipeline that frames like these need; the first such frame compiles nothing then. To do it off the
    /// frame's thread, make a second renderer there on the same [`Context`] and with the same [`Descriptor`].
    ///
    /// # Errors
    /// [`Error::Field`] naming the view or setting that cannot be used, [`Error::Shader`] naming the file of a pass of which the
    /// device takes no such pipeline: one of [`Context::with_shaders`], or a mistake of the driver's.
    pub fn warm_up(&self, expected: &WarmUp<'_>) -> Result<(), Error> {
        let view = ViewGeometry::new(&expected.view)?;
        let situation = self.situation(&view, expected.scene_depth, expected.stages);
        let shared = self.context.shared();
        for (index, settings) in expected.settings.iter().enumerate() {
            settings.validate(|| format!("settings[{index}]"))?;
            // Whether its sprite has one frame is not known yet.
            let sprite = settings.sprite.for_frames(1.0);
            for settings in [*settings, Settings { sprite, ..*settings }] {
                for &path in settings.path.candidates() {
                    for back_faces in [false, true] {
                        let settings = Settings { path, ..settings };
                        shared.passes.compile(&shared.device, &plan(&situation, &settings, back_faces))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Records everything that happens before the host's pass: every system accumulated into a small target of its own.
    ///
    /// Allocates and compiles only when a system, the picture's size or a setting that changes a pipeline is new; a
    /// steady frame creates nothing. What is no longer needed is given back after two seconds' worth of frames.
    ///
    /// # Errors
    /// [`Error::Field`] naming the view, light, setting or system that cannot be used, or `prepare` itself, when the commands of
    /// the one before were neither submitted nor dropped yet. Nothing is drawn by [`render`](Self::render) until the next
    /// `prepare` that succeeds.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), Error> {
        self.order.clear();
        self.context.validate_device(device)?;
        self.validate_submitted()?;
        let gpu = Gpu { device, queue };
        let context = self.context.clone();
        let shared = context.shared();
        let view = ViewGeometry::new(&frame.view)?;
        validate(shared, &self.host, frame)?;
        let situation = self.situation(&view, frame.scene_depth.kind(), frame.stages);
        // The view and the scene's depth, for every system.
        self.bindings.write(&gpu, &shared.layouts, &view, &frame.scene_depth)?;
        self.keep_slots(frame);
        self.submission.follow(encoder);
        let timing = self.timing.as_ref();
        self.timed_frame = timing.map(|timing| timing.enter(self.timed_frame));

        let host_size = host_size(&frame.scene_depth);
        let bindings = &self.bindings;
        let context = FrameContext { gpu, shared, frame, view: &view, host_size, situation: &situation, bindings };
        for system in frame.systems {
            let Some(index) = self.slots.iter().position(|slot| slot.key == system.key) else { continue };
            let slot = &mut self.slots[index];
            // Place in the view; lights, settings and particles to the GPU, sprites back to front.
            slot.write(&context, system);
            if let (Some(timing), Some(choice)) = (timing, slot.choice()) {
                timing.add_choice(system.key, choice);
            }
            let Some(draw) = slot.draw() else { continue };
            self.order.push(Seen { slot: index, distance: slot.distance() });
            // An emitter's particles, evaluated; or a host's, back to front.
            slot.particles_pass().iter().for_each(|pass| pass.record(encoder, timing));
            let Draw::Deferred(draw) = draw else { continue };
            // Scene depth at the target's resolution, and once more where what is read cannot be tested.
            draw.depth_downsample.iter().chain(&draw.depth_copy).for_each(|pass| pass.record(encoder, timing));
            // All lights by normal, for the cubemap and motif variants of diffuse.
            draw.diffuse_bake.iter().for_each(|pass| pass.record(encoder, timing));
            // Sprites to premultiplied normal + amount.
            draw.accumulate.record(encoder, timing);
            // Or counted, where that is to be shown.
            draw.overdraw.iter().for_each(|pass| pass.record(encoder, timing));
            // Lit, where light is wanted no finer than the target.
            draw.light_target.iter().for_each(|pass| pass.record(encoder, timing));
        }
        // Far to near; at one distance as the host has them.
        self.order.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        self.view = Some(view);
        Ok(())
    }

    /// Records the smoke into the host's pass, systems far to near. Sets its own pipelines, bind groups 0 to 3, vertex
    /// buffer 0, and viewport and scissor to the view; leaves stencil reference and blend constant as they are.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_stage(pass, ShadeTree::Final);
    }

    /// As [`render`](Self::render), for a stage of the shading: one of the frame's [`stages`](Frame::stages), or nothing is drawn.
    /// Any number of them may be drawn of one `prepare`.
    pub fn render_stage(&self, pass: &mut wgpu::RenderPass<'_>, stage: ShadeTree) {
        let Some(view) = self.view.as_ref().filter(|_| !self.order.is_empty()) else { return };
        self.submission.follow_pass(pass);
        let timing = self.timing.as_ref();
        set_part(pass, view.origin, view.size);
        for seen in &self.order {
            match self.slots[seen.slot].draw() {
                // Every sprite lit per fragment, for systems that ask for the classic way.
                Some(Draw::Forward(forward)) if stage.is_picture() => {
                    Timing::inside(timing, "forward", pass, |pass| forward.record(pass));
                }
                Some(Draw::Deferred(draw)) => {
                    // The box, lit once per pixel, or with the light of the texels.
                    Timing::inside(timing, "transfer", pass, |pass| draw.transfer.record(pass, stage));
                    // The glow of lights behind it.
                    for glow in draw.specular_scatter.iter().filter(|_| stage.glows()) {
                        Timing::inside(timing, "specular_scatter", pass, |pass| glow.record(pass));
                    }
                }
                _ => {}
            }
        }
    }

    /// The targets of the system with this key as the last [`prepare`](Self::prepare) left them, for tools and for a host's own
    /// passes. `None` when it is out of sight or drawn forward.
    pub fn targets(&self, key: u64) -> Option<TargetViews<'_>> {
        self.slots.iter().find(|slot| slot.key == key)?.target_views()
    }

    /// Bytes of GPU memory held.
    pub fn memory_use(&self) -> MemoryUse {
        let own = MemoryUse { buffers: self.bindings.bytes(), ..MemoryUse::default() };
        self.slots.iter().map(Slot::memory_use).chain([own]).sum()
    }

    /// What the last [`prepare`](Self::prepare) gives [`render`](Self::render) to draw.
    pub fn counts(&self) -> FrameCounts {
        self.order.iter().map(|seen| self.slots[seen.slot].counts()).sum()
    }

    /// What the path `auto` took in the last [`prepare`](Self::prepare) for the system with this key, and why. `None` when it is out of
    /// sight, or has another path.
    pub fn path_choice(&self, key: u64) -> Option<PathChoice> {
        self.slots.iter().find(|slot| slot.key == key)?.choice()
    }

    /// In how many layers the sprites of the last [`prepare`](Self::prepare) lie. Every sprite is looked at when this is
    /// called: half a millisecond of CPU time for ten thousand.
    pub fn overdraw(&self) -> Overdraw {
        let Some(view) = self.view.map(|view| view.uniform(false)) else { return Overdraw::default() };
        self.order.iter().map(|seen| self.slots[seen.slot].overdraw(&view)).sum()
    }

    /// Measures the GPU time of this renderer's passes from the next [`prepare`](Self::prepare) on; `None`, as at first, measures
    /// nothing and costs nothing.
    ///
    /// # Errors
    /// [`Error::Field`] when it was made with another device.
    pub fn set_timing(&mut self, timing: Option<&Timing>) -> Result<(), Error> {
        if timing.is_some_and(|timing| !timing.is_of(&self.context.shared().device)) {
            let expected = "one made with the device of the renderer's context";
            return Err(FieldError::new("timing", "of another device", expected).into());
        }
        self.timing = timing.cloned();
        self.timed_frame = None;
        Ok(())
    }

    fn situation<'a>(
        &self,
        view: &ViewGeometry,
        scene_depth: SceneDepthKind,
        stages: &'a [ShadeTree],
    ) -> Situation<'a> {
        Situation {
            host: self.host,
            exact_filtering: self.exact_filtering,
            read_only_depth: self.context.shared().read_only_depth,
            tiles: self.context.shared().tiles(),
            scene_depth,
            reversed: view.depth.reversed,
            mirrored: view.mirrored,
            size: view.size,
            stages,
        }
    }

    /// What was recorded for the last frame still reads what this one would overwrite.
    fn validate_submitted(&self) -> Result<(), FieldError> {
        if !self.submission.is_outstanding() {
            return Ok(());
        }
        let value = "a second call while commands of the first are neither submitted nor dropped";
        let expected = "a renderer of its own for every view of a submission; on one Context they are cheap";
        Err(FieldError::new("prepare", value, expected))
    }

    /// A slot for every system of the frame, found by its key; those long without a system go.
    fn keep_slots(&mut self, frame: &Frame<'_>) {
        let is_missing = |slot: &Slot| !frame.systems.iter().any(|system| system.key == slot.key);
        self.slots.retain_mut(|slot| {
            let is_missing = is_missing(slot);
            !slot.is_abandoned(is_missing)
        });
        for system in frame.systems {
            if !self.slots.iter().any(|slot| slot.key == system.key) {
                self.slots.push(Slot::new(system.key, self.context.shared()));
            }
        }
    }
}
