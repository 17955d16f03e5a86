//! Values of the passes at single pixels, computed from texels that the GPU wrote.

use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::error::FieldError;
use haze_core::formula::fire::fire_from_moments;
use haze_core::formula::lighting::{coverage, diffuse_coordinate, sample_light, soft_scatter_weight};
use haze_core::formula::six_way::SixWay;
use haze_core::formula::uniforms::LightUniform;
use haze_core::settings::{DebugView, SoftScatterMode};
use haze_core::view_setup::{ViewGeometry, light_uniforms};

use super::accumulated::{AccumulatedTarget, AccumulatedTextures};
use super::blend_unit::premultiplied_over;
use super::input::FrameInput;
use super::shade::Shade;
use super::visible_system::{VisibleSystem, place_systems};

/// Textures that a system was accumulated into, as read back from `TargetViews`, cropped to the
/// part in use.
#[derive(Clone, Debug)]
pub struct ProbeTextures {
    /// Textures of the accumulation target, indexed by [`AttachmentRole`](haze_core::view_setup::AttachmentRole); `None` for
    /// those that the system does not have.
    pub accumulation: AccumulatedTextures,
    /// Linear view depth, metres; `None` if sprites are compared with the scene's own.
    pub reduced_depth: Option<Image<f32>>,
    /// Light by normal: the faces of a cubemap, one motif, or empty.
    pub baked: Vec<Image<Vec3>>,
}

/// Values at a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Deferred systems whose box is drawn at the pixel and that have smoke there, far to near.
    pub systems: Vec<SystemProbe>,
    /// Color of the pixel, linear HDR. `None` if a system is forward, because those leave no texels.
    pub color: Option<Vec4>,
}

/// Contribution of a system to a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemProbe {
    /// Index of the system in the frame.
    pub system: usize,
    /// Accumulated alpha, 0 to 1.
    pub amount: f32,
    /// Amount times `boost`, 0 to 1: the lookup coordinate of the coverage ramp.
    pub coverage_coordinate: f32,
    /// Fraction of the background that is hidden.
    pub coverage: f32,
    /// Normal of unit length, view space: z towards the viewer.
    pub normal: Vec3,
    /// Response to light from each side, view space, if the system is lit by six-way maps.
    pub six_way: Option<SixWay>,
    /// Lights that reach the system.
    pub lights: Vec<LightProbe>,
    /// Part of `diffuse` that comes from sky and ground; not known in modes that bake light.
    pub ambient: Option<Vec3>,
    /// Diffuse light by the system's mode, times its intensity.
    pub diffuse: Vec3,
    /// Weight of `ambient_color` against `scatter_color` in soft scatter; `None` if it comes from a ramp.
    pub soft_scatter_weight: Option<f32>,
    /// Soft scatter, times its intensity.
    pub soft_scatter: Vec3,
    /// Light that the smoke gives; `None` if nothing burns there.
    pub fire: Option<FireProbe>,
    /// Premultiplied light and coverage, as blended.
    pub blended: Vec4,
}

/// Contribution of a light to a pixel of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct LightProbe {
    /// Index of the light in the frame.
    pub light: usize,
    /// Cosine between the normal and the direction to the light.
    pub cosine: f32,
    /// Lookup coordinate of the diffuse ramp, 0 to 1.
    pub coordinate: f32,
    /// Multiplies the light's color.
    pub attenuation: f32,
    /// Fraction of the backlight ramp in the light, 0 to 1; the rest comes from the diffuse ramp.
    pub backlight: f32,
    /// Light added through the diffuse ramp or six-way maps, times the intensity of diffuse light. Modes other than
    /// `ramp` sum lights up differently.
    pub diffuse: Vec3,
    /// Smoke and scene between the light and the pixel; `None` if the light has no shadow.
    pub shadow: Option<ShadowProbe>,
    /// Glow of the light; `None` if its quad does not reach the pixel, or the scene hides it.
    pub glow: Option<GlowProbe>,
}

/// Shadow of a light at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowProbe {
    /// Lookup coordinate of the shadow ramp, 0 to 1: smoke in front of the light, and angle between light and viewer.
    pub coordinate: Vec2,
    /// Fraction of the light that comes past the scene and through the smoke.
    pub transmittance: Vec3,
}

