//! What the host hands over for one frame.

use glam::{UVec2, Vec3};

use crate::bounds::{Bounds, effective_scale};
use crate::error::FieldError;
use crate::fields::validate;
use crate::light::{Light, MAX_LIGHTS};
use crate::material::Material;
use crate::particle::Particle;
use crate::settings::{DepthSource, Settings, ShadeTree};
use crate::view::View;

/// Everything that [`Renderer::prepare`](crate::Renderer::prepare) needs to know about a frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// The opaque scene's depth, already rendered in this encoder or an earlier one.
    pub scene_depth: SceneDepth<'a>,
    /// At most [`MAX_LIGHTS`].
    pub lights: &'a [Light],
    /// Drawn far to near, whatever their order here. A system keeps its targets from frame to frame by its place in
    /// this slice, so keep the order steady.
    pub systems: &'a [System<'a>],
    /// Seconds, from any start: the noise of volumetric sprites scrolls with it.
    pub time: f32,
    /// Which stage of the shading is shown; [`ShadeTree::Final`] for a picture.
    pub shade_tree: ShadeTree,
}

/// The opaque scene's depth at full resolution, single-sampled, with `TEXTURE_BINDING` usage and the size of the view.
#[derive(Clone, Copy, Debug)]
pub enum SceneDepth<'a> {
    /// A depth buffer written with the view's projection; the view of it shows the depth aspect only.
    Buffer(&'a wgpu::TextureView),
    /// An `R32Float` target with linear view depth in metres; no surface: anything from 1e6 up.
    Linear(&'a wgpu::TextureView),
    /// Both of the same scene. The buffer is read, but by systems of the technique
    /// [`SoftLinear`](crate::settings::Technique::SoftLinear), and where the backend (OpenGL) cannot read the buffer that
    /// is attached to the pass.
    Both {
        /// As in [`SceneDepth::Buffer`].
        buffer: &'a wgpu::TextureView,
        /// As in [`SceneDepth::Linear`].
        linear: &'a wgpu::TextureView,
    },
}

impl<'a> SceneDepth<'a> {
    /// The depth buffer, if there is one.
    pub fn buffer(&self) -> Option<&'a wgpu::TextureView> {
        match self {
            Self::Buffer(view) | Self::Both { buffer: view, .. } => Some(view),
            Self::Linear(_) => None,
        }
    }

    /// The texture that a system reads, which [`reads_linear`](crate::slot::reads_linear) tells.
    pub(crate) fn read_by(&self, linear_depth: bool) -> &'a wgpu::TextureView {
        match self {
            Self::Buffer(view) | Self::Linear(view) => view,
            Self::Both { buffer, linear } => {
                if linear_depth {
                    linear
                } else {
                    buffer
                }
            }
        }
    }

    /// The linear target, if there is one.
    pub fn linear(&self) -> Option<&'a wgpu::TextureView> {
        match self {
            Self::Linear(view) | Self::Both { linear: view, .. } => Some(view),
            Self::Buffer(_) => None,
        }
    }
}

/// One particle system: sprites that are accumulated together and lit as one body.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// The sprites, in any order.
    pub particles: Particles<'a>,
    /// A box in world space that holds every sprite; what is outside may be cut off. `None` measures the slice.
    pub bounds: Option<Bounds>,
    /// Everything a slider moves.
    pub settings: &'a Settings,
    /// Ramps and sprite picture, made by [`Renderer::create_material`](crate::Renderer::create_material).
    pub material: &'a Material,
}

/// Where the sprites are.
#[derive(Clone, Copy, Debug)]
pub enum Particles<'a> {
    /// In memory. Sorted and uploaded by [`Renderer::prepare`](crate::Renderer::prepare). A sprite with a number that
    /// is not finite, or out of its range, is skipped.
    Slice(&'a [Particle]),
    /// On the GPU, in the layout of [`Particle`], back to front, with `VERTEX` usage. `System::bounds` must be given.
    Buffer {
        /// `count` particles from the start.
        buffer: &'a wgpu::Buffer,
        /// How many to draw.
        count: u32,
    },
}

/// What both renderers refuse about the settings of system `index` in a picture of this size.
pub(crate) fn validate_settings(index: usize, settings: &Settings, picture: UVec2) -> Result<(), FieldError> {
    settings.validate(|| format!("systems[{index}].settings"))?;
    let accumulate = &settings.accumulate;
    let is_host = accumulate.depth_source == DepthSource::Host && !settings.is_forward();
    if is_host && effective_scale(accumulate.scale, accumulate.max_side, picture) != 1 {
        let field = format!("systems[{index}].settings.accumulate.max_side");
        let expected = format!("at least {} for this picture with depth_source \"host\"", picture.max_element());
        return Err(FieldError::new(field, accumulate.max_side, expected));
    }
    Ok(())
}

/// What both renderers refuse about lights.
pub(crate) fn validate_lights(lights: &[Light]) -> Result<(), FieldError> {
    if lights.len() > MAX_LIGHTS {
        return Err(FieldError::new("lights", format!("{} lights", lights.len()), format!("at most {MAX_LIGHTS}")));
    }
    for (index, light) in lights.iter().enumerate() {
        validate(light, || format!("lights[{index}]"))?;
        if light.kind != crate::light::LightKind::Point && light.direction.normalize_or_zero() == Vec3::ZERO {
            let field = format!("lights[{index}].direction");
            return Err(FieldError::new(field, light.direction, "a direction that is not zero"));
        }
    }
    Ok(())
}
