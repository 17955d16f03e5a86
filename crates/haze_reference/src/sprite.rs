//! Sprites, fragment by fragment. WGSL: `shaders/lib/sprite_vertex.wgsl` and `shaders/lib/sprite_fragment.wgsl`.

use glam::{IVec2, Mat3, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};
use haze_core::formula::depth_moments::depth_moments;
use haze_core::formula::fire::heat_at;
use haze_core::formula::grain::{eroded, sample_grain, tilted_normal};
use haze_core::formula::lighting::painted_fraction;
use haze_core::formula::noise_volume::{noise_coordinate, sample_noise_octaves};
use haze_core::formula::normal::rotate_normal;
use haze_core::formula::order::{optical_depth_in_front, order_weight};
use haze_core::formula::shadow::{foreign_optical_depths, own_optical_depth};
use haze_core::formula::six_way::{SixWay, rotate_six_way, six_way_from_texel, tilted_six_way};
use haze_core::formula::soft_fade::soft_fade;
use haze_core::formula::sprite::{
    FlipbookFrames, checkerboard, offset_frames, sample_detail, sample_flipbook, sample_sprite, sprite_uv,
    trimmed_corner, unrotate,
};
use haze_core::formula::stretch::{stretched_normal, unstretched};
use haze_core::formula::technique::{
    RayInterval, density_amount, density_thickness, depth_sprite_depth, hard_fade, march_boundary, ray_sphere,
    spherical_billboard_amount, visible_slab_fraction, volumetric_density, volumetric_falloff, volumetric_normal,
};
use haze_core::frame::Particle;
use haze_core::settings::{BlendOrder, Technique, Volumetric};
use haze_core::view_setup::{
    ProjectedSprite, SpriteProjector, TexelGrid, density_radius, erosion_of, sprite_optical_depth,
};

use super::visible_system::VisibleSystem;

/// Sprite in view space.
pub struct SpriteSetup {
    /// Center, metres.
    pub center: Vec3,
    /// View depth of the center, metres.
    pub view_depth: f32,
    /// Half the side of a square, or the radius of a sphere, metres.
    pub radius: f32,
    /// Cosine and sine of the rotation.
    pub rotation: Vec2,
    /// As in [`sprite_stretch`](haze_core::formula::stretch::sprite_stretch).
    pub stretch: Vec2,
    /// Amount after near fade and opacity.
    pub amount: f32,
    /// Mip level.
    pub lod: f32,
    /// Frames shown.
    pub frames: FlipbookFrames,
    /// Squares only: extent from the center to the left, bottom, right and top, as fractions of half a side.
    pub reach: Vec4,
    /// Fraction of the particle's life that has passed.
    pub age: f32,
    /// Erosion by the grain.
    pub erosion: f32,
    /// Texels of the grain's first octave per texel of the target.
    pub fineness: f32,
    /// Optical depths of the smoke in front of the sprite, towards the lights with shadow.
    pub optical_depths: Vec3,
    /// Heat, 0 to 1.
    pub heat: f32,
    /// Color by which the light on it is multiplied.
    pub tint: Vec3,
    /// Weight of the normal under the order `weighted`.
    pub weight: f32,
    /// Upper left corner of the pixels that the sprite can cover.
    pub min: Vec2,
    /// Lower right corner of the pixels that the sprite can cover.
    pub max: Vec2,
}

/// Values of a sprite at a texel.
#[derive(Clone, Copy)]
pub struct SpriteFragment {
    /// View space, about unit length.
    pub normal: Vec3,
    /// View space, for sprites lit by six-way maps.
    pub six_way: SixWay,
    /// 0 to 1.
    pub amount: f32,
    /// Amount of the sprite's image, before that of the particle.
    pub thickness: f32,
}

