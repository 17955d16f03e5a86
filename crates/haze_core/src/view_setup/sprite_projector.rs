//! Projection of sprites into the view, as in `shaders/lib/sprite_vertex.wgsl`, and the number of fragments that they
//! cover.

use std::sync::Arc;

use glam::{DVec2, UVec2, Vec2, Vec3, Vec3Swizzles, Vec4};

use crate::assets::material_assets::MaterialInfo;
use crate::assets::sprite::alpha_bounds::AlphaBounds;
use crate::formula::soft_fade::near_fade;
use crate::formula::sprite::{
    FlipbookFrames, animation_frames, offset_frames, sprite_frame, sprite_lod, trimmed_corner,
};
use crate::formula::stretch::{MIN_RADIUS, sprite_stretch, stretched, widened_fraction};
use crate::formula::technique::sphere_axis_bounds;
use crate::formula::uniforms::{SystemUniform, ViewUniform};
use crate::formula::view::{pixel_from_ndc, pixels_per_metre};
use crate::frame::Particle;
use crate::settings::{Settings, SpriteAnimation, Technique};

/// Texel grid that sprites are drawn on: texel (i, j) covers `scale` by `scale` pixels from (origin + (i, j)) · scale.
#[derive(Clone, Copy, Debug)]
pub struct TexelGrid {
    /// First texel, on the view's grid.
    pub origin: Vec2,
    /// Pixels per texel.
    pub scale: f32,
    /// Size, texels.
    pub size: UVec2,
}

/// A visible sprite, in view space.
#[derive(Clone, Copy, Debug)]
pub struct ProjectedSprite {
    /// Metres.
    pub center: Vec3,
    /// Metres.
    pub radius: f32,
    /// Amount after opacity and near fade.
    pub amount: f32,
    /// Frames that are blended.
    pub frames: FlipbookFrames,
    /// Mip level.
    pub lod: f32,
    /// Side of its square, texels.
    pub diameter: f32,
    /// As in [`sprite_stretch`].
    pub stretch: Vec2,
}

/// Area that a sprite covers on a grid.
pub struct SpriteCoverage<'p> {
    /// Number of texels.
    pub texels: f64,
    /// Fraction of the sprite's square that is not trimmed; 1 for spheres.
    pub fraction: f64,
    /// The sprite in the view.
    pub sprite: ProjectedSprite,
    /// The particle that it shows.
    pub particle: &'p Particle,
}

/// Trimming of sprites to the filled part of their frames.
#[derive(Clone, Debug)]
pub struct SpriteTrim {
    animation: SpriteAnimation,
    alpha_bounds: Arc<AlphaBounds>,
    /// First frame whose filled part is used for trimming; `None` if sprites are not trimmed.
    first_frame: Option<i32>,
}

impl SpriteTrim {
    /// Returns the trimming for a material.
    pub fn new(settings: &Settings, material: &MaterialInfo) -> Self {
        let sprite = &settings.sprite;
        let first_frame = if settings.is_six_way() { material.frame_count as i32 } else { 0 };
        Self {
            animation: sprite.animation,
            alpha_bounds: material.alpha_bounds.clone(),
            first_frame: (!settings.debug.checkerboard && sprite.motion == 0.0).then_some(first_frame),
        }
    }

    /// Same as `trimmed_extent()` in the shader.
    fn trimmed_extent(&self, sprite: &ProjectedSprite) -> Vec4 {
        self.first_frame.map_or(Vec4::ONE, |first| {
            self.alpha_bounds.trimmed_extent(offset_frames(sprite.frames, first), sprite.lod)
        })
    }
}

/// Projects sprites into a view.
#[derive(Clone, Copy, Debug)]
pub struct SpriteProjector<'a> {
    /// Uniforms of the view.
    pub view: &'a ViewUniform,
    /// Uniforms of the system.
    pub system: &'a SystemUniform,
    /// Technique of the system.
    pub technique: Technique,
    /// Trimming of its sprites.
    pub trim: &'a SpriteTrim,
}

