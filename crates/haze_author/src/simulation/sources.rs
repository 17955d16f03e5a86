//! Emission of sources into the grid.

use glam::{UVec3, Vec3, Vec4};
use haze_core::assets::noise::gradient_noise;
use haze_core::formula::saturate;

use super::domain::Domain;
use super::grid::CellBox;
use super::source::{Source, SourceShape};
use crate::deterministic_math::cos_sin;

/// A source at one moment.
pub struct Emission<'a> {
    source: &'a Source,
    time: f32,
    /// Width of the soft edge.
    softness: f32,
}

impl<'a> Emission<'a> {
    /// Returns the emission from `time` on for `step` seconds, or `None` if there is none. `cell_width` is that of the
    /// velocity.
    pub fn new(source: &'a Source, time: f32, step: f32, cell_width: f32) -> Option<Self> {
        let emits = source.start < time + step && time < source.end;
        emits.then_some(Self { source, time, softness: 1.5 * cell_width })
    }

    /// Cells that it may reach.
    pub fn cells(&self, domain: Domain) -> CellBox {
        let reach = self.source.radius + self.source.radius.min_element() * self.source.noise + self.softness;
        domain.cells(self.source.position - reach, self.source.position + reach)
    }

    /// Weight of the source at a position: 1 inside, 0 outside.
    fn weight(&self, position: Vec3) -> f32 {
        let Source { shape, radius, noise, noise_frequency, noise_rate, seed, .. } = *self.source;
        let from = (position - self.source.position).abs();
        let smallest = radius.min_element();
        let length = |v: Vec3| (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
        let inside = match shape {
            SourceShape::Sphere => (1.0 - length(from / radius)) * smallest,
            SourceShape::Disc => {
                let rim = (1.0 - length((from / radius).with_y(0.0))) * radius.x.min(radius.z);
                rim.min(radius.y - from.y)
            }
            SourceShape::Box => (radius - from).min_element(),
        };
        let mut depth = inside;
        if noise > 0.0 {
            // One turn of the phase passes through about four different patterns.
            let turns = self.time * noise_rate * 0.25;
            let phase = cos_sin((turns - turns.floor()) * std::f32::consts::TAU);
            depth += gradient_noise(position * noise_frequency, phase, seed).value * noise * smallest;
        }
        saturate(depth / self.softness + 0.5)
    }

    /// Fills the gas (smoke, heat, fuel) of the cells that it reaches.
    pub fn fill(&self, domain: Domain, gas: &mut [Vec4]) {
        let Source { smoke, heat, fuel, .. } = *self.source;
        let full = Vec4::new(smoke, heat, fuel, 0.0);
        domain.grid.for_rows_within(self.cells(domain), gas, |cell, row| {
            for (x, value) in (0_u32..).zip(row) {
                let weight = self.weight(domain.position((cell + UVec3::X * x).as_vec3()));
                *value = value.max(full * weight);
            }
        });
    }

    /// Sets one component of the velocity on the faces that it reaches.
    pub fn push(&self, domain: Domain, axis: usize, faces: &mut [f32]) {
        let Source { velocity, spread, position: middle, .. } = *self.source;
        if velocity == Vec3::ZERO && spread == 0.0 {
            return;
        }
        let mut to_face = Vec3::ZERO;
        to_face[axis] = 0.5;
        domain.grid.for_rows_within(self.cells(domain), faces, |cell, row| {
            for (x, value) in (0_u32..).zip(row) {
                let position = domain.position((cell + UVec3::X * x).as_vec3() - to_face);
                let weight = self.weight(position);
                let away = position - middle;
                let distance = (away.x * away.x + away.y * away.y + away.z * away.z).sqrt().max(1.0e-6);
                let target = velocity[axis] + away[axis] / distance * spread;
                *value += (target - *value) * weight;
            }
        });
    }
}
