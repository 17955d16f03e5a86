//! Where sprites stand in the view, as `shaders/lib/sprite_vertex.wgsl` places them, and how many fragments they make.

use std::sync::Arc;

use glam::{DVec2, UVec2, Vec2, Vec3, Vec3Swizzles, Vec4};

use crate::assets::material::MaterialInfo;
use crate::assets::sprite::filled::Filled;
use crate::formula::soft_fade::near_fade;
use crate::formula::sprite::{FlipbookFrames, frames_after, shown_frames, sprite_frame, sprite_lod, trimmed_corner};
use crate::formula::technique::sphere_axis_bounds;
use crate::formula::uniforms::{SystemUniform, ViewUniform};
use crate::formula::view::{pixel_from_ndc, pixels_per_metre};
use crate::frame::Particle;
use crate::settings::{Settings, SpriteAnimation, Technique};

/// The texels that sprites are drawn on: texel (i, j) is the pixels from (origin + (i, j)) · scale.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    pub origin: Vec2,
    pub scale: f32,
    pub size: UVec2,
}

/// A sprite that is not hidden, in view space.
#[derive(Clone, Copy, Debug)]
pub struct SpriteInView {
    pub centre: Vec3,
    pub radius: f32,
    /// After opacity and near fade.
    pub amount: f32,
    pub frames: FlipbookFrames,
    pub lod: f32,
}

/// What a sprite covers of a grid.
pub struct Covered<'p> {
    pub texels: f64,
    /// Of its square, what it reaches of it; 1 of spheres.
    pub share: f64,
    pub particle: &'p Particle,
}

/// What is known of sprites' pictures.
#[derive(Clone, Debug)]
pub struct Pictures {
    animation: SpriteAnimation,
    filled: Arc<Filled>,
    /// The first frame of those that show where there is anything; `None` where that is taken to be everywhere.
    first_frame: Option<i32>,
}

impl Pictures {
    pub fn new(settings: &Settings, material: &MaterialInfo) -> Self {
        let sprite = &settings.sprite;
        let first_frame = if settings.is_six_way() { material.frame_count as i32 } else { 0 };
        Self {
            animation: sprite.animation,
            filled: material.filled.clone(),
            first_frame: (!sprite.debug_sprite && sprite.motion == 0.0).then_some(first_frame),
        }
    }

    /// `sprite_reach()`.
    fn reach(&self, sprite: &SpriteInView) -> Vec4 {
        self.first_frame.map_or(Vec4::ONE, |first| self.filled.reach(frames_after(sprite.frames, first), sprite.lod))
    }
}

/// What places sprites.
#[derive(Clone, Copy, Debug)]
pub struct Placing<'a> {
    pub view: &'a ViewUniform,
    pub system: &'a SystemUniform,
    pub technique: Technique,
    pub pictures: &'a Pictures,
}

