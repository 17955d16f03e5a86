//! The whole frame on the CPU, pass by pass as in `src/renderer.rs`, in f32.

use glam::{IVec2, Mat4, UVec2, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};
use half::f16;

use crate::bounds::Bounds;
use crate::error::FieldError;
use crate::frame::validate_lights;
use crate::gpu_types::{LightUniform, SystemUniform, ViewUniform};
use crate::light::Light;
use crate::material::MaterialAssets;
use crate::particle::{Particle, bounds_of};
use crate::pass::diffuse_bake::size_and_layers;
use crate::pass::sort::{SortScratch, back_to_front};
use crate::reference::blending::{forward_blend, forward_fragment, premultiplied_over, quantise};
use crate::reference::depth::{depth_downsample_keeps_farthest, view_depth_from_ndc_depth};
use crate::reference::diffuse_bake::{
    cube_coordinate, cube_direction, motif_normal, motif_position, spherical_harmonics,
};
use crate::reference::lighting::{
    coverage, diffuse_coordinate, sample_light, soft_scatter_weight, specular_scatter_fade,
};
use crate::reference::normal::{accumulation_from_normal, normal_from_accumulation, rotate_normal};
use crate::reference::picture::Picture;
use crate::reference::ramp::{sample_ramp, sample_ramp_2d};
use crate::reference::saturate;
use crate::reference::soft_fade::{near_fade, soft_fade};
use crate::reference::sprite::{FlipbookFrames, flipbook_frames, sample_sprite, sprite_lod};
use crate::reference::upsample::upsample_weights;
use crate::reference::view::{ndc_from_pixel, pixel_from_ndc, view_position};
use crate::settings::{DepthDownsample, DepthSource, DiffuseMode, Settings, ShadeTree, SoftScatterMode, Upsample};
use crate::system::{SystemInView, lights_in_view, system_in_view};
use crate::view::{SKY_VIEW_DEPTH, View, ViewGeometry};

/// One frame, as [`crate::Frame`], in memory.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// What a depth buffer written with the view's projection would hold, 0..1.
    pub scene_depth: &'a Picture<f32>,
    /// At most [`MAX_LIGHTS`](crate::light::MAX_LIGHTS).
    pub lights: &'a [Light],
    /// Drawn far to near.
    pub systems: &'a [System<'a>],
    /// Which stage of the shading is shown.
    pub shade_tree: ShadeTree,
}

/// One particle system, as [`crate::System`], in memory.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// The sprites, in any order.
    pub particles: &'a [Particle],
    /// A box that holds every sprite; `None` measures them.
    pub bounds: Option<Bounds>,
    /// Everything a slider moves.
    pub settings: &'a Settings,
    /// Ramps and sprite picture.
    pub material: &'a MaterialAssets,
}

/// Blends the frame's smoke over `picture`, linear HDR.
///
/// # Errors
/// The view, light or setting that cannot be used; `picture` is untouched then.
pub fn render(frame: &Frame<'_>, picture: &mut Picture<Vec4>) -> Result<(), FieldError> {
    let view = ViewGeometry::new(&frame.view)?;
    validate_lights(frame.lights)?;
    for (name, size) in [("scene_depth", frame.scene_depth.size), ("picture", picture.size)] {
        if size != frame.view.size {
            let value = format!("{}x{}", size.x, size.y);
            return Err(FieldError::new(name, value, format!("{}x{}", frame.view.size.x, frame.view.size.y)));
        }
    }
    let mut draws = Vec::new();
    for (index, system) in frame.systems.iter().enumerate() {
        system.settings.validate(|| format!("systems[{index}].settings"))?;
        draws.extend(Draw::new(&view, frame, system)?);
    }
    draws.sort_by(|a, b| b.distance.total_cmp(&a.distance));

    for draw in &draws {
        if draw.settings.is_forward() {
            if matches!(frame.shade_tree, ShadeTree::Final | ShadeTree::Combined) {
                draw.forward(picture);
            }
            continue;
        }
        let reduced_depth = draw.depth_downsample();
        let accumulation = draw.accumulate(&reduced_depth, frame.shade_tree == ShadeTree::Overdraw);
        let smoke = Smoke { draw, baked: draw.diffuse_bake(), reduced_depth, accumulation };
        if frame.shade_tree != ShadeTree::SpecularScatter {
            smoke.transfer(frame.shade_tree, picture);
        }
        if matches!(frame.shade_tree, ShadeTree::Final | ShadeTree::SpecularScatter) {
            smoke.specular_scatter(picture);
        }
    }
    Ok(())
}

