//! The light and the materials of the demo scene on the CPU. `scene.wgsl` is the same on the GPU, function by function.

use glam::{IVec3, Vec2, Vec3, Vec3Swizzles};

use super::layout::{SceneBox, Surface};
use super::scene::Scene;
use crate::assets::noise::{pcg3d, unit};
use crate::formula::lighting::sample_light;
use crate::formula::saturate;
use crate::formula::uniforms::LightUniform;

fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = saturate((x - low) / (high - low));
    t * t * (3.0 - 2.0 * t)
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

fn hash(at: IVec3) -> f32 {
    unit(pcg3d(at.as_uvec3()).x)
}

/// 0..1.
fn value_noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let w = f * f * (3.0 - 2.0 * f);
    let i = cell.as_ivec3();
    let corner = |x, y, z| hash(i.wrapping_add(IVec3::new(x, y, z)));
    let plane = |z| mix(mix(corner(0, 0, z), corner(1, 0, z), w.x), mix(corner(0, 1, z), corner(1, 1, z), w.x), w.y);
    mix(plane(0), plane(1), w.z)
}

fn stains(p: Vec3) -> f32 {
    value_noise(p * 0.7) * 0.5 + value_noise(p * 2.3) * 0.3 + value_noise(p * 9.1) * 0.2
}

/// 0 on a joint between tiles of `size`, 1 on a tile.
fn joints(uv: Vec2, size: Vec2, width: f32) -> f32 {
    let place = uv / size;
    let from_edge = (0.5 - (place - place.floor() - 0.5).abs()) * size;
    smoothstep(0.0, width, from_edge.min_element())
}

/// Reflectance of a point of a box. `p` and `n` are in the box's frame, `world` tells boxes apart.
fn albedo(b: &SceneBox, p: Vec3, n: Vec3, world: Vec3) -> Vec3 {
    let uv = if n.x.abs() > 0.5 {
        p.zy()
    } else if n.y.abs() > 0.5 {
        p.xz()
    } else {
        p.xy()
    };
    let dirt = stains(world);
    let is = |surface: Surface| b.surface == surface as u32;
    if is(Surface::Slabs) {
        let size = Vec2::splat(1.6);
        let tile = (uv / size).floor().as_ivec2();
        let tone = 0.85 + 0.3 * hash(tile.extend(5));
        return b.colour * tone * (0.55 + 0.7 * dirt) * mix(0.45, 1.0, joints(uv, size, 0.035));
    }
    if is(Surface::Brick) {
        let size = Vec2::new(0.48, 0.17);
        let row = (uv.y / size.y).floor();
        let shifted = Vec2::new(uv.x + row * 0.5 * size.x, uv.y);
        let tile = (shifted / size).floor().extend(n.x * 3.0 + n.z).as_ivec3();
        let tone = 0.7 + 0.6 * hash(tile);
        let tint = Vec3::ONE.lerp(Vec3::new(1.15, 0.92, 0.8), hash(tile.wrapping_add(IVec3::new(7, 3, 1))));
        let brick = b.colour * tone * tint * (0.6 + 0.6 * dirt);
        let mortar = Vec3::new(0.16, 0.155, 0.15) * (0.6 + 0.6 * dirt);
        return mortar.lerp(brick, joints(shifted, size, 0.02));
    }
    if is(Surface::Wood) {
        let plank = (uv.y / 0.2).floor();
        let grain = value_noise(Vec3::new(uv.x * 2.0, uv.y * 40.0, plank * 7.0 + b.centre.x * 3.0));
        let salt = IVec3::new(plank as i32, (b.centre.x * 10.0) as i32, (b.centre.z * 10.0) as i32);
        let tone = 0.8 + 0.4 * hash(salt);
        let edge = Vec3::select(n.abs().cmpgt(Vec3::splat(0.5)), Vec3::splat(10.0), b.half_size - p.abs());
        let framed = smoothstep(0.09, 0.075, edge.min_element());
        let boards = tone * mix(0.5, 1.0, joints(Vec2::new(25.0, uv.y), Vec2::new(50.0, 0.2), 0.015));
        return b.colour * mix(boards, 1.15, framed) * (0.7 + 0.4 * grain) * (0.75 + 0.4 * dirt);
    }
    if is(Surface::Plaster) {
        let damp = smoothstep(0.0, 1.2, world.y + dirt * 0.8 - 0.3);
        return b.colour * (0.6 + 0.55 * dirt) * mix(0.6, 1.0, damp);
    }
    b.colour * (0.8 + 0.4 * dirt)
}