/// Light of burning smoke at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FireProbe {
    /// Lookup coordinate of the fire ramp, 0 to 1: mean heat of what burns, and its amount times `boost`.
    pub coordinate: Vec2,
    /// Fraction of the visible smoke that burns, 0 to 1.
    pub fraction: f32,
    /// Light that it gives.
    pub light: Vec3,
}

/// Glow of a light at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlowProbe {
    /// Lookup coordinate of the specular ramp: distance² and amount, 0 to 1.
    pub coordinate: Vec2,
    /// Light that the glow adds.
    pub specular: Vec3,
}

/// Computes the values at some pixels of a frame, with the formulas that draw it. `texels` has one entry per system of
/// the frame, `None` for systems that are not visible or forward; `behind` is the scene without smoke.
///
/// # Errors
/// As [`render`](super::render), and for texels that do not have the system's size.
pub fn probe(
    frame: &FrameInput<'_>,
    texels: &[Option<ProbeTextures>],
    behind: &Image<Vec4>,
    pixels: &[UVec2],
) -> Result<Vec<Probe>, FieldError> {
    let placed = place_systems(frame, behind.size)?;
    let volume = placed.shadow.map(|shadow| Arc::new(placed.shadow_volume_of_texels(frame, &shadow)));
    let mut visible = placed.visible;
    visible.iter_mut().for_each(|(_, visible)| visible.optical_depths = volume.clone());
    let mut deferred = Vec::new();
    for (index, visible) in visible.iter().filter(|(_, visible)| !visible.settings.is_forward()) {
        let Some(Some(texels)) = texels.get(*index) else { continue };
        // The scene's own depth, if sprites are compared with it.
        let own_depth = texels.reduced_depth.is_none().then(|| visible.depth_downsample());
        deferred.push((*index, visible, texels, own_depth));
    }
    let mut systems = Vec::new();
    for (index, visible, texels, own_depth) in &deferred {
        let Some(depth) = texels.reduced_depth.as_ref().or(own_depth.as_ref()) else { continue };
        systems.push((*index, ProbedSystem::new(frame, visible, texels, depth)?));
    }
    let has_forward = visible.iter().any(|(_, visible)| visible.settings.is_forward());
    let at = |&pixel: &UVec2| {
        let mut color = behind.load(pixel.as_ivec2());
        let systems =
            systems.iter().filter_map(|(index, smoke)| smoke.probe_pixel(*index, pixel, &mut color)).collect();
        Probe { systems, color: (!has_forward).then_some(color) }
    };
    Ok(pixels.iter().map(at).collect())
}

/// System with its texels.
struct ProbedSystem<'a> {
    accumulated: AccumulatedTarget<'a>,
    /// Indices of its lights in the frame.
    lights: Vec<usize>,
}

impl<'a> ProbedSystem<'a> {
    fn new(
        frame: &FrameInput<'_>,
        visible: &'a VisibleSystem<'a>,
        texels: &'a ProbeTextures,
        reduced_depth: &'a Image<f32>,
    ) -> Result<Self, FieldError> {
        let ProbeTextures { accumulation: textures, baked, .. } = texels;
        let size = visible.setup.rect.size;
        let sizes = textures.iter().flatten().map(|texture| texture.size).chain([reduced_depth.size]);
        if let Some(other) = sizes.into_iter().find(|other| *other != size) {
            let value = format!("{}x{}", other.x, other.y);
            return Err(FieldError::new("texels", value, format!("{}x{}, the size of the system", size.x, size.y)));
        }
        let is_lit = visible.lights_per_texel(DebugView::Final);
        let accumulated = AccumulatedTarget { visible, baked, reduced_depth, textures, is_lit, lit: None };
        let view = ViewGeometry::new(&haze_core::frame::View { origin: UVec2::ZERO, ..frame.view })?;
        let mut reached = Vec::new();
        let lights = frame.lights.iter().enumerate().filter(|(_, light)| {
            light_uniforms(&view, std::slice::from_ref(light), frame.exposure, &visible.bounds, None, &mut reached);
            !reached.is_empty()
        });
        let lights = lights.map(|(index, _)| index).collect();
        Ok(Self { accumulated, lights })
    }