/// A system in sight, with what its passes read.
struct Draw<'a> {
    /// View depth of the box's middle.
    distance: f32,
    view: ViewUniform,
    world_from_view: Mat4,
    system: SystemUniform,
    in_view: SystemInView,
    lights: Vec<LightUniform>,
    /// Farthest first.
    particles: Vec<Particle>,
    scene_depth: &'a Picture<f32>,
    settings: &'a Settings,
    material: &'a MaterialAssets,
}

impl<'a> Draw<'a> {
    fn new(view: &ViewGeometry, frame: &Frame<'a>, system: &System<'a>) -> Result<Option<Self>, FieldError> {
        let bounds = system.bounds.unwrap_or_else(|| bounds_of(system.particles));
        let mut lights = Vec::new();
        lights_in_view(view, frame.lights, &bounds, &mut lights);
        let info = system.material.info();
        let Some(in_view) = system_in_view(view, &bounds, system.settings, &info, &lights)? else {
            return Ok(None);
        };
        let mut particles = Vec::new();
        back_to_front(view, system.particles, &mut SortScratch::default(), &mut particles);
        Ok(Some(Self {
            distance: -view.view_position(bounds.centre()).z,
            view: view.uniform(false),
            world_from_view: view.view.view_from_world.inverse(),
            system: in_view.uniform,
            in_view,
            lights,
            particles,
            scene_depth: frame.scene_depth,
            settings: system.settings,
            material: system.material,
        }))
    }

    fn scene_view_depth(&self, pixel: IVec2) -> f32 {
        view_depth_from_ndc_depth(self.scene_depth.load(pixel), self.view.depth_coefficients)
    }

    /// The view-space point at a view depth on the ray through a pixel.
    fn view_position(&self, pixel: Vec2, view_depth: f32) -> Vec3 {
        let ray = ndc_from_pixel(pixel, self.view.size) * self.view.ray_scale + self.view.ray_offset;
        view_position(ray, view_depth, self.view.orthographic)
    }

    fn pixel_from_view(&self, position: Vec3) -> Vec2 {
        let clip = self.view.clip_from_view * position.extend(1.0);
        pixel_from_ndc(clip.xy() / clip.w, self.view.size)
    }

    fn pixels_per_metre(&self, view_depth: f32) -> f32 {
        let along = if self.view.orthographic > 0.5 { 1.0 } else { 1.0 / view_depth };
        0.5 * self.view.size.y / self.view.ray_scale.y * along
    }

    // depth_downsample

    fn depth_downsample(&self) -> Picture<f32> {
        let mut reduced = Picture::new(self.in_view.rect.size, 0.0);
        let mode = self.settings.accumulate.depth_downsample;
        let scale = self.system.scale as i32;
        let limit = |depth: f32| depth.min(self.system.depth_limit);
        reduced.for_each(|at, texel| {
            let at = at.as_ivec2() + self.in_view.rect.origin;
            let first = at * scale;
            let last = self.scene_depth.size.as_ivec2() - 1;
            *texel = if self.settings.accumulate.depth_source == DepthSource::Host {
                self.scene_view_depth(first)
            } else if mode == DepthDownsample::Point {
                limit(self.scene_view_depth((first + scale / 2).min(last)))
            } else {
                let (mut nearest, mut farthest) = (SKY_VIEW_DEPTH, 0.0_f32);
                let end = (first + scale - 1).min(last);
                for y in first.y..=end.y {
                    for x in first.x..=end.x {
                        let depth = self.scene_view_depth(IVec2::new(x, y));
                        nearest = nearest.min(depth);
                        farthest = farthest.max(depth);
                    }
                }
                limit(if depth_downsample_keeps_farthest(mode, at) { farthest } else { nearest })
            };
        });
        reduced
    }

    // accumulate

