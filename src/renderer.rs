//! The frame, pass by pass.

use glam::{IVec2, UVec2};

use crate::descriptor::Descriptor;
use crate::error::{Error, FieldError};
use crate::frame::{Frame, System, validate_lights, validate_settings};
use crate::frame_bindings::FrameBindings;
use crate::material::{Material, MaterialAssets, Samplers};
use crate::pass::Layouts;
use crate::pass::accumulate::{self, AccumulatePass};
use crate::pass::depth_downsample::{self, DepthDownsamplePass};
use crate::pass::diffuse_bake::{self, DiffuseBakePass};
use crate::pass::forward::{self, ForwardPass};
use crate::pass::specular_scatter::{self, SpecularScatterPass};
use crate::pass::transfer::{self, TransferPass};
use crate::slot::{Slot, reads_linear};
use crate::view::ViewGeometry;

/// Draws particle systems into a host's frame.
///
/// One renderer serves one view: [`prepare`](Self::prepare) writes buffers that the [`render`](Self::render) of the same
/// submission reads, so prepare once, render as often as the pass needs, submit, and begin again.
#[derive(Debug)]
pub struct Renderer {
    descriptor: Descriptor,
    layouts: Layouts,
    passes: Passes,
    samplers: Samplers,
    frame: FrameBindings,
    slots: Vec<Slot>,
    /// The slots in sight, farthest first.
    order: Vec<usize>,
}

/// Independent of any size: shaders and their pipelines.
#[derive(Debug)]
pub(crate) struct Passes {
    pub depth_downsample: DepthDownsamplePass,
    pub diffuse_bake: DiffuseBakePass,
    pub accumulate: AccumulatePass,
    pub transfer: TransferPass,
    pub specular_scatter: SpecularScatterPass,
    pub forward: ForwardPass,
}

/// The textures of one system. All share one grid: texel (i, j) covers `scale` by `scale` pixels of the picture from
/// (`origin` + (i, j)) · `scale`. The textures may be larger than the part in use, `size` from (0, 0).
#[derive(Clone, Copy, Debug)]
pub struct TargetViews<'a> {
    /// First: premultiplied normal in rgb, amount in a.
    pub accumulation: &'a [wgpu::TextureView],
    /// `Depth32Float` linear view depth divided by `depth_limit`; `None` where sprites are compared with the host's own
    /// depth.
    pub reduced_depth: Option<&'a wgpu::TextureView>,
    /// First texel of the picture's grid.
    pub origin: IVec2,
    /// Texels in use.
    pub size: UVec2,
    /// Pixels per texel.
    pub scale: u32,
    /// View depth stored as 1, metres: what lies beyond looks alike to the system.
    pub depth_limit: f32,
}

/// Bytes of GPU memory that a renderer holds, its materials aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryUse {
    /// Accumulation targets, reduced depths and baked light of all systems.
    pub targets: u64,
    /// Particles and uniforms.
    pub buffers: u64,
}

impl Renderer {
    /// Compiles the shaders. Pipelines are compiled by the first [`prepare`](Self::prepare) that needs them.
    pub fn new(device: &wgpu::Device, descriptor: &Descriptor) -> Self {
        let layouts = Layouts::new(device);
        let passes = Passes {
            depth_downsample: DepthDownsamplePass::new(device, &layouts),
            diffuse_bake: DiffuseBakePass::new(device, &layouts, descriptor.exact_filtering),
            accumulate: AccumulatePass::new(device, &layouts, descriptor.exact_filtering),
            transfer: TransferPass::new(device, &layouts, descriptor),
            specular_scatter: SpecularScatterPass::new(device, &layouts, descriptor),
            forward: ForwardPass::new(device, &layouts, descriptor),
        };
        Self {
            descriptor: *descriptor,
            frame: FrameBindings::new(device),
            layouts,
            passes,
            samplers: Samplers::new(device),
            slots: Vec::new(),
            order: Vec::new(),
        }
    }

