//! One pixel, number by number: what the passes worked with, from texels as the GPU left them.

use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use super::accumulated::Accumulated;
use super::blend_unit::premultiplied_over;
use super::draw::{Draw, visible};
use super::frame::Frame;
use haze::assets::picture::Picture;
use haze::error::FieldError;
use haze::formula::lighting::{coverage, diffuse_coordinate, sample_light, soft_scatter_weight};
use haze::formula::six_way::SixWay;
use haze::in_view::{ViewGeometry, lights_in_view};
use haze::settings::{ShadeTree, SoftScatterMode};

/// What a system was accumulated into, as read back: the textures of [`TargetViews`](haze::TargetViews), of the part in use.
#[derive(Clone, Debug)]
pub struct Texels {
    /// Normal and amount, as the target encodes them.
    pub accumulation: Picture<Vec4>,
    /// What is kept beside it: in x what the weights of the normals sum to, or the other half of six-way light.
    pub beside: Option<Picture<Vec4>>,
    /// Linear view depth, metres; `None` where sprites are compared with the scene's own.
    pub reduced_depth: Option<Picture<f32>>,
    /// Light by normal: the faces of a cubemap, one motif, or none.
    pub baked: Vec<Picture<Vec3>>,
}

/// What became of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Every deferred system whose box is drawn there and that has smoke there, far to near.
    pub systems: Vec<SystemProbe>,
    /// The picture's colour, linear HDR. `None` where a system is forward: that keeps no texels to tell from.
    pub colour: Option<Vec4>,
}

/// What a system adds to a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemProbe {
    /// Which of the frame's systems.
    pub system: usize,
    /// Accumulated alpha, 0 to 1.
    pub amount: f32,
    /// Amount times `boost`, 0 to 1: where the coverage ramp is looked up.
    pub coverage_coordinate: f32,
    /// Share of what is behind that is hidden.
    pub coverage: f32,
    /// Unit length, view space: z towards the viewer.
    pub normal: Vec3,
    /// What it shows under light from each side, view space, where that is what it is lit by.
    pub six_way: Option<SixWay>,
    /// The lights that reach the system.
    pub lights: Vec<LightProbe>,
    /// Diffuse light, as the system's mode finds it, times its intensity.
    pub diffuse: Vec3,
    /// How far soft scatter has gone from `scatter_colour` to `ambient_colour`; `None` where it comes from a ramp.
    pub soft_scatter_weight: Option<f32>,
    /// Soft scatter, times its intensity.
    pub soft_scatter: Vec3,
    /// Premultiplied light and coverage, as it is blended.
    pub blended: Vec4,
}

/// What a light does to a pixel of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct LightProbe {
    /// Which of the frame's lights.
    pub light: usize,
    /// Of normal and direction to the light.
    pub cosine: f32,
    /// Where the diffuse ramp is looked up, 0 to 1.
    pub coordinate: f32,
    /// Multiplies the light's colour.
    pub attenuation: f32,
    /// What it adds by the diffuse ramp or six-way maps, times the intensity of diffuse light. Other modes than `ramp` sum up otherwise.
    pub diffuse: Vec3,
    /// Its glow; `None` where its quad does not reach, or the scene hides it.
    pub glow: Option<GlowProbe>,
}

/// A light's glow in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlowProbe {
    /// Where the specular ramp is looked up: distance² and amount, 0 to 1.
    pub coordinate: Vec2,
    /// What it adds.
    pub specular: Vec3,
}

/// Tells what became of some pixels of a frame, by the formulas that draw it. `texels` has those of every system, by its place in
/// the frame, nothing for those that are out of sight or forward; `behind` is the scene without smoke.
///
/// # Errors
/// As [`render`](super::render); and texels that are not of the system's size.
pub fn probe(
    frame: &Frame<'_>,
    texels: &[Option<Texels>],
    behind: &Picture<Vec4>,
    pixels: &[UVec2],
) -> Result<Vec<Probe>, FieldError> {
    let draws = visible(frame, behind.size)?;
    let mut deferred = Vec::new();
    for (index, draw) in draws.iter().filter(|(_, draw)| !draw.settings.is_forward()) {
        let Some(Some(texels)) = texels.get(*index) else { continue };
        // The scene's own depth, where sprites are compared with that.
        let own_depth = texels.reduced_depth.is_none().then(|| draw.depth_downsample());
        deferred.push((*index, draw, texels, own_depth));
    }
    let mut systems = Vec::new();
    for (index, draw, texels, own_depth) in &deferred {
        let Some(depth) = texels.reduced_depth.as_ref().or(own_depth.as_ref()) else { continue };
        systems.push((*index, Smoke::new(frame, draw, texels, depth)?));
    }
    let has_forward = draws.iter().any(|(_, draw)| draw.settings.is_forward());
    let at = |&pixel: &UVec2| {
        let mut colour = behind.load(pixel.as_ivec2());
        let systems = systems.iter().filter_map(|(index, smoke)| smoke.at(*index, pixel, &mut colour)).collect();
        Probe { systems, colour: (!has_forward).then_some(colour) }
    };
    Ok(pixels.iter().map(at).collect())
}