    fn accumulate(&self, reduced_depth: &Picture<f32>, overdraw: bool) -> Picture<Vec4> {
        let mut accumulation = Picture::new(self.in_view.rect.size, Vec4::ZERO);
        let accumulate = &self.settings.accumulate;
        let origin = self.in_view.rect.origin.as_vec2();
        accumulation.for_bands(|first_row, band| {
            let grid = Grid { origin, scale: self.system.scale, size: self.in_view.rect.size };
            self.for_fragments(&grid, first_row, band, |at, sprite, uv, texel: &mut Vec4| {
                let distance = reduced_depth.load(at) - sprite.view_depth;
                let fade = self.soft_fade(distance);
                if fade <= 0.0 {
                    return;
                }
                let blended = if overdraw {
                    *texel + Vec4::splat(1.0 / 255.0)
                } else {
                    let fragment = self.sprite_fragment(sprite, uv);
                    let amount = fragment.w * fade;
                    let source = accumulation_from_normal(accumulate.encoding, fragment.xyz(), amount);
                    premultiplied_over(source, *texel)
                };
                *texel = quantise(accumulate.format, blended);
            });
        });
        accumulation
    }

    fn soft_fade(&self, distance: f32) -> f32 {
        let system = &self.system;
        let curve = self.settings.soft_fade.curve;
        soft_fade(curve, distance, system.fade_scale, system.contrast_power, system.epsilon)
    }

    /// Calls `f(texel position, sprite, uv, texel)` for every fragment of every sprite in a band of rows, in order.
    fn for_fragments<T>(
        &self,
        grid: &Grid,
        first_row: u32,
        band: &mut [T],
        f: impl Fn(IVec2, &SpriteSetup, Vec2, &mut T),
    ) {
        let width = grid.size.x as i32;
        let rows = band.len() as i32 / width;
        let (top, bottom) = (first_row as i32, first_row as i32 + rows);
        for particle in &self.particles {
            let Some(sprite) = self.sprite_setup(particle, 1.0 / grid.scale) else { continue };
            // Half the diagonal holds the sprite at every rotation.
            let reach = Vec2::splat(sprite.radius * std::f32::consts::SQRT_2);
            let corner = |sign: f32| {
                let position = (sprite.centre.xy() + reach * sign).extend(sprite.centre.z);
                self.pixel_from_view(position) / grid.scale - grid.origin
            };
            let (a, b) = (corner(-1.0), corner(1.0));
            let min = a.min(b).floor().as_ivec2().max(IVec2::new(0, top));
            let max = a.max(b).ceil().as_ivec2().min(IVec2::new(width, bottom));
            for y in min.y..max.y {
                for x in min.x..max.x {
                    let at = IVec2::new(x, y);
                    let pixel = (at.as_vec2() + 0.5 + grid.origin) * grid.scale;
                    let offset = self.view_position(pixel, sprite.view_depth) - sprite.centre;
                    // Undo the sprite's rotation.
                    let local = Vec2::new(
                        offset.x * sprite.rotation.x + offset.y * sprite.rotation.y,
                        offset.y * sprite.rotation.x - offset.x * sprite.rotation.y,
                    ) / sprite.radius;
                    if local.abs().max_element() <= 1.0 {
                        let uv = Vec2::new(local.x * 0.5 + 0.5, 0.5 - local.y * 0.5);
                        f(at, &sprite, uv, &mut band[((y - top) * width + x) as usize]);
                    }
                }
            }
        }
    }

    /// `sprite_vertex()` in sprite_vertex.wgsl; `None` when the sprite is hidden.
    fn sprite_setup(&self, particle: &Particle, texels_per_pixel: f32) -> Option<SpriteSetup> {
        let system = &self.system;
        let centre = self.view.view_from_world.transform_point3(particle.position);
        let view_depth = -centre.z;
        let amount =
            particle.amount * system.opacity * near_fade(view_depth, system.near_fade_start, system.near_fade_end);
        let visible =
            view_depth > self.view.near && view_depth < self.view.far && particle.radius > 0.0 && amount > 0.0;
        visible.then(|| SpriteSetup {
            centre,
            view_depth,
            radius: particle.radius,
            rotation: Vec2::new(particle.rotation.cos(), particle.rotation.sin()),
            amount,
            lod: sprite_lod(
                system.sprite_size,
                2.0 * particle.radius * self.pixels_per_metre(view_depth) * texels_per_pixel,
            ),
            frames: flipbook_frames(particle.frame, system.frame_count),
        })
    }