    /// Uploads ramps and a sprite picture. Make each once and keep it.
    ///
    /// # Errors
    /// [`Error::Field`] naming a picture that is too large for the device.
    pub fn create_material(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        assets: &MaterialAssets,
    ) -> Result<Material, Error> {
        Ok(Material::new(device, queue, &self.layouts, &self.samplers, assets)?)
    }

    /// Records everything that happens before the host's pass: every system accumulated into a small target of its own.
    ///
    /// Allocates and compiles only when a system, the picture's size or a setting that changes a pipeline is new; a
    /// steady frame creates nothing.
    ///
    /// # Errors
    /// [`Error::Field`] naming the view, light, setting or system that cannot be used. Nothing is drawn by
    /// [`render`](Self::render) until the next `prepare` that succeeds.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), Error> {
        self.order.clear();
        let view = ViewGeometry::new(&frame.view)?;
        validate(device, &self.layouts, &self.descriptor, &view, frame)?;
        self.frame.write(device, queue, &self.layouts, &view, &frame.scene_depth);
        self.slots.truncate(frame.systems.len());
        while self.slots.len() < frame.systems.len() {
            self.slots.push(Slot::new(device, &self.layouts));
        }

        for (index, system) in frame.systems.iter().enumerate() {
            let slot = &mut self.slots[index];
            // Place in the view; lights, settings and particles to the GPU, sprites back to front.
            slot.write(device, queue, &self.layouts, &mut self.passes, &self.descriptor, &view, frame, system);
            // Scene depth at the target's resolution.
            depth_downsample::record(encoder, &self.frame, slot);
            // All lights by normal, for the cubemap and motif variants of diffuse.
            diffuse_bake::record(encoder, &self.frame, slot);
            // Sprites to premultiplied normal + amount.
            accumulate::record(encoder, &self.frame, slot);
        }

        self.order.extend((0..self.slots.len()).filter(|&index| self.slots[index].is_in_sight()));
        let slots = &self.slots;
        self.order.sort_unstable_by(|&a, &b| slots[b].distance().total_cmp(&slots[a].distance()).then(a.cmp(&b)));
        Ok(())
    }

    /// Records the smoke into the host's pass, systems far to near. Sets its own pipelines, bind groups 0 to 3 and
    /// vertex buffer 0; leaves viewport and scissor as the host set them, which must be the whole picture.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        for &index in &self.order {
            let slot = &self.slots[index];
            // Every sprite lit per fragment, for systems that ask for the classic way.
            forward::record(pass, &self.frame, slot);
            // The box, lit once per pixel.
            transfer::record(pass, &self.frame, slot);
            // The glow of lights behind it.
            specular_scatter::record(pass, &self.frame, slot);
        }
    }

    /// The targets of a system as the last [`prepare`](Self::prepare) left them, for tools and for a host's own passes.
    /// `None` when it is out of sight or drawn forward.
    pub fn targets(&self, system: usize) -> Option<TargetViews<'_>> {
        self.slots.get(system)?.target_views()
    }

    /// Bytes of GPU memory held for the systems of the last frame.
    pub fn memory_use(&self) -> MemoryUse {
        self.slots.iter().fold(MemoryUse::default(), |sum, slot| {
            let of_slot = slot.memory_use();
            MemoryUse { targets: sum.targets + of_slot.targets, buffers: sum.buffers + of_slot.buffers }
        })
    }
}

fn validate(
    device: &wgpu::Device,
    layouts: &Layouts,
    descriptor: &Descriptor,
    view: &ViewGeometry,
    frame: &Frame<'_>,
) -> Result<(), FieldError> {
    if !frame.time.is_finite() {
        return Err(FieldError::new("time", frame.time, "a finite number of seconds"));
    }
    if let Some(buffer) = frame.scene_depth.buffer() {
        let is_depth = buffer.texture().format().has_depth_aspect();
        validate_scene_depth(view, buffer, is_depth, "a depth format for the depth buffer")?;
    }
    if let Some(linear) = frame.scene_depth.linear() {
        let is_linear = linear.texture().format() == wgpu::TextureFormat::R32Float;
        validate_scene_depth(view, linear, is_linear, "R32Float for the linear target")?;
    }
    let reads_attached = descriptor.depth_format.is_some() && frame.scene_depth.linear().is_none();
    if reads_attached && !layouts.read_only_depth {
        let expected = "SceneDepth::Linear or Both, or None as the descriptor's depth_format: this backend (OpenGL) \
                        cannot read the depth buffer that the pass tests";
        return Err(FieldError::new("scene_depth", "Buffer", expected));
    }
    validate_lights(frame.lights)?;
    for (index, system) in frame.systems.iter().enumerate() {
        validate_system(device, layouts, index, frame, system)?;
    }
    Ok(())
}