impl Placing<'_> {
    /// `placed_sprite()`; `None` when the sprite is hidden.
    pub fn sprite(&self, particle: &Particle, texels_per_pixel: f32) -> Option<SpriteInView> {
        let Self { view, system, technique, pictures } = *self;
        let centre = view.view_from_world.transform_point3(particle.position);
        let mut radius = particle.radius * system.size;
        if technique == Technique::SphericalBillboard {
            radius *= system.billboard_radius;
        }
        let half_depth = if technique.is_flat() { 0.0 } else { radius };
        let (front, back) = (-centre.z - half_depth, -centre.z + half_depth);
        let fade = near_fade(back, system.near_fade_start, system.near_fade_end);
        let amount = particle.shown_amount() * system.opacity * fade;
        let is_seen = back > view.near && front < view.far && radius > 0.0 && amount > 0.0;
        if !is_seen {
            return None;
        }
        let depth = (-centre.z).max(view.near);
        let pixels = pixels_per_metre(view.size.y, view.ray_scale.y, depth, view.orthographic);
        let diameter = 2.0 * radius * pixels * texels_per_pixel;
        let frame = sprite_frame(pictures.animation, particle.frame, particle.age, system.frame_count);
        Some(SpriteInView {
            centre,
            radius,
            amount,
            frames: shown_frames(pictures.animation, frame, system.frame_count),
            lod: sprite_lod(system.sprite_size, diameter),
        })
    }

    /// How far a flat sprite reaches from its middle, as a share of half a side: left, down, right, up.
    pub fn reach(&self, sprite: &SpriteInView) -> Vec4 {
        self.pictures.reach(sprite)
    }

    /// A slab whose middle has passed the near plane is drawn on that.
    pub fn on_screen(&self, centre: Vec3) -> Vec3 {
        centre.with_z(centre.z.min(-self.view.near))
    }

    /// `sphere_corner()`: upper left and lower right corner, in pixels.
    pub fn sphere_rectangle(&self, sprite: &SpriteInView, texels_per_pixel: f32) -> (Vec2, Vec2) {
        let (view, SpriteInView { centre, radius, .. }) = (self.view, *sprite);
        let rays = if view.orthographic > 0.5 {
            [centre.xy() - radius, centre.xy() + radius]
        } else {
            let bounds = |position| sphere_axis_bounds(Vec2::new(position, -centre.z), radius, view.near);
            let (x, y) = (bounds(centre.x), bounds(centre.y));
            [Vec2::new(x.x, y.x), Vec2::new(x.y, y.y)]
        };
        let edge = 1.0 + (texels_per_pixel * view.size).recip();
        let [low, high] = rays.map(|ray| pixel_from_ndc(self.ndc(ray).clamp(-edge, edge), view.size));
        (low.min(high), low.max(high))
    }

    fn ndc(&self, ray: Vec2) -> Vec2 {
        (ray - self.view.ray_offset) / self.view.ray_scale
    }

    /// How many texels of a grid the sprites cover, one above the other, as if nothing of the scene stood in front: their areas,
    /// which counts of texels' centres are in the mean over where a sprite may lie. Each of these is shaded once, but for those
    /// that a depth test rejects before.
    pub fn fragments(&self, grid: &Grid, particles: &[Particle]) -> f64 {
        self.covered(grid, particles.iter()).map(|covered| covered.texels).sum()
    }

    /// What each sprite covers that is seen.
    pub fn covered<'p>(
        &self,
        grid: &Grid,
        particles: impl Iterator<Item = &'p Particle>,
    ) -> impl Iterator<Item = Covered<'p>> {
        let mut scratch = [Vec::with_capacity(8), Vec::with_capacity(8)];
        particles.filter_map(move |particle| {
            let sprite = self.sprite(particle, grid.scale.recip())?;
            let (corners, share) = if self.technique.is_sphere() {
                let (min, max) = self.sphere_rectangle(&sprite, grid.scale.recip());
                ([min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)], 1.0)
            } else {
                let reach = self.reach(&sprite);
                let share = 0.25 * (reach.x + reach.z) * (reach.y + reach.w);
                (self.corners(&sprite, reach, particle.rotation), f64::from(share))
            };
            let texels = corners.map(|pixel| pixel / grid.scale - grid.origin);
            Some(Covered { texels: area_within(texels, grid.size.as_vec2(), &mut scratch), share, particle })
        })
    }

    /// Of what a flat sprite has of its square: in pixels, in order round it.
    fn corners(&self, sprite: &SpriteInView, reach: Vec4, rotation: f32) -> [Vec2; 4] {
        let centre = self.on_screen(sprite.centre);
        let along = if self.view.orthographic > 0.5 { 1.0 } else { -centre.z };
        let turn = Vec2::from_angle(rotation) * sprite.radius;
        [Vec2::new(1.0, 1.0), Vec2::new(-1.0, 1.0), Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0)].map(|corner| {
            let ray = (centre.xy() + turn.rotate(trimmed_corner(corner, reach))) / along;
            pixel_from_ndc(self.ndc(ray), self.view.size)
        })
    }
}

/// The area of a convex polygon within 0..size. (Sutherland and Hodgman, 1974)
fn area_within(corners: [Vec2; 4], size: Vec2, scratch: &mut [Vec<DVec2>; 2]) -> f64 {
    let [polygon, clipped] = scratch;
    polygon.clear();
    // A sprite close to the eye may be far larger than a target.
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
                let (a_beyond, b_beyond) = (a.dot(normal) - most, b.dot(normal) - most);
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

/// The sides of a polygon.
fn pairs(polygon: &[DVec2]) -> impl Iterator<Item = (&DVec2, &DVec2)> {
    polygon.iter().zip(polygon.iter().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_on_the_target_counts() {
        let square = |middle: Vec2, half: f32, angle: f32| {
            let side = Vec2::from_angle(angle) * half;
            [side + side.perp(), side.perp() - side, -side - side.perp(), side - side.perp()]
                .map(|corner| middle + corner)
        };
        let area = |corners| area_within(corners, Vec2::new(100.0, 60.0), &mut [Vec::new(), Vec::new()]);
        let diamond = std::f32::consts::FRAC_PI_4;
        let cases = [
            (square(Vec2::new(50.0, 30.0), 10.0, 0.3), 400.0),
            // Half, a quarter, all of the target, nothing of it.
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