    /// Normal (view space) and amount, before the soft fade. `sprite_fragment()` in sprite_vertex.wgsl.
    fn sprite_fragment(&self, sprite: &SpriteSetup, uv: Vec2) -> Vec4 {
        let texel = sample_sprite(&self.material.sprite, uv, sprite.frames, sprite.lod);
        let normal = rotate_normal(texel.xyz(), sprite.rotation);
        normal.extend(texel.w * sprite.amount)
    }

    // light

    fn diffuse_from_lights(&self, normal: Vec3, position: Vec3) -> Vec3 {
        let light = |light: &LightUniform| {
            let sample = sample_light(light, position);
            let falloff = sample_ramp(&self.material.diffuse_ramp, diffuse_coordinate(normal, sample.direction));
            falloff * light.colour * sample.attenuation
        };
        self.lights.iter().map(light).sum()
    }

    fn soft_scatter(&self, amount: f32) -> Vec3 {
        let system = &self.system;
        let colour = match self.settings.soft_scatter.mode {
            SoftScatterMode::Ramp => sample_ramp(&self.material.soft_scatter_ramp, amount),
            SoftScatterMode::Smoothstep => {
                let weight = soft_scatter_weight(amount, system.scatter_amount, system.scatter_smooth);
                system.scatter_colour.lerp(system.ambient_colour, weight)
            }
        };
        colour * system.soft_scatter_intensity
    }

    /// Faces of the cubemap, or the motif; the first row is −1.
    fn diffuse_bake(&self) -> Vec<Picture<Vec3>> {
        let mode = self.settings.diffuse.mode;
        let Some((side, layers)) = size_and_layers(mode) else { return Vec::new() };
        let face = |face: i32| {
            let mut baked = Picture::new(UVec2::splat(side), Vec3::ZERO);
            baked.for_each(|at, texel| {
                let place = at.as_vec2() / (side - 1) as f32 * 2.0 - 1.0;
                let normal = match mode {
                    DiffuseMode::Motif => motif_normal(place),
                    _ => cube_direction(face, place).normalize(),
                };
                let light = self.diffuse_from_lights(normal, self.system.bounds_centre);
                *texel = Vec3::from(light.to_array().map(|channel| f16::from_f32(channel).to_f32()));
            });
            baked
        };
        (0..layers as i32).map(face).collect()
    }

    // forward

    fn forward(&self, picture: &mut Picture<Vec4>) {
        let grid = Grid { origin: Vec2::ZERO, scale: 1.0, size: picture.size };
        let mode = self.settings.blend_mode;
        picture.for_bands(|first_row, band| {
            self.for_fragments(&grid, first_row, band, |at, sprite, uv, texel: &mut Vec4| {
                let fade = self.soft_fade(self.scene_view_depth(at) - sprite.view_depth);
                let fragment = self.sprite_fragment(sprite, uv);
                let amount = fragment.w * fade;
                if amount <= 0.0 {
                    return;
                }
                let normal = fragment.xyz() / fragment.xyz().length_squared().max(1.0e-12).sqrt();
                let position = self.view_position(at.as_vec2() + 0.5, sprite.view_depth);
                let diffuse = self.diffuse_from_lights(normal, position) * self.system.diffuse_intensity;
                let light = diffuse + self.soft_scatter(amount);
                let source = forward_fragment(mode, light, coverage(amount, self.system.boost));
                *texel = forward_blend(mode, source, *texel);
            });
        });
    }
}

/// A sprite in view space.
struct SpriteSetup {
    centre: Vec3,
    view_depth: f32,
    radius: f32,
    rotation: Vec2,
    amount: f32,
    lod: f32,
    frames: FlipbookFrames,
}

/// The texels that sprites are drawn on: texel (i, j) is the pixels from (origin + (i, j)) · scale.
struct Grid {
    origin: Vec2,
    scale: f32,
    size: UVec2,
}

/// A system's finished target.
struct Smoke<'a> {
    draw: &'a Draw<'a>,
    baked: Vec<Picture<Vec3>>,
    reduced_depth: Picture<f32>,
    accumulation: Picture<Vec4>,
}

