//! Files that a shot is read from.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use glam::Vec3;
use haze_author::backdrop::backdrop_names;
use haze_core::settings::{FieldVisitor, Fields, ImageRole};
use haze_preset::{AssetFolders, Preset, backdrop_file_path, image_file_path, particle_file_path};

/// Returns every path where an image that a preset names may lie.
pub fn image_paths(folders: &AssetFolders, preset: &Preset) -> Vec<PathBuf> {
    relative_image_paths(preset).iter().flat_map(|file| folders.candidate_paths(file)).collect()
}

/// Returns the same files, relative to the preset's folder.
pub fn relative_image_paths(preset: &Preset) -> Vec<PathBuf> {
    let mut names = ImageNames(Vec::new());
    preset.clone().visit(&mut names);
    names.0.iter().filter_map(|name| image_file_path(name)).map(Path::to_path_buf).collect()
}

/// Returns every path where a scene or sky that a preset names may lie.
pub fn backdrop_file_paths(folders: &AssetFolders, preset: &Preset) -> Vec<PathBuf> {
    let names = backdrop_names(&preset.environment);
    let files = names.into_iter().filter_map(|(kind, _, name)| backdrop_file_path(name, kind));
    files.flat_map(|file| folders.candidate_paths(file)).collect()
}

/// Returns every particle file that a preset names, and the next file of each sequence, which may be written later.
pub fn particle_file_paths(folders: &AssetFolders, preset: &Preset) -> Vec<PathBuf> {
    let files = preset.systems.iter().filter_map(|system| particle_file_path(&system.particle_files.path));
    files.flat_map(|file| folders.candidate_paths(file)).flat_map(|path| haze_preset::watched_paths(&path)).collect()
}

struct ImageNames(Vec<String>);

impl FieldVisitor for ImageNames {
    fn number(&mut self, _: &'static str, _: &mut f32, _: RangeInclusive<f32>, _: &'static str) {}
    fn integer(&mut self, _: &'static str, _: &mut u32, _: RangeInclusive<u32>, _: &'static str) {}
    fn vector(&mut self, _: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {}
    fn image(&mut self, _: &'static str, name: &mut String, _: ImageRole) {
        self.0.push(name.clone());
    }
    fn group(&mut self, _: &'static str, fields: &mut dyn Fields) {
        fields.visit(self);
    }
    fn item(&mut self, _: &'static str, _: usize, fields: &mut dyn Fields) {
        fields.visit(self);
    }
}
