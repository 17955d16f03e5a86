//! A preset with its pictures loaded: what there is to draw, whoever draws it.

use std::path::Path;

use glam::UVec2;

use super::scene::Scene;
use haze::assets::material::MaterialAssets;
use haze::error::Error;
use haze::frame::{Emission, Particle};
use haze::preset::{PictureFolders, Preset, PresetSystem};
use haze::settings::{Settings, ShadeTree};
use haze_author::particle_files::{self, Cache, load_caches};

/// Births of an emitter from which on it is evaluated where it is drawn.
const MANY: u32 = 1 << 14;

/// Where the particles of a system are.
pub(super) enum Source {
    Particles(Vec<Particle>),
    Emission(Emission),
}

/// A preset with its pictures loaded.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The preset; change it freely.
    pub preset: Preset,
    /// Picture size.
    pub size: UVec2,
    /// Which stage of the shading is shown.
    pub shade_tree: ShadeTree,
    /// One per system.
    pub materials: Vec<MaterialAssets>,
    /// One per system that takes its particles from files; the emitter makes them where there is none.
    pub caches: Vec<Option<Cache>>,
}

impl Shot {
    /// Loads a preset, built in or from a file, with its pictures and particle files.
    ///
    /// # Errors
    /// As [`Preset::load`], [`Preset::load_materials`] and [`Preset::load_caches`].
    pub fn load(name_or_path: impl AsRef<Path>, size: UVec2) -> Result<Self, Error> {
        let path = name_or_path.as_ref();
        Self::new(Preset::load(path)?, path, size)
    }

    /// Loads the files that a preset names, which are looked for beside `path`.
    ///
    /// # Errors
    /// As [`Preset::load_materials`] and [`Preset::load_caches`].
    pub fn new(preset: Preset, path: &Path, size: UVec2) -> Result<Self, Error> {
        Self::from_folders(preset, path, &PictureFolders::beside(path), size)
    }

    /// The same, where they are looked for in other folders.
    ///
    /// # Errors
    /// As [`Shot::new`].
    pub fn from_folders(preset: Preset, path: &Path, folders: &PictureFolders, size: UVec2) -> Result<Self, Error> {
        let materials = preset.load_materials_from(path, folders)?;
        for (index, (system, material)) in preset.systems.iter().zip(&materials).enumerate() {
            let fits = material.info().validate(index, &system.settings);
            fits.map_err(|error| Error::JsonField { path: path.into(), error })?;
        }
        let caches = load_caches(&preset, path, folders)?;
        Ok(Self { preset, size, shade_tree: ShadeTree::Final, materials, caches })
    }

    /// True if both give one picture, before it is developed: exposure is no part of it. Cheap, as what comes from
    /// files is compared by where it is in memory.
    pub fn is_same(&self, other: &Self) -> bool {
        let shares = |(a, b): (&MaterialAssets, &MaterialAssets)| a.shares(b);
        let is_same_but_exposed = || {
            let mut preset = other.preset.clone();
            preset.camera.exposure = self.preset.camera.exposure;
            preset == self.preset
        };
        let is_exposed_alike = self.preset.camera.exposure.to_bits() == other.preset.camera.exposure.to_bits();
        (self.size, self.shade_tree) == (other.size, other.shade_tree)
            && (self.preset == other.preset || !is_exposed_alike && is_same_but_exposed())
            && self.materials.len() == other.materials.len()
            && self.materials.iter().zip(&other.materials).all(shares)
            && Cache::all_shared(&self.caches, &other.caches)
    }

    /// True if the smoke is shown in the scene; the other stages are shown on black.
    pub(super) fn shows_scene(&self) -> bool {
        self.shade_tree == ShadeTree::Final
    }

    pub(super) fn scene(&self) -> Scene {
        Scene::new(&self.preset.environment, &self.preset.lights)
    }

    /// Particles and settings of every system, in order.
    pub(super) fn systems(&self) -> Vec<(Vec<Particle>, Settings)> {
        self.each_system(|system, cache| {
            let mut particles = Vec::new();
            particle_files::particles(system, cache, self.preset.time, &mut particles);
            particles
        })
    }

    /// The same for a renderer that may evaluate emitters on the GPU: those of many particles are left to it.
    pub(super) fn sources(&self) -> Vec<(Source, Settings)> {
        self.each_system(|system, cache| match particle_files::emission(system, cache, self.preset.time) {
            Some(emission) if emission.count() > MANY => Source::Emission(emission),
            _ => {
                let mut particles = Vec::new();
                particle_files::particles(system, cache, self.preset.time, &mut particles);
                Source::Particles(particles)
            }
        })
    }

    fn each_system<T>(&self, source: impl Fn(&PresetSystem, Option<&Cache>) -> T) -> Vec<(T, Settings)> {
        let system = |(index, system): (usize, &PresetSystem)| {
            let cache = self.caches.get(index).and_then(Option::as_ref);
            (source(system, cache), system.settings_for(self.size.y))
        };
        self.preset.systems.iter().enumerate().map(system).collect()
    }
}