/// A system, and its texels.
struct Smoke<'a> {
    accumulated: Accumulated<'a>,
    /// Places of its lights among the frame's.
    lights: Vec<usize>,
}

impl<'a> Smoke<'a> {
    fn new(
        frame: &Frame<'_>,
        draw: &'a Draw<'a>,
        texels: &'a Texels,
        reduced_depth: &'a Picture<f32>,
    ) -> Result<Self, FieldError> {
        let Texels { accumulation, beside, baked, .. } = texels;
        let size = draw.in_view.rect.size;
        let sizes = [Some(accumulation.size), beside.as_ref().map(|t| t.size), Some(reduced_depth.size)];
        if let Some(other) = sizes.into_iter().flatten().find(|other| *other != size) {
            let value = format!("{}x{}", other.x, other.y);
            return Err(FieldError::new("texels", value, format!("{}x{}, as the system has", size.x, size.y)));
        }
        let accumulated = Accumulated { draw, baked, reduced_depth, accumulation, beside: beside.as_ref(), lit: None };
        let view = ViewGeometry::new(&haze::View { origin: UVec2::ZERO, ..frame.view })?;
        let mut reached = Vec::new();
        let lights = frame.lights.iter().enumerate().filter(|(_, light)| {
            lights_in_view(&view, std::slice::from_ref(light), &draw.bounds, &mut reached);
            !reached.is_empty()
        });
        let lights = lights.map(|(index, _)| index).collect();
        Ok(Self { accumulated, lights })
    }

    /// What is seen of the system, which is blended over `colour`.
    fn at(&self, index: usize, at: UVec2, colour: &mut Vec4) -> Option<SystemProbe> {
        let smoke = &self.accumulated;
        let draw = smoke.draw;
        let pixel = at.as_vec2() + 0.5;
        let blended = smoke
            .box_is_drawn(at.as_ivec2(), pixel)
            .then(|| smoke.transfer_fragment(ShadeTree::Final, pixel))
            .flatten();
        if let Some(blended) = blended {
            *colour = premultiplied_over(blended, *colour);
        }
        let glows: Vec<_> =
            draw.lights.iter().map(|light| smoke.glow(light).and_then(|g| smoke.glow_at(&g, pixel))).collect();
        *colour += glows.iter().flatten().map(|(_, glow)| *glow).sum::<Vec3>().extend(0.0);
        let (amount, surface) = smoke.amount_and_surface(pixel);
        if amount <= 0.0 {
            return None;
        }
        let position = draw.view_position(pixel, -draw.system.centre.z);
        let covered = coverage(amount, draw.system.boost);
        let light = |((light, glow), &index): ((_, &Option<(Vec2, Vec3)>), &usize)| {
            let sample = sample_light(light, position);
            LightProbe {
                light: index,
                cosine: surface.normal.dot(sample.direction),
                coordinate: diffuse_coordinate(surface.normal, sample.direction),
                attenuation: sample.attenuation,
                diffuse: smoke.diffuse_from_light(light, &surface, covered, position) * draw.system.diffuse_intensity,
                glow: glow.map(|(coordinate, specular)| GlowProbe { coordinate, specular }),
            }
        };
        let system = &draw.system;
        let is_curve = draw.settings.soft_scatter.mode == SoftScatterMode::Smoothstep;
        Some(SystemProbe {
            system: index,
            amount,
            coverage_coordinate: covered,
            coverage: smoke.coverage(amount),
            normal: surface.normal,
            six_way: draw.settings.is_six_way().then_some(surface.six_way),
            lights: draw.lights.iter().zip(&glows).zip(&self.lights).map(light).collect(),
            diffuse: smoke.diffuse(&surface, amount, position),
            soft_scatter_weight: is_curve
                .then(|| soft_scatter_weight(amount, system.scatter_amount, system.scatter_smooth)),
            soft_scatter: draw.soft_scatter(amount),
            blended: blended.unwrap_or(Vec4::ZERO),
        })
    }
}

impl SystemProbe {
    /// The glow of all lights.
    pub fn specular(&self) -> Vec3 {
        self.lights.iter().filter_map(|light| light.glow).map(|glow| glow.specular).sum()
    }

    /// Light before it is covered: what the stage `combined` shows.
    pub fn light(&self) -> Vec3 {
        if self.coverage > 0.0 { self.blended.xyz() / self.coverage } else { Vec3::ZERO }
    }
}