    /// Contribution of the system, which is blended over `color`.
    fn probe_pixel(&self, index: usize, at: UVec2, color: &mut Vec4) -> Option<SystemProbe> {
        let smoke = &self.accumulated;
        let visible = smoke.visible;
        let pixel = at.as_vec2() + 0.5;
        let blended = smoke
            .covers_pixel(at.as_ivec2(), pixel)
            .then(|| smoke.transfer_fragment(DebugView::Final, pixel))
            .flatten();
        if let Some(blended) = blended {
            *color = premultiplied_over(blended, *color);
        }
        let glows: Vec<_> = visible
            .lights
            .iter()
            .map(|light| smoke.glow_quad(light).and_then(|g| smoke.sample_glow(&g, pixel)))
            .collect();
        *color += glows.iter().flatten().map(|(_, glow)| *glow).sum::<Vec3>().extend(0.0);
        let (amount, surface) = smoke.amount_and_surface(pixel);
        if amount <= 0.0 {
            return None;
        }
        let position = smoke.lit_position(&surface, pixel);
        let covered = coverage(amount, visible.system.boost);
        let light = |((light, glow), &index): ((_, &Option<(Vec2, Vec3)>), &usize)| {
            let sample = sample_light(light, position);
            LightProbe {
                light: index,
                cosine: surface.normal.dot(sample.direction),
                coordinate: diffuse_coordinate(surface.normal, sample.direction),
                attenuation: sample.attenuation,
                backlight: visible.backlight_fraction(sample.direction, position),
                diffuse: smoke.diffuse_from_light(light, &surface, covered, position)
                    * visible.system.diffuse_intensity
                    * surface.tint,
                shadow: visible.probe_shadow(light, sample.direction, position, &surface.shade),
                glow: glow.map(|(coordinate, specular)| GlowProbe { coordinate, specular }),
            }
        };
        let system = &visible.system;
        let is_curve = visible.settings.soft_scatter.mode == SoftScatterMode::Smoothstep;
        Some(SystemProbe {
            system: index,
            amount,
            coverage_coordinate: covered,
            coverage: smoke.coverage(amount),
            normal: surface.normal,
            six_way: visible.settings.is_six_way().then_some(surface.six_way),
            lights: visible.lights.iter().zip(&glows).zip(&self.lights).map(light).collect(),
            ambient: smoke.ambient(&surface, covered),
            diffuse: smoke.diffuse(&surface, amount, position),
            soft_scatter_weight: is_curve
                .then(|| soft_scatter_weight(amount, system.scatter_amount, system.scatter_smooth)),
            soft_scatter: visible.soft_scatter(amount) * surface.tint,
            fire: visible.settings.burns().then(|| visible.probe_fire(surface.heat, amount)).flatten(),
            blended: blended.unwrap_or(Vec4::ZERO),
        })
    }
}

impl VisibleSystem<'_> {
    /// Shadow of a light, as [`Self::shadow_on_light`] looks it up.
    fn probe_shadow(&self, light: &LightUniform, to_light: Vec3, position: Vec3, shade: &Shade) -> Option<ShadowProbe> {
        let is_shadowed = self.system.shadow_strength > 0.0 && light.shadow_slot >= 0.5;
        is_shadowed.then(|| ShadowProbe {
            coordinate: self.shadow_position(light, to_light, position, shade),
            transmittance: self.shadow_on_light(light, to_light, position, shade),
        })
    }

    /// Light of burning smoke, as [`Self::emission`] looks it up. `moments`: means of heat and of its square.
    fn probe_fire(&self, moments: Vec2, amount: f32) -> Option<FireProbe> {
        let fire = fire_from_moments(moments);
        (fire.y > 0.0).then(|| FireProbe {
            coordinate: self.fire_position(fire, amount),
            fraction: fire.y,
            light: self.emission(fire, amount),
        })
    }
}

impl SystemProbe {
    /// Glow of all lights.
    pub fn specular(&self) -> Vec3 {
        self.lights.iter().filter_map(|light| light.glow).map(|glow| glow.specular).sum()
    }

    /// Light before coverage is applied: the value of the debug view `combined`.
    pub fn light(&self) -> Vec3 {
        if self.coverage > 0.0 { self.blended.xyz() / self.coverage } else { Vec3::ZERO }
    }
}
