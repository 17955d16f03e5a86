//! Version 2: a box of voxels a quarter as deep as wide. What all frames share is worked out once, and what varies slowly on a
//! coarse grid; plain arithmetic, so that every machine bakes the same bytes.

use std::ops::Range;

use glam::{IVec2, UVec2, UVec3, Vec2, Vec3};
use image::Rgba;

use super::cluster::{Ball, balls};
use super::frame::{BakedFrame, Ray};
use super::recipe::SpriteRecipe;
use crate::assets::exact::direction;
use crate::assets::noise::{NoiseCell, curl_noise};
use crate::assets::picture::Picture;
use crate::formula::saturate;

/// Voxels that are worked out together.
const RUN: usize = 16;
const CLEAR: Rgba<u8> = Rgba([128, 128, 255, 0]);
/// Noise in 16 bits: it stays within ±4.
const NOISE_SCALE: f32 = 8192.0;

/// What all frames of a sprite share.
pub(super) struct Slices<'a> {
    recipe: &'a SpriteRecipe,
    depth: u32,
    octaves: Vec<Octave>,
}

/// Noise of every voxel: at the loop's start, and a quarter later.
struct Octave {
    weight: f32,
    lumps: f32,
    values: Picture<[i16; 2]>,
}

/// How far a place is carried along the flow, and by that and the warp together.
#[derive(Clone, Copy)]
struct Shift {
    flow: Vec3,
    all: Vec3,
}

impl Shift {
    fn lerp(self, other: Self, share: f32) -> Self {
        Self { flow: self.flow.lerp(other.flow, share), all: self.all.lerp(other.all, share) }
    }
}

impl Ball {
    /// Adds Wyvill's soft object, (1 − d²/r²)³: value and slope are 0 at its reach. Overlapping balls merge.
    fn add_field(&self, [px, py, pz]: [&[f32; RUN]; 3], field: &mut [f32; RUN]) {
        let Self { centre, axis, inverse_radius } = *self;
        let inverse_axis = 1.0 / axis.length_squared().max(f32::MIN_POSITIVE);
        let scale = inverse_radius * inverse_radius;
        let is_line = axis != Vec3::ZERO;
        for lane in 0..RUN {
            let (mut x, mut y, mut z) = (px[lane] - centre.x, py[lane] - centre.y, pz[lane] - centre.z);
            if is_line {
                let along = ((x * axis.x + y * axis.y + z * axis.z) * inverse_axis).clamp(-1.0, 1.0);
                (x, y, z) = (x - axis.x * along, y - axis.y * along, z - axis.z * along);
            }
            let inside = (1.0 - (x * x + y * y + z * z) * scale).max(0.0);
            field[lane] += inside * inside * inside;
        }
    }
}

/// One moment.
struct Moment {
    phase: Vec2,
    /// On a cube of `nodes` from −1 to 1, its slices below each other.
    shifts: Picture<Shift>,
    /// The balls that reach each box of [`RUN`] texels a side.
    near: Vec<Vec<Ball>>,
}

/// exp(−x) for x from 0 to 16 or so.
fn decay(x: f32) -> f32 {
    let x = x * (1.0 / 32.0);
    let mut power = 1.0 / (1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0)))));
    for _ in 0..5 {
        power *= power;
    }
    power
}

/// Round lumps with sharp creases between, in place of waves; about as much of either.
fn shaped(noise: f32, lumps: f32) -> f32 {
    noise + (0.4 - 2.0 * noise.abs() - noise) * lumps
}

impl<'a> Slices<'a> {
    pub fn new(recipe: &'a SpriteRecipe) -> Self {
        let mut slices = Self { recipe, depth: (recipe.size / 4).max(8), octaves: Vec::new() };
        let weight = |index: u32| (0..index).fold(1.0, |weight, _| weight * recipe.noise_gain);
        let octave = |index: u32| (weight(index), 2_u32.pow(index) as f32, index * 7919);
        let all: Vec<_> = (0..recipe.noise_octaves).map(octave).collect();
        // Without creases they add up before they turn, and where they do not turn, also with them.
        let travels = recipe.travel > 0.0;
        let lumps = recipe.lumps;
        slices.octaves = if lumps > 0.0 && !travels {
            let alone = |&(weight, frequency, salt): &(f32, f32, u32)| Octave {
                weight,
                lumps,
                values: slices.noise(&[(1.0, frequency, salt)], 0.0),
            };
            all.iter().map(alone).collect()
        } else {
            let inside = if travels { lumps } else { 0.0 };
            vec![Octave { weight: 1.0, lumps: 0.0, values: slices.noise(&all, inside) }]
        };
        slices
    }