impl VisibleSystem<'_> {
    /// Calls `f(texel position, sprite, fragment, texel)` for every fragment of every sprite in a band of rows, in
    /// order. `scene` returns the scene's view depth at a texel.
    pub fn for_fragments<T>(
        &self,
        grid: &TexelGrid,
        first_row: u32,
        band: &mut [T],
        scene: impl Fn(IVec2) -> f32,
        f: impl Fn(IVec2, &SpriteSetup, SpriteFragment, &mut T),
    ) {
        let width = grid.size.x as i32;
        let rows = band.len() as i32 / width;
        let top = first_row as i32;
        let bottom = first_row as i32 + rows;
        let loops = 0..self.settings.debug.draw_count;
        for particle in loops.flat_map(|_| &self.particles) {
            let Some(sprite) = self.sprite_setup(particle, 1.0 / grid.scale) else { continue };
            let texel = |pixel: Vec2| pixel / grid.scale - grid.origin;
            let min = texel(sprite.min).floor().as_ivec2().max(IVec2::new(0, top));
            let max = texel(sprite.max).ceil().as_ivec2().min(IVec2::new(width, bottom));
            for y in min.y..max.y {
                for x in min.x..max.x {
                    let at = IVec2::new(x, y);
                    let pixel = (at.as_vec2() + 0.5 + grid.origin) * grid.scale;
                    if let Some(fragment) = self.technique_fragment(&sprite, pixel, scene(at)) {
                        f(at, &sprite, fragment, &mut band[((y - top) * width + x) as usize]);
                    }
                }
            }
        }
    }

    /// `sprite_vertex()`; `None` if the sprite is hidden.
    pub fn sprite_setup(&self, particle: &Particle, texels_per_pixel: f32) -> Option<SpriteSetup> {
        let technique = self.settings.technique;
        let projector = self.projector();
        let sprite = projector.project(particle, texels_per_pixel)?;
        let ProjectedSprite { center, radius, amount, frames, lod, stretch, .. } = sprite;
        let view_depth = -center.z;
        let (min, max) = if technique.is_sphere() {
            projector.sphere_rectangle(&sprite, texels_per_pixel)
        } else {
            self.square_rectangle(projector.clamped_to_near_plane(center), radius, stretch)
        };
        Some(SpriteSetup {
            center,
            view_depth,
            radius,
            rotation: Vec2::new(particle.rotation.cos(), particle.rotation.sin()),
            stretch,
            amount,
            lod,
            frames,
            reach: projector.trimmed_extent(&sprite),
            age: particle.age,
            erosion: erosion_of(&self.system, particle),
            fineness: self.fineness_of(radius, view_depth, texels_per_pixel),
            optical_depths: self.optical_depths_of(particle, center),
            heat: self.heat_of(particle),
            tint: self.tint_of(particle),
            weight: self.order_weight(view_depth),
            min,
            max,
        })
    }

    /// Optical depths of the smoke in front of a particle's sprite, towards the lights with shadow. `center`: view space.
    fn optical_depths_of(&self, particle: &Particle, center: Vec3) -> Vec3 {
        let system = &self.system;
        let Some(depths) = self.optical_depths.as_ref().filter(|_| system.shadow_strength > 0.0) else {
            return Vec3::ZERO;
        };
        let own = own_optical_depth(density_radius(system, particle), sprite_optical_depth(system, particle));
        foreign_optical_depths(depths.sample(0, system.grid_from_view.transform_point3(center)), own)
    }

    /// Texels of the grain's first octave per texel of the target, on a sprite of this radius.
    pub fn fineness_of(&self, radius: f32, view_depth: f32, texels_per_pixel: f32) -> f32 {
        let distance = if self.view.orthographic > 0.5 { 1.0 } else { view_depth.max(self.view.near) };
        self.system.grain_fineness * distance / (texels_per_pixel * radius)
    }

    /// Heat of a particle.
    pub fn heat_of(&self, particle: &Particle) -> f32 {
        let by_age = |ramp| painted_fraction(self.sample_ramp(ramp, particle.age));
        match self.settings.burns() {
            true => by_age(&self.material.heat_ramp) * (f32::from(particle.heat) / 255.0),
            false => 0.0,
        }
    }

    /// Color of a particle.
    pub fn tint_of(&self, particle: &Particle) -> Vec3 {
        if !self.settings.is_tinted() {
            return Vec3::ONE;
        }
        let by_age = self.sample_ramp(&self.material.age_ramp, particle.age);
        let own = Vec3::from(particle.tint.map(|channel| f32::from(channel) / 255.0));
        Vec3::ONE.lerp(by_age, self.system.age_color) * Vec3::ONE.lerp(own, self.system.tint)
    }

    /// Heat of a fragment of a sprite with this heat.
    pub fn fragment_heat(&self, fragment: &SpriteFragment, heat: f32) -> f32 {
        let system = &self.system;
        heat_at(heat, fragment.thickness, fragment.normal.z, system.fire_core, system.fire_crust)
    }

    /// `depth_moments()` of a sprite.
    pub fn moments_of_sprite(&self, view_depth: f32, radius: f32) -> Vec2 {
        let system = &self.system;
        depth_moments(view_depth, radius * system.density_reach, system.smoke_near, system.smoke_far)
    }

    fn order_weight(&self, view_depth: f32) -> f32 {
        let system = &self.system;
        match self.settings.order() {
            BlendOrder::Sorted => 1.0,
            BlendOrder::Weighted => {
                let near = system.smoke_near;
                let far = system.smoke_far;
                let in_front = optical_depth_in_front(&system.optical_depth_knots, view_depth, near, far);
                order_weight(system.depth_weight, in_front)
            }
        }
    }

    /// Projector of the system's sprites.
    pub fn projector(&self) -> SpriteProjector<'_> {
        SpriteProjector { view: &self.view, system: &self.system, technique: self.settings.technique, trim: &self.trim }
    }

    fn square_rectangle(&self, center: Vec3, radius: f32, stretch: Vec2) -> (Vec2, Vec2) {
        // Half the diagonal contains the sprite at every rotation.
        let ratio = 1.0 / (1.0 - stretch.length_squared()).max(1.0e-4);
        let reach = Vec3::new(1.0, 1.0, 0.0) * (radius * std::f32::consts::SQRT_2 * ratio);
        let a = self.pixel_from_view(center - reach);
        let b = self.pixel_from_view(center + reach);
        (a.min(b), a.max(b))
    }

    /// Values of a sprite at a pixel in front of a scene of this view depth; `None` if it is hidden.
    pub fn technique_fragment(&self, sprite: &SpriteSetup, pixel: Vec2, scene: f32) -> Option<SpriteFragment> {
        let system = &self.system;
        let technique = self.settings.technique;
        if technique.is_sphere() {
            return self.sphere_fragment(sprite, pixel, scene);
        }
        let drawn = self.projector().clamped_to_near_plane(sprite.center);
        let offset = self.view_position(pixel, -drawn.z) - drawn;
        let local = unrotate(unstretched(offset.xy(), sprite.stretch), sprite.rotation) / sprite.radius;
        let low = trimmed_corner(Vec2::NEG_ONE, sprite.reach);
        let high = trimmed_corner(Vec2::ONE, sprite.reach);
        if local.cmplt(low).any() || local.cmpgt(high).any() {
            return None;
        }
        let uv = sprite_uv(local);
        let detail = self.detail(sprite, uv);
        let motion = detail.yz() * system.motion;
        let thickness = density_thickness(sprite.view_depth, sprite.radius, self.view.near, scene);
        let fade = match technique {
            Technique::Hard => hard_fade(scene - sprite.view_depth),
            Technique::DepthSpriteHard => {
                hard_fade(scene - depth_sprite_depth(sprite.view_depth, detail.x, sprite.radius))
            }
            Technique::DepthSpriteSoft => {
                self.fade_before(scene, depth_sprite_depth(sprite.view_depth, detail.x, sprite.radius))
            }
            // Hidden if nothing is left of the slab.
            Technique::Density => thickness,
            _ => self.fade_before(scene, sprite.view_depth),
        };
        if fade <= 0.0 {
            return None;
        }
        let texel = self.sprite_texel(sprite, uv, motion);
        let amount = match technique {
            Technique::Density => density_amount(system.density * texel.amount * sprite.amount, thickness),
            _ if technique.is_depth_sprite() => {
                texel.amount
                    * sprite.amount
                    * fade
                    * visible_slab_fraction(sprite.view_depth, sprite.radius, self.view.near)
            }
            _ => texel.amount * sprite.amount * fade,
        };
        Some(SpriteFragment { amount, ..texel })
    }

    /// Soft fade of a point in front of the scene.
    pub fn fade_before(&self, scene: f32, view_depth: f32) -> f32 {
        let system = &self.system;
        let curve = self.settings.soft_fade.curve;
        soft_fade(curve, scene - view_depth, system.fade_scale, system.contrast_power, system.epsilon)
    }

    /// Detail map, if a technique or setting reads it.
    fn detail(&self, sprite: &SpriteSetup, uv: Vec2) -> Vec3 {
        let is_read = self.settings.technique.is_depth_sprite() || self.system.motion > 0.0;
        match &self.material.detail {
            Some(detail) if is_read => {
                sample_detail(detail, uv, sprite.frames, (sprite.lod - self.system.detail_lod).max(0.0))
            }
            _ => Vec3::ZERO,
        }
    }

    /// Grain at a position on a sprite: see [`sample_grain`].
    pub fn grain_of(&self, sprite: &SpriteSetup, uv: Vec2) -> Vec3 {
        let system = &self.system;
        let frames = sprite.frames;
        let phase = (frames.first as f32 + frames.blend) / system.frame_count;
        let octaves = self.settings.grain_octaves();
        sample_grain(&self.material.noise, uv, phase, system.grain_tiles, sprite.fineness, octaves)
    }

    /// Values of the sprite's image at a position, rotated with the sprite.
    pub fn sprite_texel(&self, sprite: &SpriteSetup, uv: Vec2, motion: Vec2) -> SpriteFragment {
        if self.settings.grain_octaves() == 0 {
            return self.clean_texel(sprite, uv, motion, Vec2::ZERO);
        }
        let grain = self.grain_of(sprite, uv);
        let texel = self.clean_texel(sprite, uv, motion, grain.xy() * self.system.grain_bump);
        let amount = eroded(texel.amount, grain.z, sprite.erosion);
        SpriteFragment { amount, thickness: amount, ..texel }
    }

    /// The same without erosion. `tilt`: of the normals, by the grain.
    fn clean_texel(&self, sprite: &SpriteSetup, uv: Vec2, motion: Vec2, tilt: Vec2) -> SpriteFragment {
        let SpriteSetup { frames, lod, rotation, .. } = *sprite;
        if let Some(maps) = self.material.six_way.as_ref().filter(|_| self.settings.is_six_way()) {
            let negative = offset_frames(frames, self.system.frame_count as i32);
            let [positive, negative] = [frames, negative].map(|frames| sample_flipbook(maps, uv, frames, motion, lod));
            let [of_positive, of_negative] = [positive, negative].map(|texel| six_way_from_texel(texel.xyz()));
            let tilted = tilted_six_way(SixWay { positive: of_positive, negative: of_negative }, tilt);
            let six_way = rotate_six_way(tilted.positive, tilted.negative, rotation);
            return SpriteFragment { normal: Vec3::Z, six_way, amount: positive.w, thickness: positive.w };
        }
        let texel = if self.settings.debug.checkerboard {
            checkerboard(uv)
        } else {
            sample_sprite(&self.material.sprite, uv, frames, motion, lod)
        };
        SpriteFragment {
            normal: stretched_normal(rotate_normal(tilted_normal(texel.xyz(), tilt), rotation), sprite.stretch),
            six_way: SixWay::default(),
            amount: texel.w,
            thickness: texel.w,
        }
    }

    /// Values of a spherical sprite at a pixel; `None` if it is hidden.
    pub fn sphere_fragment(&self, sprite: &SpriteSetup, pixel: Vec2, scene: f32) -> Option<SpriteFragment> {
        let system = &self.system;
        let ray = self.view_position(pixel, 1.0);
        let (origin, along) =
            if self.view.orthographic > 0.5 { (ray.with_z(0.0), Vec3::NEG_Z) } else { (Vec3::ZERO, ray.normalize()) };
        let per_depth = -1.0 / along.z;
        let end = (scene + system.show_through_distance) * per_depth;
        let interval = ray_sphere(origin, along, sprite.center, sprite.radius, self.view.near * per_depth, end);
        let stretch = interval.leave - interval.enter;
        if stretch <= 0.0 || interval.axis.length_squared() >= sprite.radius * sprite.radius {
            return None;
        }
        if self.settings.technique.is_volumetric() {
            return Some(self.volumetric_fragment(sprite, scene, origin, along, interval));
        }
        let uv = sprite_uv(unrotate(interval.axis.xy(), sprite.rotation) / sprite.radius);
        let texel = self.sprite_texel(sprite, uv, self.detail(sprite, uv).yz() * system.motion);
        let density = system.billboard_density * texel.amount * sprite.amount;
        let amount = spherical_billboard_amount(density, interval.axis.length(), sprite.radius, stretch);
        Some(SpriteFragment { amount, ..texel })
    }

    /// Values of a volumetric sprite along a ray.
    pub fn volumetric_fragment(
        &self,
        sprite: &SpriteSetup,
        scene: f32,
        origin: Vec3,
        along: Vec3,
        interval: RayInterval,
    ) -> SpriteFragment {
        let system = &self.system;
        let Volumetric { march_steps, noise_octaves, .. } = self.settings.volumetric;
        let rotation = Mat3::from_mat4(self.view.view_from_world);
        let span = interval.leave - interval.enter;
        let opacity = system.volume_opacity * sprite.amount * span;
        let mut normal = Vec3::ZERO;
        let mut transmittance = 1.0;
        for i in 0..march_steps {
            let [begin, end] = [i, i + 1].map(|step| march_boundary(step as f32 / march_steps as f32));
            let position = origin + along * (interval.enter + 0.5 * (begin + end) * span);
            let local = (position - sprite.center) / sprite.radius;
            let from_eye = rotation.transpose() * position;
            let coordinate = noise_coordinate(from_eye, system.noise_size, system.noise_offset);
            let texel = sample_noise_octaves(&self.material.noise, coordinate, noise_octaves);
            let density = volumetric_density(texel.w, volumetric_falloff(local));
            let mut amount = density_amount(opacity * (end - begin), density);
            if self.settings.technique == Technique::VolumetricSoft {
                amount *= self.fade_before(scene, -position.z);
            }
            normal += volumetric_normal(local, rotation * texel.xyz()) * (amount * transmittance);
            transmittance *= 1.0 - amount;
        }
        let total = 1.0 - transmittance;
        SpriteFragment {
            normal: normal / total.max(1.0e-6),
            six_way: SixWay::default(),
            amount: total,
            thickness: total,
        }
    }
}
