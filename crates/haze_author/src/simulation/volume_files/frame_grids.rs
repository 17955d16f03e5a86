//! Grids of one file that are read: smoke, heat and velocity.

use glam::DVec3;
use haze_core::error::one_line;

use crate::vdb::{GridInfo, Sampler, SparseGrid, VdbFile};

/// Names of heat. A flame is nearer to what glows than the temperature of the smoke.
const HEAT: [&str; 4] = ["flame", "flames", "temperature", "heat"];
/// Names of velocity, and of grids of its parts: `vel.x`.
const VELOCITY: [&str; 3] = ["vel", "velocity", "v"];
const PARTS: [[&str; 3]; 3] = [[".x", ".y", ".z"], ["_x", "_y", "_z"], ["x", "y", "z"]];

/// Grids that are read of a file, not yet their values.
pub struct FrameGrids<'a> {
    file: &'a VdbFile<'a>,
    density: &'a GridInfo,
    heat: Option<&'a GridInfo>,
    velocity: Velocity<&'a GridInfo, &'a GridInfo>,
}

/// Velocity as files have it: `V` holds vectors, `S` numbers.
enum Velocity<V, S> {
    None,
    Vectors(V),
    Parts([S; 3]),
}

/// Values of the grids of a frame.
pub struct FrameVolumes {
    pub density: SparseGrid<1>,
    pub heat: Option<SparseGrid<1>>,
    velocity: Velocity<SparseGrid<3>, SparseGrid<1>>,
    /// Distance in voxels of a velocity from the center of its voxel: half a voxel against its axis if the grid is
    /// staggered.
    stagger: f64,
}

/// Names of the grids of a file, for messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GridNames {
    pub density: String,
    /// Empty without heat.
    pub heat: String,
    /// Empty without velocity.
    pub velocity: String,
    pub unread: Vec<String>,
}

impl<'a> FrameGrids<'a> {
    /// Finds the grids by their names.
    ///
    /// # Errors
    /// The reason: no such density, a level set, points.
    pub fn find(file: &'a VdbFile<'a>, density: &str) -> Result<Self, String> {
        let found = |name: &str| file.grids().iter().find(|grid| grid.name.eq_ignore_ascii_case(name));
        let of_numbers = |name: &str, numbers| found(name).filter(|grid| grid.numbers() == numbers);
        let density = found(density).ok_or_else(|| no_density(file, density))?;
        if density.class == "level set" {
            let reason = "a level set, distances to a surface; expected a fog volume: convert it";
            return Err(format!("{}: {reason}", one_line(&density.name)));
        }
        let heat = HEAT.into_iter().find_map(|name| of_numbers(name, 1)).filter(|heat| heat.name != density.name);
        let vectors = VELOCITY.into_iter().find_map(|name| of_numbers(name, 3));
        let part = |name: &str, part: &str| of_numbers(&format!("{name}{part}"), 1);
        let parts =
            |name: &str| PARTS.into_iter().find_map(|[x, y, z]| Some([part(name, x)?, part(name, y)?, part(name, z)?]));
        let velocity = match (vectors, VELOCITY.into_iter().find_map(parts)) {
            (Some(vectors), _) => Velocity::Vectors(vectors),
            (None, Some(parts)) => Velocity::Parts(parts),
            (None, None) => Velocity::None,
        };
        Ok(Self { file, density, heat, velocity })
    }

    /// Program that made the density; empty if the file does not say.
    pub fn creator(&self) -> &str {
        &self.density.creator
    }