    fn noise(&self, octaves: &[(f32, f32, u32)], lumps: f32) -> Picture<[i16; 2]> {
        let size = self.recipe.size;
        let mut values = Picture::new(UVec2::new(size, size * self.depth), [0_i16; 2]);
        let seed = self.recipe.seed.wrapping_mul(31);
        values.for_bands(|first, band| {
            for (row, line) in (first..).zip(band.chunks_mut(size as usize)) {
                for &(weight, frequency, salt) in octaves {
                    let mut cell = NoiseCell::new(seed.wrapping_add(salt));
                    for (x, value) in (0..).zip(&mut *line) {
                        let p = self.position(UVec3::new(x, row % size, row / size));
                        // Nothing is seen further out, but what travels may come from there.
                        if p.length_squared() > 1.0 + self.recipe.travel {
                            continue;
                        }
                        let noise = cell.turning(p * self.recipe.noise_frequency * frequency);
                        for (sum, noise) in value.iter_mut().zip(noise) {
                            *sum = sum.saturating_add((shaped(noise, lumps) * weight * NOISE_SCALE) as i16);
                        }
                    }
                }
            }
        });
        values
    }

    /// The place of a voxel: x right, y up, z to the viewer.
    fn position(&self, voxel: UVec3) -> Vec3 {
        let size = self.recipe.size as f32;
        let p = (voxel.as_vec3() + 0.5) * (2.0 / Vec3::new(size, size, self.depth as f32)) - 1.0;
        Vec3::new(p.x, -p.y, -p.z)
    }

    pub fn frame(&self, time: f32) -> BakedFrame {
        let size = self.recipe.size;
        let moment = self.moment(time);
        let mut volume = Picture::new(UVec2::new(size, size * self.depth), 0.0);
        volume.for_bands(|first, band| {
            for (row, line) in (first..).zip(band.chunks_mut(size as usize)) {
                self.fill(&moment, row % size, row / size, line);
            }
        });
        let mut marched = Picture::new(UVec2::splat(size), (CLEAR, 0.0));
        marched.for_bands(|first, band| {
            for (y, line) in (first..).zip(band.chunks_mut(size as usize)) {
                self.march(&volume, y, line);
            }
        });
        // Far from everything all texels are the same, which costs nothing in a file.
        let is_clear = |at: IVec2| marched.load(at).0.0[3] == 0;
        let is_far = |at: IVec2| (-1..=1).all(|y| (-1..=1).all(|x| is_clear(at + IVec2::new(x, y))));
        let texels = (0..size * size).map(|index| {
            let at = UVec2::new(index % size, index / size).as_ivec2();
            if is_far(at) { (CLEAR, 0.0) } else { marched.load(at) }
        });
        BakedFrame::new(size, texels)
    }

    fn moment(&self, time: f32) -> Moment {
        let recipe = self.recipe;
        let turning = direction(time * std::f32::consts::TAU);
        // What travels does not turn in its place.
        let phase = if recipe.travel > 0.0 { Vec2::X } else { turning };
        let nodes = ((recipe.noise_frequency * 8.0) as u32).clamp(16, 64);
        let mut shifts = Picture::new(UVec2::new(nodes, nodes * nodes), Shift { flow: Vec3::ZERO, all: Vec3::ZERO });
        let seed = recipe.seed.wrapping_mul(31);
        shifts.for_each(|at, shift| {
            let node = UVec3::new(at.x, at.y % nodes, at.y / nodes).as_vec3();
            let p = node * (2.0 / (nodes - 1) as f32) - 1.0;
            if recipe.travel > 0.0 {
                shift.flow = curl_noise(p * 0.8, turning, seed.wrapping_add(23)) * recipe.travel;
            }
            shift.all = shift.flow;
            if recipe.warp > 0.0 {
                let q = (p + shift.flow) * recipe.noise_frequency;
                let coarse = curl_noise(q * 0.5, phase, seed.wrapping_add(11));
                shift.all += (coarse + curl_noise(q + coarse, phase, seed.wrapping_add(17)) * 0.4) * recipe.warp;
            }
        });
        let margin = shifts.texels.iter().map(|shift| shift.all.length()).fold(0.0, f32::max);
        Moment { phase, near: self.near(&balls(recipe, time), margin), shifts }
    }

