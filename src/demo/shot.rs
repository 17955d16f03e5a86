//! A preset with its pictures loaded: what there is to draw, whoever draws it.

use std::path::Path;

use glam::UVec2;

use super::scene::Scene;
use crate::assets::material::MaterialAssets;
use crate::error::Error;
use crate::frame::Particle;
use crate::preset::{PictureFolders, Preset, PresetSystem};
use crate::settings::{Settings, ShadeTree};

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
}

impl Shot {
    /// Loads a preset, built in or from a file, and its pictures.
    ///
    /// # Errors
    /// As [`Preset::load`] and [`Preset::load_materials`].
    pub fn load(name_or_path: impl AsRef<Path>, size: UVec2) -> Result<Self, Error> {
        let path = name_or_path.as_ref();
        Self::new(Preset::load(path)?, path, size)
    }

    /// Loads the pictures of a preset, which are looked for beside `path`.
    ///
    /// # Errors
    /// As [`Preset::load_materials`].
    pub fn new(preset: Preset, path: &Path, size: UVec2) -> Result<Self, Error> {
        Self::from_folders(preset, path, &PictureFolders::beside(path), size)
    }

    /// The same, where the pictures are looked for in other folders.
    ///
    /// # Errors
    /// As [`Preset::load_materials`].
    pub fn from_folders(preset: Preset, path: &Path, folders: &PictureFolders, size: UVec2) -> Result<Self, Error> {
        let materials = preset.load_materials_from(path, folders)?;
        for (index, (system, material)) in preset.systems.iter().zip(&materials).enumerate() {
            let fits = material.info().validate(index, &system.settings);
            fits.map_err(|error| Error::JsonField { path: path.into(), error })?;
        }
        Ok(Self { preset, size, shade_tree: ShadeTree::Final, materials })
    }

    /// True if both give one picture, before it is developed: exposure is no part of it. Cheap, as ramps and sprites are
    /// compared by where they are in memory.
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
        let evaluate = |system: &PresetSystem| {
            let mut particles = Vec::new();
            system.particles(self.preset.time, &mut particles);
            (particles, system.settings_for(self.size.y))
        };
        self.preset.systems.iter().map(evaluate).collect()
    }
}
