//! Lighting and materials of the demo scene on the CPU. `scene.wgsl` implements the same functions on the GPU.

use glam::{IVec3, Vec2, Vec3, Vec3Swizzles};
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::formula::lighting::sample_light;
use haze_core::formula::saturate;
use haze_core::formula::uniforms::LightUniform;

use super::boxes::{
    AMBIENT_REACH, LIGHT_GAP, SUN_DISTANCE, SUN_SPREAD, SceneBox, Surface, WIDEST_PIXEL, box_distance, box_interval,
};
use super::occluders::{BoxMask, indices};
use super::scene::Scene;

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

/// Returns 0..1.
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

/// Returns 0 on a joint between tiles of `size`, 1 on a tile.
fn joints(uv: Vec2, size: Vec2, width: f32) -> f32 {
    let position = uv / size;
    let from_edge = (0.5 - (position - position.floor() - 0.5).abs()) * size;
    smoothstep(0.0, width, from_edge.min_element())
}

/// Returns the reflectance at a point of a box, or its radiance if it is emissive. `p` and `n` are in the box's frame;
/// `world` makes stains differ between boxes.
pub(crate) fn albedo(b: &SceneBox, p: Vec3, n: Vec3, world: Vec3) -> Vec3 {
    let uv = if n.x.abs() > 0.5 {
        p.zy()
    } else if n.y.abs() > 0.5 {
        p.xz()
    } else {
        p.xy()
    };
    let is = |surface: Surface| b.surface == surface as u32;
    if is(Surface::Glow) || is(Surface::Even) {
        return b.color;
    }
    let dirt = stains(world);
    if is(Surface::Slabs) {
        let size = Vec2::splat(1.6);
        let tile = (uv / size).floor().as_ivec2();
        let tone = 0.85 + 0.3 * hash(tile.extend(5));
        return b.color * tone * (0.55 + 0.7 * dirt) * mix(0.45, 1.0, joints(uv, size, 0.035));
    }
    if is(Surface::Brick) {
        let size = Vec2::new(0.48, 0.17);
        let row = (uv.y / size.y).floor();
        let shifted = Vec2::new(uv.x + row * 0.5 * size.x, uv.y);
        let tile = (shifted / size).floor().extend(n.x * 3.0 + n.z).as_ivec3();
        let tone = 0.7 + 0.6 * hash(tile);
        let tint = Vec3::ONE.lerp(Vec3::new(1.15, 0.92, 0.8), hash(tile.wrapping_add(IVec3::new(7, 3, 1))));
        let brick = b.color * tone * tint * (0.6 + 0.6 * dirt);
        let mortar = Vec3::new(0.16, 0.155, 0.15) * (0.6 + 0.6 * dirt);
        return mortar.lerp(brick, joints(shifted, size, 0.02));
    }
    if is(Surface::Wood) {
        let plank = (uv.y / 0.2).floor();
        let grain = value_noise(Vec3::new(uv.x * 2.0, uv.y * 40.0, plank * 7.0 + b.center.x * 3.0));
        let salt = IVec3::new(plank as i32, (b.center.x * 10.0) as i32, (b.center.z * 10.0) as i32);
        let tone = 0.8 + 0.4 * hash(salt);
        let edge = Vec3::select(n.abs().cmpgt(Vec3::splat(0.5)), Vec3::splat(10.0), b.half_size - p.abs());
        let framed = smoothstep(0.09, 0.075, edge.min_element());
        let boards = tone * mix(0.5, 1.0, joints(Vec2::new(25.0, uv.y), Vec2::new(50.0, 0.2), 0.015));
        return b.color * mix(boards, 1.15, framed) * (0.7 + 0.4 * grain) * (0.75 + 0.4 * dirt);
    }
    if is(Surface::Plaster) {
        let damp = smoothstep(0.0, 1.2, world.y + dirt * 0.8 - 0.3);
        return b.color * (0.6 + 0.55 * dirt) * mix(0.6, 1.0, damp);
    }
    b.color * (0.8 + 0.4 * dirt)
}