/// Distances along a ray at which it enters and leaves a box, in the box's frame.
pub(crate) fn box_interval(b: &SceneBox, origin: Vec3, direction: Vec3) -> (f32, f32) {
    let tiny = Vec3::splat(1.0e-6);
    let inverse = Vec3::select(direction.abs().cmplt(tiny), tiny, direction).recip();
    let middle = -origin * inverse;
    let reach = inverse.abs() * b.half_size;
    ((middle - reach).max_element(), (middle + reach).min_element())
}

fn box_distance(b: &SceneBox, p: Vec3) -> f32 {
    let q = p.abs() - b.half_size;
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
}

impl Scene {
    /// How much of a light of angular size `spread` (radius / distance) is seen past the boxes.
    fn light_visibility(&self, origin: Vec3, direction: Vec3, distance: f32, spread: f32) -> f32 {
        let mut visible = 1.0_f32;
        for b in &self.boxes {
            if b.surface == Surface::Glow as u32 {
                continue;
            }
            let (o, d) = (b.to_local(origin - b.centre), b.to_local(direction));
            let (enter, leave) = box_interval(b, o, d);
            if enter < leave {
                if leave > 0.0 && enter < distance {
                    return 0.0;
                }
                continue;
            }
            let nearest = (0.5 * (enter + leave)).clamp(0.0, distance);
            if nearest > 0.0 {
                visible = visible.min(box_distance(b, o + d * nearest) / (nearest * spread));
            }
        }
        smoothstep(0.0, 1.0, visible)
    }

    /// Share of the sky that the boxes leave open over a point.
    fn ambient_visibility(&self, p: Vec3, n: Vec3) -> f32 {
        let (near, far) = (p + n * 0.15, p + n * 0.7);
        let (mut open_near, mut open_far) = (0.15_f32, 0.7_f32);
        for b in &self.boxes {
            open_near = open_near.min(box_distance(b, b.to_local(near - b.centre)));
            open_far = open_far.min(box_distance(b, b.to_local(far - b.centre)));
        }
        mix(0.25, 1.0, saturate(open_near / 0.15)) * mix(0.35, 1.0, saturate(open_far / 0.7))
    }

    /// Radiance of the sky in a direction.
    pub fn sky(&self, direction: Vec3) -> Vec3 {
        let up = saturate(direction.y);
        self.environment.horizon.lerp(self.environment.zenith, 1.0 - (1.0 - up).powi(3))
    }

    /// Radiance of a point of a box.
    pub fn shade(&self, b: &SceneBox, world: Vec3, local: Vec3, local_normal: Vec3) -> Vec3 {
        if b.surface == Surface::Glow as u32 {
            return b.colour;
        }
        let normal = b.to_world(local_normal);
        let reflectance = albedo(b, local, local_normal, world);
        let sky = self.environment.horizon.lerp(self.environment.zenith, 0.5);
        let ambient = self.environment.ground.lerp(sky, normal.y * 0.5 + 0.5);
        let origin = world + normal * 2.0e-3;
        let direct = self.lights.iter().map(|light| self.direct(light, world, origin, normal)).sum::<Vec3>();
        reflectance * (ambient * self.ambient_visibility(world, normal) + direct)
    }

    fn direct(&self, light: &LightUniform, world: Vec3, origin: Vec3, normal: Vec3) -> Vec3 {
        let sample = sample_light(light, world);
        let facing = normal.dot(sample.direction);
        if facing <= 0.0 || sample.attenuation <= 0.0 {
            return Vec3::ZERO;
        }
        let (distance, spread) = if light.directional > 0.5 {
            (60.0, 0.02)
        } else {
            let distance = (light.position - world).length();
            (distance, light.radius / distance.max(0.1))
        };
        let visible = self.light_visibility(origin, sample.direction, distance, spread);
        light.colour * (facing * sample.attenuation * visible)
    }
}