impl SpriteProjector<'_> {
    /// Same as `project_sprite()` in the shader; `None` if the sprite is hidden.
    pub fn project(&self, particle: &Particle, texels_per_pixel: f32) -> Option<ProjectedSprite> {
        let Self { view, system, technique, trim } = *self;
        let center = self.system.view_from_particles.transform_point3(particle.position);
        let mut radius = particle.radius * system.size;
        if technique == Technique::SphericalBillboard {
            radius *= system.billboard_radius;
        }
        let half_depth = self.sprite_thickness(radius);
        let front = -center.z - half_depth;
        let back = -center.z + half_depth;
        let fade = near_fade(back, system.near_fade_start, system.near_fade_end);
        let mut amount = particle.shown_amount() * system.opacity * fade;
        let is_seen = back > view.near && front < view.far && radius > 0.0 && amount > 0.0;
        if !is_seen {
            return None;
        }
        let depth = (-center.z).max(view.near);
        let pixels = pixels_per_metre(view.size.y, view.ray_scale.y, depth, view.orthographic);
        let mut stretch = Vec2::ZERO;
        if self.stretches() {
            let thin = self.stretch(particle, center, radius);
            let wide = radius.max(MIN_RADIUS / (pixels * texels_per_pixel));
            stretch = self.stretch(particle, center, wide);
            amount *= widened_fraction(radius, wide, thin, stretch);
            radius = wide;
        }
        let diameter = 2.0 * radius * pixels * texels_per_pixel;
        let frame = sprite_frame(trim.animation, particle.frame, particle.age, system.frame_count);
        Some(ProjectedSprite {
            center,
            radius,
            amount,
            frames: animation_frames(trim.animation, frame, system.frame_count),
            lod: sprite_lod(system.sprite_size, diameter),
            diameter,
            stretch,
        })
    }

    fn stretches(&self) -> bool {
        self.system.stretch > 0.0
    }

    /// Same as `stretch_of()` in the shader.
    fn stretch(&self, particle: &Particle, center: Vec3, radius: f32) -> Vec2 {
        let Self { view, system, .. } = *self;
        let velocity = match system.stretch_axis {
            Vec3::ZERO => system.view_from_particles.transform_vector3(particle.velocity),
            axis => view.view_from_world.transform_vector3(axis),
        };
        sprite_stretch(center, velocity, system.stretch, radius, system.stretch_limit, view.orthographic)
    }

    /// Returns the extent of a flat sprite from its center, as fractions of half a side: left, down, right, up.
    pub fn trimmed_extent(&self, sprite: &ProjectedSprite) -> Vec4 {
        self.trim.trimmed_extent(sprite)
    }

    /// Returns the extent of a sprite in front of its center and behind it, metres.
    pub fn sprite_thickness(&self, radius: f32) -> f32 {
        if self.technique.is_flat() { 0.0 } else { radius }
    }

    /// Returns the view depth at which the hardware tests a sprite. No part of the sprite is nearer.
    pub fn sprite_front(&self, sprite: &ProjectedSprite) -> f32 {
        (-sprite.center.z - self.sprite_thickness(sprite.radius)).max(self.view.near)
    }

    /// Returns the position at which a sprite is drawn: a slab whose center has passed the near plane is drawn on that
    /// plane.
    pub fn clamped_to_near_plane(&self, center: Vec3) -> Vec3 {
        center.with_z(center.z.min(-self.view.near))
    }

    /// Same as `sphere_corner()` in the shader: returns the upper left and the lower right corner, in pixels.
    pub fn sphere_rectangle(&self, sprite: &ProjectedSprite, texels_per_pixel: f32) -> (Vec2, Vec2) {
        let view = self.view;
        let ProjectedSprite { center, radius, .. } = *sprite;
        let rays = if view.orthographic > 0.5 {
            [center.xy() - radius, center.xy() + radius]
        } else {
            let bounds = |position| sphere_axis_bounds(Vec2::new(position, -center.z), radius, view.near);
            let x = bounds(center.x);
            let y = bounds(center.y);
            [Vec2::new(x.x, y.x), Vec2::new(x.y, y.y)]
        };
        let edge = 1.0 + (texels_per_pixel * view.size).recip();
        let [low, high] = rays.map(|ray| pixel_from_ndc(self.ndc(ray).clamp(-edge, edge), view.size));
        (low.min(high), low.max(high))
    }

    fn ndc(&self, ray: Vec2) -> Vec2 {
        (ray - self.view.ray_offset) / self.view.ray_scale
    }

    /// Returns the number of texels of a grid that the sprites cover, counted once per sprite, as if nothing of the
    /// scene were in front. Uses areas, which equal the mean number of covered texel centers over all positions of a
    /// sprite. Each of these texels is shaded once, unless a depth test rejects it first.
    pub fn fragments(&self, grid: &TexelGrid, particles: &[Particle]) -> f64 {
        self.coverages(grid, particles.iter()).map(|covered| covered.texels).sum()
    }

    /// Returns the coverage of each visible sprite.
    pub fn coverages<'p>(
        &self,
        grid: &TexelGrid,
        particles: impl Iterator<Item = &'p Particle>,
    ) -> impl Iterator<Item = SpriteCoverage<'p>> {
        let mut scratch = [Vec::with_capacity(8), Vec::with_capacity(8)];
        particles.filter_map(move |particle| {
            let sprite = self.project(particle, grid.scale.recip())?;
            let (corners, fraction) = if self.technique.is_sphere() {
                let (min, max) = self.sphere_rectangle(&sprite, grid.scale.recip());
                ([min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)], 1.0)
            } else {
                let reach = self.trimmed_extent(&sprite);
                let fraction = 0.25 * (reach.x + reach.z) * (reach.y + reach.w);
                (self.corners(&sprite, reach, particle.rotation), f64::from(fraction))
            };
            let texels = corners.map(|pixel| pixel / grid.scale - grid.origin);
            Some(SpriteCoverage {
                texels: area_within(texels, grid.size.as_vec2(), &mut scratch),
                fraction,
                sprite,
                particle,
            })
        })
    }

    /// Returns the corners of the trimmed square of a flat sprite, in pixels, in order around it.
    pub fn corners(&self, sprite: &ProjectedSprite, reach: Vec4, rotation: f32) -> [Vec2; 4] {
        let center = self.clamped_to_near_plane(sprite.center);
        let along = if self.view.orthographic > 0.5 { 1.0 } else { -center.z };
        let turn = Vec2::from_angle(rotation) * sprite.radius;
        [Vec2::new(1.0, 1.0), Vec2::new(-1.0, 1.0), Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0)].map(|corner| {
            let position = stretched(turn.rotate(trimmed_corner(corner, reach)), sprite.stretch);
            let ray = (center.xy() + position) / along;
            pixel_from_ndc(self.ndc(ray), self.view.size)
        })
    }
}