    /// Boxes along each axis.
    fn boxes(&self) -> UVec3 {
        UVec3::new(self.recipe.size, self.recipe.size, self.depth).map(|side| side.div_ceil(RUN as u32))
    }

    fn near(&self, balls: &[Ball], margin: f32) -> Vec<Vec<Ball>> {
        let boxes = self.boxes();
        let near = |index: u32| {
            let first =
                UVec3::new(index % boxes.x, index / boxes.x % boxes.y, index / (boxes.x * boxes.y)) * RUN as u32;
            let (a, b) = (self.position(first), self.position(first + (RUN as u32 - 1)));
            let reach = (a - b).length() * 0.5 + margin;
            let middle = (a + b) * 0.5;
            let reaches = |ball: &&Ball| ball.offset(middle).length() < reach + 1.0 / ball.inverse_radius;
            balls.iter().filter(reaches).copied().collect()
        };
        (0..boxes.element_product()).map(near).collect()
    }

    /// The densities of one row of voxels: 0 outside, about 1 inside.
    fn fill(&self, moment: &Moment, y: u32, z: u32, line: &mut [f32]) {
        let recipe = self.recipe;
        let middle = self.position(UVec3::new(recipe.size / 2, y, z)).with_x(0.0);
        if middle.length_squared() > 1.0 {
            return;
        }
        let shifts = shifts_along(&moment.shifts, middle);
        let boxes = self.boxes();
        let first_box = ((z / RUN as u32 * boxes.y) + y / RUN as u32) * boxes.x;
        for (index, run) in line.chunks_mut(RUN).enumerate() {
            let near = &moment.near[first_box as usize + index];
            if near.is_empty() {
                continue;
            }
            let start = index * RUN;
            let (mut window, mut field) = ([0.0; RUN], [0.0; RUN]);
            let (mut px, mut py, mut pz, mut flow) = ([0.0; RUN], [0.0; RUN], [0.0; RUN], [Vec3::ZERO; RUN]);
            for (lane, window) in window.iter_mut().enumerate() {
                let p = middle.with_x(((start + lane) as f32 + 0.5) * (2.0 / recipe.size as f32) - 1.0);
                *window = saturate((0.97 - p.length()) * 6.0);
                let node = (p.x.min(1.0) + 1.0) * 0.5 * (shifts.len() - 1) as f32;
                let low = (node as usize).min(shifts.len() - 2);
                let shift = shifts[low].lerp(shifts[low + 1], node - low as f32);
                flow[lane] = p + shift.flow;
                [px[lane], py[lane], pz[lane]] = (p + shift.all).to_array();
            }
            if window.iter().all(|&window| window <= 0.0) {
                continue;
            }
            for ball in near {
                ball.add_field([&px, &py, &pz], &mut field);
            }
            if field.iter().all(|&field| field <= 0.0) {
                continue;
            }
            let noise: [f32; RUN] = if recipe.travel > 0.0 {
                flow.map(|p| self.carried_noise(p))
            } else {
                let first = ((z * recipe.size + y) * recipe.size) as usize + start;
                self.noise_along(first..first + run.len(), moment.phase)
            };
            for (lane, density) in run.iter_mut().enumerate() {
                let body = 1.0 - decay(2.0 * field[lane]);
                // Noise eats from the outside in: less where the body is thick.
                let eaten = recipe.erosion * (0.4 + noise[lane]) * (1.0 - 0.7 * body);
                *density = (body - eaten).max(0.0) * window[lane] * window[lane] * (3.0 - 2.0 * window[lane]);
            }
        }
    }

    fn noise_along(&self, voxels: Range<usize>, phase: Vec2) -> [f32; RUN] {
        let mut sums = [0.0; RUN];
        for octave in &self.octaves {
            for (sum, &[start, later]) in sums.iter_mut().zip(&octave.values.texels[voxels.clone()]) {
                let noise = (f32::from(start) * phase.x + f32::from(later) * phase.y) * (1.0 / NOISE_SCALE);
                *sum += shaped(noise, octave.lumps) * octave.weight;
            }
        }
        sums
    }