impl Smoke<'_> {
    /// `sample_accumulation()` in accumulated.wgsl.
    fn sample_accumulation(&self, pixel: Vec2) -> Vec4 {
        let system = &self.draw.system;
        let texel = pixel / system.scale - system.target_origin;
        if texel.cmplt(Vec2::ZERO).any() || texel.cmpge(system.target_size).any() {
            return Vec4::ZERO;
        }
        if system.scale == 1.0 {
            return self.accumulation.load(texel.as_ivec2());
        }
        let upsample = self.draw.settings.accumulate.upsample;
        let corner = texel - 0.5;
        let base = corner.floor();
        let offsets = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE];
        let taps = offsets.map(|offset| base.as_ivec2() + offset);
        let (depths, depth) = match upsample {
            Upsample::Bilinear => (Vec4::ZERO, 0.0),
            _ => {
                let depth = self.draw.scene_view_depth(pixel.as_ivec2()).min(system.depth_limit);
                (Vec4::from(taps.map(|tap| self.reduced_depth.load(tap))), depth)
            }
        };
        let weights = upsample_weights(upsample, corner - base, depths, depth);
        taps.iter().zip(weights.to_array()).map(|(&tap, weight)| self.accumulation.load(tap) * weight).sum()
    }

    fn sample_baked(&self, position: Vec2, layer: usize) -> Vec3 {
        let baked = &self.baked[layer];
        let unit = (position * 0.5 + 0.5).clamp(Vec2::ZERO, Vec2::ONE);
        let texel = unit * (baked.size.as_vec2() - 1.0);
        let base = texel.floor();
        let fraction = texel - base;
        let at = |offset| baked.load(base.as_ivec2() + offset);
        let bottom = at(IVec2::ZERO).lerp(at(IVec2::X), fraction.x);
        let top = at(IVec2::Y).lerp(at(IVec2::ONE), fraction.x);
        bottom.lerp(top, fraction.y)
    }

    fn diffuse(&self, normal: Vec3, position: Vec3) -> Vec3 {
        let draw = self.draw;
        let light = match draw.settings.diffuse.mode {
            DiffuseMode::Ramp => draw.diffuse_from_lights(normal, position),
            DiffuseMode::Cubemap => {
                let cube = cube_coordinate(normal);
                self.sample_baked(cube.position, cube.face as usize)
            }
            DiffuseMode::Motif => self.sample_baked(motif_position(normal), 0),
            DiffuseMode::PaintedMotif => sample_ramp_2d(&draw.material.motif, motif_position(normal) * 0.5 + 0.5),
            DiffuseMode::SphericalHarmonics => spherical_harmonics(&draw.system.spherical_harmonics, normal),
        };
        light * draw.system.diffuse_intensity
    }

    // transfer

    fn transfer(&self, shade_tree: ShadeTree, picture: &mut Picture<Vec4>) {
        picture.for_each(|at, texel| {
            let pixel = at.as_vec2() + 0.5;
            if self.box_is_drawn(at.as_ivec2(), pixel) {
                if let Some(source) = self.transfer_fragment(shade_tree, pixel) {
                    *texel = premultiplied_over(source, *texel);
                }
            }
        });
    }

    /// True if the face of the box that the transfer draws covers the pixel and passes the depth test.
    fn box_is_drawn(&self, at: IVec2, pixel: Vec2) -> bool {
        let draw = self.draw;
        // The ray by view depth: from the eye, or straight ahead.
        let (start, end) = (draw.view_position(pixel, 0.0), draw.view_position(pixel, 1.0));
        let origin = draw.world_from_view.transform_point3(start);
        let direction = draw.world_from_view.transform_vector3(end - start);
        let t0 = (draw.system.bounds_min - origin) / direction;
        let t1 = (draw.system.bounds_max - origin) / direction;
        let enter = t0.min(t1).max_element();
        let exit = t0.max(t1).min_element();
        if draw.in_view.back_faces {
            enter <= exit && exit > 0.0
        } else {
            enter <= exit && enter <= draw.scene_view_depth(at)
        }
    }

    fn transfer_fragment(&self, shade_tree: ShadeTree, pixel: Vec2) -> Option<Vec4> {
        let system = &self.draw.system;
        let accumulate = &self.draw.settings.accumulate;
        if shade_tree == ShadeTree::ReducedDepth {
            let depth = self.reduced_depth.load((pixel / system.scale - system.target_origin).as_ivec2());
            let grey = 1.0 - saturate((depth - system.bounds_near) / (system.depth_limit - system.bounds_near));
            return Some(Vec3::splat(grey).extend(1.0));
        }
        let accumulated = self.sample_accumulation(pixel);
        let amount = accumulated.w;
        match shade_tree {
            ShadeTree::Overdraw => return Some(overdraw_colour(amount * 255.0).extend(1.0)),
            ShadeTree::Amount => return Some(Vec3::splat(amount).extend(1.0)),
            _ => {}
        }
        if amount <= 0.0 {
            return None;
        }
        let covered = coverage(amount, system.boost);
        let normal = normal_from_accumulation(accumulate.encoding, accumulate.decode, accumulated);
        if shade_tree == ShadeTree::Normals {
            return Some((normal * 0.5 + 0.5).extend(1.0) * covered);
        }
        let mut light = Vec3::ZERO;
        if shade_tree != ShadeTree::SoftScatter {
            light += self.diffuse(normal, self.draw.view_position(pixel, system.plane_depth));
        }
        if shade_tree != ShadeTree::Diffuse {
            light += self.draw.soft_scatter(amount);
        }
        Some(light.extend(1.0) * covered)
    }

    // specular_scatter

    fn specular_scatter(&self, picture: &mut Picture<Vec4>) {
        let draw = self.draw;
        let (size, view) = (draw.system.specular_scatter_size, &draw.view);
        for light in &draw.lights {
            let directional = light.directional > 0.5;
            let homogeneous = if directional { (-light.direction).extend(0.0) } else { light.position.extend(1.0) };
            let clip = view.clip_from_view * homogeneous;
            let depth = if directional { SKY_VIEW_DEPTH } else { -light.position.z };
            let fade = specular_scatter_fade(depth, draw.system.bounds_near, draw.system.bounds_far);
            let strength = light.specular_scatter * draw.system.specular_scatter_intensity * fade;
            if clip.w <= 0.0 || depth <= view.near || strength <= 0.0 {
                continue;
            }
            let centre = pixel_from_ndc(clip.xy() / clip.w, view.size);
            if (centre - 0.5 * view.size).abs().cmpgt(0.5 * view.size + size).any() {
                continue;
            }
            let body = (light.radius * draw.pixels_per_metre(depth)).max(1.5);
            let compared_depth = (depth - 2.0 * light.radius).min(0.99 * view.far);
            let visibility = self.light_visibility(centre, body, compared_depth);
            let colour = light.colour * strength * visibility;
            if visibility <= 0.0 {
                continue;
            }
            picture.for_each(|at, texel| {
                let pixel = at.as_vec2() + 0.5;
                let uv = (pixel - centre) / size;
                let distance_squared = uv.length_squared();
                if distance_squared >= 1.0 {
                    return;
                }
                let amount = self.sample_accumulation(pixel).w;
                if amount > 0.0 {
                    let ramp = &draw.material.specular_ramp;
                    let glow = sample_ramp_2d(ramp, Vec2::new(distance_squared, amount));
                    *texel += (glow * colour).extend(0.0);
                }
            });
        }
    }

    /// The share of a light's body that the scene leaves visible: a ring of 8 taps and the middle.
    fn light_visibility(&self, pixel: Vec2, radius: f32, light_depth: f32) -> f32 {
        let visible = |i: u32| {
            let angle = i as f32 * std::f32::consts::FRAC_PI_4;
            let offset = if i == 8 { Vec2::ZERO } else { Vec2::new(angle.cos(), angle.sin()) * radius };
            self.draw.scene_view_depth((pixel + offset).floor().as_ivec2()) >= light_depth
        };
        (0..9).filter(|&i| visible(i)).count() as f32 / 9.0
    }
}

/// Black, blue, green, yellow, red, white at 0, 4, 8, 16, 32, 64 layers.
fn overdraw_colour(layers: f32) -> Vec3 {
    let heat = if layers > 4.0 { layers.log2() - 1.0 } else { layers * 0.25 };
    let colours = [Vec3::ZERO, Vec3::Z, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::X, Vec3::ONE];
    let index = (heat.max(0.0) as usize).min(colours.len() - 2);
    colours[index].lerp(colours[index + 1], saturate(heat - index as f32))
}