fn validate_scene_depth(
    view: &ViewGeometry,
    depth: &wgpu::TextureView,
    format_fits: bool,
    expected: &str,
) -> Result<(), FieldError> {
    let texture = depth.texture();
    let size = (view.view.size.x, view.view.size.y);
    let refuse = |value: String, expected: &str| Err(FieldError::new("scene_depth", value, expected));
    if (texture.width(), texture.height()) != size {
        let value = format!("{}x{}", texture.width(), texture.height());
        return refuse(value, &format!("the size of the view, {}x{}", size.0, size.1));
    }
    if texture.sample_count() != 1 {
        return refuse(format!("{} samples", texture.sample_count()), "1 sample; resolve the depth buffer first");
    }
    if !format_fits {
        return refuse(format!("{:?}", texture.format()), expected);
    }
    if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        return refuse(format!("usage {:?}", texture.usage()), "TEXTURE_BINDING in it");
    }
    Ok(())
}

fn validate_system(
    device: &wgpu::Device,
    layouts: &Layouts,
    index: usize,
    frame: &Frame<'_>,
    system: &System<'_>,
) -> Result<(), FieldError> {
    use crate::frame::Particles;
    use crate::settings::{DepthSource, Technique};

    validate_settings(index, system.settings, frame.view.size)?;
    if let Some(bounds) = &system.bounds {
        bounds.validate(|| format!("systems[{index}].bounds"))?;
    }
    let field = |name: &str| format!("systems[{index}].{name}");
    if let Particles::Slice(particles) = system.particles {
        let most = device.limits().max_buffer_size / size_of::<crate::Particle>() as u64;
        if particles.len() as u64 > most {
            let expected = format!("at most {most} on this device");
            return Err(FieldError::new(field("particles"), format!("{} particles", particles.len()), expected));
        }
    }
    if let Particles::Buffer { buffer, count } = system.particles {
        if system.bounds.is_none() {
            return Err(FieldError::new(field("bounds"), "None", "the box of the particles, which are on the GPU"));
        }
        let needed = u64::from(count) * size_of::<crate::Particle>() as u64;
        if buffer.size() < needed || !buffer.usage().contains(wgpu::BufferUsages::VERTEX) {
            let value = format!("{} bytes, usage {:?}", buffer.size(), buffer.usage());
            return Err(FieldError::new(field("particles"), value, format!("at least {needed} bytes, usage VERTEX")));
        }
    }
    system.material.info.validate(index, system.settings)?;
    if system.settings.technique == Technique::SoftLinear && frame.scene_depth.linear().is_none() {
        let expected = "\"soft\", or a scene_depth that is SceneDepth::Linear or Both";
        return Err(FieldError::new(field("settings.technique"), "\"soft_linear\"", expected));
    }
    if system.settings.accumulate.depth_source == DepthSource::Host && !system.settings.is_forward() {
        let attachable = frame.scene_depth.buffer().is_some_and(|buffer| {
            let texture = buffer.texture();
            texture.usage().contains(wgpu::TextureUsages::RENDER_ATTACHMENT) && !texture.format().has_stencil_aspect()
        });
        let is_read = !reads_linear(layouts, &frame.scene_depth, system.settings);
        if !attachable || (is_read && !layouts.read_only_depth) {
            let expected = "\"reduced\", or a scene_depth that has a depth buffer without stencil, with \
                            RENDER_ATTACHMENT usage, and on OpenGL a linear target as well";
            return Err(FieldError::new(field("settings.accumulate.depth_source"), "\"host\"", expected));
        }
    }
    Ok(())
}