    /// Returns the names.
    pub fn names(&self) -> GridNames {
        let mut velocity = Vec::new();
        match &self.velocity {
            Velocity::None => {}
            Velocity::Vectors(grid) => velocity.push(grid.name.clone()),
            Velocity::Parts(grids) => velocity.extend(grids.map(|grid| grid.name.clone())),
        }
        let heat = self.heat.map(|grid| grid.name.clone()).unwrap_or_default();
        let is_read = |name: &String| *name == self.density.name || *name == heat || velocity.contains(name);
        let names = self.file.grids().iter().map(|grid| &grid.name);
        let unread = names.filter(|name| !is_read(name)).map(one_line).collect();
        Self::shown(GridNames { density: self.density.name.clone(), heat, velocity: velocity.join(", "), unread })
    }

    fn shown(names: GridNames) -> GridNames {
        let GridNames { density, heat, velocity, unread } = names;
        GridNames { density: one_line(density), heat: one_line(heat), velocity: one_line(velocity), unread }
    }

    /// Reads density and heat.
    ///
    /// # Errors
    /// The reason, which names the grid.
    pub fn read_smoke(&self) -> Result<(SparseGrid<1>, Option<SparseGrid<1>>), String> {
        Ok((self.file.read(self.density)?, self.heat.map(|heat| self.file.read(heat)).transpose()?))
    }

    /// Reads all grids.
    ///
    /// # Errors
    /// The reason, which names the grid.
    pub fn read(&self) -> Result<FrameVolumes, String> {
        let (density, heat) = self.read_smoke()?;
        let mut stagger = 0.0;
        let velocity = match self.velocity {
            Velocity::None => Velocity::None,
            Velocity::Vectors(grid) => {
                if grid.class == "staggered" {
                    stagger = 0.5;
                }
                Velocity::Vectors(self.file.read(grid)?)
            }
            Velocity::Parts([x, y, z]) => Velocity::Parts([self.file.read(x)?, self.file.read(y)?, self.file.read(z)?]),
        };
        Ok(FrameVolumes { density, heat, velocity, stagger })
    }
}

/// Samplers of the velocity of a frame.
pub struct VelocitySampler<'a> {
    velocity: Velocity<Sampler<'a, 3>, Sampler<'a, 1>>,
    volumes: &'a FrameVolumes,
}

impl FrameVolumes {
    pub fn velocity_sampler(&self) -> VelocitySampler<'_> {
        let velocity = match &self.velocity {
            Velocity::None => Velocity::None,
            Velocity::Vectors(grid) => Velocity::Vectors(grid.sampler()),
            Velocity::Parts(grids) => Velocity::Parts(grids.each_ref().map(SparseGrid::sampler)),
        };
        VelocitySampler { velocity, volumes: self }
    }
}

impl VelocitySampler<'_> {
    /// Returns the velocity at a position, units of the file per second.
    pub fn sample(&mut self, position: DVec3) -> DVec3 {
        let mut velocity = DVec3::ZERO;
        match (&mut self.velocity, &self.volumes.velocity) {
            (Velocity::Vectors(sampler), Velocity::Vectors(grid)) => {
                let index = grid.transform.index(position);
                for axis in 0..3 {
                    // A staggered number lies on the face below the voxel.
                    let mut index = index;
                    index[axis] += self.volumes.stagger;
                    velocity[axis] = sampler.sample(index)[axis].into();
                }
            }
            (Velocity::Parts(samplers), Velocity::Parts(grids)) => {
                for (axis, (sampler, grid)) in samplers.iter_mut().zip(grids).enumerate() {
                    let [value] = sampler.sample(grid.transform.index(position));
                    velocity[axis] = value.into();
                }
            }
            _ => {}
        }
        velocity
    }
}

fn no_density(file: &VdbFile<'_>, density: &str) -> String {
    let list = |grids: Vec<&GridInfo>| {
        let names: Vec<_> =
            grids.into_iter().map(|grid| format!("{} ({})", one_line(&grid.name), grid.kind())).collect();
        if names.is_empty() { "none".into() } else { names.join(", ") }
    };
    let density = one_line(density);
    let grids = list(file.grids().iter().collect());
    format!("no grid named {density}; expected one, or --grid with the name of another. Grids of the file: {grids}")
}
