//! Checks all files that a preset names, and reports every error and warning.

use std::path::Path;

use haze_core::error::AssetError;
use haze_core::settings::{BlendMode, RenderPath};
use haze_preset::{AssetFolders, ImageCache, ImageSource, MaterialSources, Preset, with_system_context};

use super::role_check::role_warnings;
use crate::backdrop::Backdrop;
use crate::particle_files::check_particle_files;

/// Loads all files that a preset names. Returns all errors, and notes, each with its field: images that do not seem to fit
/// their role, the attributes that columns of particles are read as, and parts of a scene file that are not shown. Files
/// are searched for in `folders`; `path`, the preset's file, is only named in errors.
pub fn check_files(preset: &Preset, path: &Path, folders: &AssetFolders) -> (Vec<AssetError>, Vec<String>) {
    let mut images = ImageCache::new(ImageSource::Folders(folders.clone()));
    let mut errors = Vec::new();
    let mut warnings = Vec::new();
    for (index, system) in preset.systems.iter().enumerate() {
        let found = match system.material.load_with_cache(&mut images) {
            Ok(material) => {
                let fits = material.info().validate(index, &system.settings);
                errors.extend(fits.err().map(|error| AssetError::JsonField { path: path.into(), error }));
                role_warnings(&system.material, &material)
            }
            Err(of_material) => {
                let fields: Vec<_> = of_material.iter().map(|(field, _)| *field).collect();
                errors.extend(of_material.into_iter().map(|(_, error)| with_system_context(path, index, error)));
                role_warnings_except(&system.material, &fields, folders)
            }
        };
        let told = |(field, warning)| format!("systems[{index}].material.{field}: {warning}");
        warnings.extend(found.into_iter().map(told));
        if system.settings.blend_mode == BlendMode::Multiply && system.settings.path != RenderPath::Forward {
            warnings.push(format!(
                "systems[{index}].settings.blend_mode: multiply is drawn as alpha on the path {}; expected the path forward",
                system.settings.path.name()
            ));
        }
        let near = preset.camera.near;
        let near_fade_end = system.settings.soft_fade.near_fade_end;
        if near_fade_end > 0.0 && near_fade_end <= near {
            warnings.push(format!(
                "systems[{index}].settings.soft_fade.near_fade_end: {near_fade_end} m is no further than the camera's near \
                 plane, {near} m, at which smoke is gone anyway; expected more, or 0"
            ));
        }
    }
    let (of_particles, columns) = check_particle_files(preset, path, folders);
    errors.extend(of_particles);
    warnings.extend(columns);
    match Backdrop::load(preset, path, folders) {
        Ok(backdrop) => warnings.extend(backdrop.notes(&preset.environment)),
        Err(error) => errors.push(error),
    }
    (errors, warnings)
}

/// Warnings about the images of all fields but some.
fn role_warnings_except(
    names: &MaterialSources,
    fields: &[&str],
    folders: &AssetFolders,
) -> Vec<(&'static str, String)> {
    let others = names.with_defaults_for(fields);
    let loaded = others.load_with_cache(&mut ImageCache::new(ImageSource::Folders(folders.clone())));
    loaded.map(|material| role_warnings(&others, &material)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};

    use super::*;
    use haze_core::settings::Technique;
    use haze_preset::PresetSystem;

    #[test]
    fn an_error_hides_no_other_error_or_warning() {
        let folder = tempfile::tempdir().unwrap();
        RgbImage::from_fn(4, 64, |_, y| Rgb([4 * y as u8; 3])).save(folder.path().join("down.png")).unwrap();
        RgbImage::from_pixel(16, 16, Rgb([0; 3])).save(folder.path().join("flat.png")).unwrap();
        let mut preset = Preset { systems: vec![PresetSystem::default(); 4], ..Preset::default() };
        let mut name = |index: usize, change: fn(&mut PresetSystem)| change(&mut preset.systems[index]);
        name(0, |system| {
            system.material.sprite = "gone.png".into();
            system.material.columns = 3;
        });
        name(0, |system| system.material.diffuse_ramp = "down.png".into());
        name(0, |system| system.settings.blend_mode = BlendMode::Multiply);
        name(1, |system| system.material.noise = "flat.png".into());
        name(1, |system| system.material.motif = "none".into());
        name(1, |system| system.material.age_ramp = "down.png".into());
        name(2, |system| system.material.coverage_ramp = "down.png".into());
        name(2, |system| system.settings.technique = Technique::DepthSpriteSoft);
        name(2, |system| system.material.sprite = "clear.png".into());
        name(3, |system| system.particle_files.path = "gone.csv".into());
        name(3, |system| system.settings.soft_fade.near_fade_end = 0.05);
        image::RgbaImage::new(16, 16).save(folder.path().join("clear.png")).unwrap();
        let (errors, warnings) = check_files(&preset, Path::new("my.json"), &AssetFolders::new(folder.path()));
        let errors: Vec<_> = errors.iter().map(ToString::to_string).collect();
        for (said, begins) in errors.iter().zip([
            "my.json: systems[0].material.sprite: ",
            "my.json: systems[1].material.motif: \"none\" is not valid",
            "my.json: systems[1].material.noise: ",
            "my.json: systems[2].settings.technique: ",
            "my.json: systems[3].particle_files.path: ",
        ]) {
            assert!(said.starts_with(begins), "{begins}: {errors:?}");
        }
        assert_eq!(errors.len(), 5, "{errors:?}");
        for (said, begins) in warnings.iter().zip([
            "systems[0].material.diffuse_ramp: down.png: painted from top to bottom",
            "systems[0].settings.blend_mode: multiply is drawn as alpha on the path auto",
            "systems[1].material.age_ramp: down.png: painted from top to bottom",
            "systems[2].material.sprite: clear.png: alpha is 0 everywhere",
            "systems[2].material.coverage_ramp: down.png: painted from top to bottom",
            "systems[3].settings.soft_fade.near_fade_end: 0.05 m is no further than the camera's near plane, 0.1 m",
        ]) {
            assert!(said.starts_with(begins), "{begins}: {warnings:?}");
        }
        assert_eq!(warnings.len(), 6, "{warnings:?}");
    }
}