/// Light at a point, without and with the shadow of the smoke.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lit {
    pub full: Vec3,
    pub shaded: Vec3,
}

impl Lit {
    /// Light that no smoke shades.
    pub fn even(light: Vec3) -> Self {
        Self { full: light, shaded: light }
    }
}

/// Ray from a point to a light.
struct ShadowRay {
    origin: Vec3,
    direction: Vec3,
    distance: f32,
    /// Angular size of the light: radius / distance.
    spread: f32,
}

impl Scene {
    /// Returns the visible fraction of a light, 0 to 1. `pixel` is the minimum width of the penumbra, metres.
    fn light_visibility(&self, boxes: BoxMask, ray: &ShadowRay, pixel: f32) -> f32 {
        let &ShadowRay { origin, direction, distance, spread } = ray;
        let mut visible = 1.0_f32;
        for b in indices(boxes, self.boxes.len()).map(|index| &self.boxes[index]) {
            if b.surface == Surface::Glow as u32 {
                continue;
            }
            let o = b.to_local(origin - b.center);
            let d = b.to_local(direction);
            let (enter, leave) = box_interval(b, o, d);
            if enter < leave {
                if leave > 0.0 && enter < distance {
                    return 0.0;
                }
                continue;
            }
            // Approximates the closest approach by the two ends of this interval. Ends behind the origin do not count.
            for position in [enter.min(distance), leave.min(distance)].into_iter().filter(|&position| position > 0.0) {
                visible = visible.min(box_distance(b, o + d * position) / (position * spread).max(pixel));
            }
        }
        smoothstep(0.0, 1.0, visible)
    }

    /// Returns the unoccluded fraction of the sky over a point.
    fn ambient_visibility(&self, p: Vec3, n: Vec3) -> f32 {
        let near = p + n * 0.15;
        let far = p + n * AMBIENT_REACH;
        let mut open_near = 0.15_f32;
        let mut open_far = AMBIENT_REACH;
        for b in indices(self.occluders.at(0, p), self.boxes.len()).map(|index| &self.boxes[index]) {
            open_near = open_near.min(box_distance(b, b.to_local(near - b.center)));
            open_far = open_far.min(box_distance(b, b.to_local(far - b.center)));
        }
        mix(0.25, 1.0, saturate(open_near / 0.15)) * mix(0.35, 1.0, saturate(open_far / AMBIENT_REACH))
    }

    /// Returns the light at a point of a box. `pixel` is the width of a pixel there, metres. `through`: fraction of each light
    /// that comes through the smoke.
    pub fn irradiance(&self, world: Vec3, normal: Vec3, pixel: f32, through: &impl Fn(u32) -> Vec3) -> Lit {
        let unshaded = Lit::even(self.ambient_light(normal) * self.ambient_visibility(world, normal));
        (0..).zip(&self.lights).fold(unshaded, |lit, (index, light)| {
            let direct = self.direct(index, light, world, normal, pixel);
            Lit { full: lit.full + direct, shaded: lit.shaded + direct * through(index) }
        })
    }

    fn direct(&self, index: u32, light: &LightUniform, world: Vec3, normal: Vec3, pixel: f32) -> Vec3 {
        let sample = sample_light(light, world);
        let facing = normal.dot(sample.direction);
        if facing <= 0.0 || sample.attenuation <= 0.0 {
            return Vec3::ZERO;
        }
        let (distance, spread) = if light.directional > 0.5 {
            (SUN_DISTANCE, SUN_SPREAD)
        } else {
            let distance = (light.position - world).length();
            (distance - LIGHT_GAP, light.radius / distance.max(0.1))
        };
        let boxes = self.occluders.at(1 + index, world);
        let ray = ShadowRay { origin: world + normal * 2.0e-3, direction: sample.direction, distance, spread };
        let visible = self.light_visibility(boxes, &ray, pixel.min(WIDEST_PIXEL));
        light.color * (facing * sample.attenuation * visible)
    }
}