    /// Noise between voxels, where it does not turn: all of it is in one octave.
    fn carried_noise(&self, p: Vec3) -> f32 {
        let size = self.recipe.size;
        let sides = Vec3::new(size as f32, size as f32, self.depth as f32);
        let at = ((p * Vec3::new(1.0, -1.0, -1.0) + 1.0) * 0.5 * sides - 0.5).clamp(Vec3::ZERO, sides - 1.0);
        let (low, share) = (at.floor(), at - at.floor());
        let low = low.as_uvec3();
        let high = (low + 1).min(UVec3::new(size, size, self.depth) - 1);
        let values = &self.octaves[0].values;
        let load = |x: u32, y: u32, z: u32| {
            f32::from(values.texels[((z * size + y) * size + x) as usize][0]) * (1.0 / NOISE_SCALE)
        };
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let row = |y, z| mix(load(low.x, y, z), load(high.x, y, z), share.x);
        let slice = |z| mix(row(low.y, z), row(high.y, z), share.y);
        mix(slice(low.z), slice(high.z), share.z)
    }

    /// Front to back through the columns of one row of texels.
    fn march(&self, volume: &Picture<f32>, y: u32, line: &mut [(Rgba<u8>, f32)]) {
        let (size, depth) = (self.recipe.size as usize, self.depth as usize);
        // One row of voxels; those outside are as the last inside.
        let row = |dy: isize, z: usize, dz: isize| {
            let y = (y as usize).saturating_add_signed(dy).min(size - 1);
            let start = (z.saturating_add_signed(dz).min(depth - 1) * size + y) * size;
            &volume.texels[start..start + size]
        };
        // A voxel is four times as deep as wide.
        let ratio = size as f32 / depth as f32;
        let reach = [(size / 24).max(1), 1];
        let deep = reach.map(|reach| (reach as f32 / ratio).round().max(1.0));
        let step = 2.0 / depth as f32;
        let mut rays = vec![Ray::new(); size];
        for z in 0..depth {
            let place = self.position(UVec3::new(0, y, z as u32)).z;
            let here = row(0, z, 0);
            // Above, below, in front and behind: wide and fine.
            let around = [0, 1].map(|index| {
                let (reach, deep) = (reach[index] as isize, deep[index] as isize);
                [row(-reach, z, 0), row(reach, z, 0), row(0, z, -deep), row(0, z, deep)]
            });
            let slope = |x: usize, index: usize| {
                let [above, below, front, behind] = around[index].map(|row: &[f32]| row[x]);
                let along_x = here[x.saturating_sub(reach[index])] - here[(x + reach[index]).min(size - 1)];
                let along_z = (behind - front) * reach[index] as f32 / (deep[index] * ratio);
                // As in version 1, none faces away.
                Vec3::new(along_x, below - above, along_z.max(0.0)).normalize_or_zero()
            };
            for ((x, &density), ray) in here.iter().enumerate().zip(&mut rays) {
                if density <= 0.0 || ray.is_over() {
                    continue;
                }
                let amount = 1.0 - decay(density * self.recipe.extinction * step);
                ray.meet(amount, slope(x, 0) + slope(x, 1) * self.recipe.bump, place);
            }
        }
        for ((x, texel), ray) in (0..).zip(line).zip(rays) {
            let place = self.position(UVec3::new(x, y, 0)).truncate();
            *texel = ray.texel(UVec2::new(x, y), self.recipe.size, place);
        }
    }
}

/// The shifts of one row: nodes along x.
fn shifts_along(shifts: &Picture<Shift>, p: Vec3) -> Vec<Shift> {
    let nodes = shifts.size.x as i32;
    let at = (p + 1.0) * 0.5 * (nodes - 1) as f32;
    let low = at.floor();
    let share = at - low;
    let load = |x, y: i32, z: i32| shifts.load(IVec2::new(x, z.min(nodes - 1) * nodes + y.min(nodes - 1)));
    let low = low.as_ivec3();
    let along = |x| {
        let near = load(x, low.y, low.z).lerp(load(x, low.y + 1, low.z), share.y);
        near.lerp(load(x, low.y, low.z + 1).lerp(load(x, low.y + 1, low.z + 1), share.y), share.z)
    };
    (0..nodes).map(along).collect()
}