/// Returns the area of a convex polygon within 0..size. (Sutherland and Hodgman, 1974)
fn area_within(corners: [Vec2; 4], size: Vec2, scratch: &mut [Vec<DVec2>; 2]) -> f64 {
    let [polygon, clipped] = scratch;
    polygon.clear();
    // f64, because a sprite close to the eye may be far larger than the target.
    polygon.extend(corners.map(Vec2::as_dvec2));
    let size = size.as_dvec2();
    let min = corners.into_iter().fold(Vec2::INFINITY, Vec2::min).as_dvec2();
    let max = corners.into_iter().fold(Vec2::NEG_INFINITY, Vec2::max).as_dvec2();
    if min.cmpge(size).any() || max.cmple(DVec2::ZERO).any() {
        return 0.0;
    }
    if min.cmplt(DVec2::ZERO).any() || max.cmpgt(size).any() {
        for (normal, most) in [(-DVec2::X, 0.0), (DVec2::X, size.x), (-DVec2::Y, 0.0), (DVec2::Y, size.y)] {
            clipped.clear();
            for (&a, &b) in pairs(polygon) {
                let a_beyond = a.dot(normal) - most;
                let b_beyond = b.dot(normal) - most;
                if a_beyond <= 0.0 {
                    clipped.push(a);
                }
                if a_beyond * b_beyond < 0.0 {
                    clipped.push(a.lerp(b, a_beyond / (a_beyond - b_beyond)));
                }
            }
            std::mem::swap(polygon, clipped);
        }
    }
    0.5 * pairs(polygon).map(|(a, b)| a.perp_dot(*b)).sum::<f64>().abs()
}

/// Returns the sides of a polygon, as pairs of corners.
fn pairs(polygon: &[DVec2]) -> impl Iterator<Item = (&DVec2, &DVec2)> {
    polygon.iter().zip(polygon.iter().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_counts_only_the_part_on_the_target() {
        let square = |middle: Vec2, half: f32, angle: f32| {
            let side = Vec2::from_angle(angle) * half;
            [side + side.perp(), side.perp() - side, -side - side.perp(), side - side.perp()]
                .map(|corner| middle + corner)
        };
        let area = |corners| area_within(corners, Vec2::new(100.0, 60.0), &mut [Vec::new(), Vec::new()]);
        let diamond = std::f32::consts::FRAC_PI_4;
        let cases = [
            (square(Vec2::new(50.0, 30.0), 10.0, 0.3), 400.0),
            // Half of the square; a quarter of it; the whole target; nothing.
            (square(Vec2::new(0.0, 30.0), 10.0, 0.0), 200.0),
            (square(Vec2::new(100.0, 60.0), 10.0, diamond), 100.0),
            (square(Vec2::new(50.0, 30.0), 1.0e9, 0.7), 6000.0),
            (square(Vec2::new(-20.0, 30.0), 10.0, 0.0), 0.0),
            (square(Vec2::new(-12.0, -12.0), 10.0, diamond), 0.0),
        ];
        for (corners, expected) in cases {
            assert!((area(corners) - expected).abs() < 1.0e-3, "{corners:?}: {}", area(corners));
        }
    }
}
