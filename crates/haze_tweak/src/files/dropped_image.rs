//! Images dropped on the window: detects the role of an image and assigns it to the shown system.

use std::path::{Path, PathBuf};

use glam::UVec2;
use haze::FieldError;
use haze_author::preset::{no_effect_reason, role_warnings};
use haze_core::assets::ramp::RampRole;
use haze_core::assets::sprite::SpriteLayout;
use haze_core::error::Error;
use haze_core::settings::{FieldRef, for_each_field, set_field};
use haze_export::recipe_files::six_way_path;
use haze_preset::{AssetFolders, MaterialSources, Preset};

use crate::document::sprite_edits::sprite_source::{detail_of, recipe_of};
use crate::platform::{asset_loading, file_io};

/// Detected role of a dropped image.
pub struct DroppedImage {
    /// Material fields and their new values. The first is the field of the image itself.
    fields: Vec<(&'static str, String)>,
    /// Doubt of the content check about this role.
    doubt: Option<String>,
}

/// Roles tried in this order if the file name does not tell the role. The first without a doubt wins.
const ROLES_TO_TRY: [&str; 3] = ["diffuse_ramp", "sprite", "specular_ramp"];

impl DroppedImage {
    /// Reads an image that lies in one of the preset's folders. `material` is that of the target system.
    ///
    /// # Errors
    /// If the file lies elsewhere, cannot be read, or fits no role.
    pub fn read(path: &Path, folders: &AssetFolders, material: &MaterialSources) -> Result<Self, Error> {
        let refuse = |problem: &str, expected: &str| {
            let problem = format!("{} {problem}", path.display());
            FieldError::from_problem("dropped file", problem, expected).into()
        };
        let Some((folder, name)) = location_of(path, folders) else {
            let expected = "an image in the folder of the preset, or a preset file";
            return Err(refuse("is in another folder", expected));
        };
        if let Some(field) = field_of_name(path) {
            let (fields, doubt) = checked(field, &folder, &name, material)?;
            return Ok(Self { fields, doubt });
        }
        let mut wrong = None;
        for field in ROLES_TO_TRY {
            match checked(field, &folder, &name, material) {
                Ok((fields, None)) => return Ok(Self { fields, doubt: None }),
                Ok((_, Some(doubt))) => wrong = wrong.or(Some(doubt)),
                // An unreadable image fits no role, so the first error is final.
                Err(error) if field == ROLES_TO_TRY[0] => return Err(error),
                Err(_) => {}
            }
        }
        let file = path.file_name().unwrap_or_default().display();
        let doubt = wrong.unwrap_or_default();
        let expected =
            format!("a ramp or a sprite, or a file name that tells the role, such as diffuse_{file}; {doubt}");
        Err(refuse("fits no role", &expected))
    }

    /// Assigns the image to a system and returns a message for the user.
    ///
    /// # Errors
    /// If the system no longer exists.
    pub fn apply(self, preset: &mut Preset, system: usize, size: UVec2) -> Result<String, Error> {
        let path = |field| format!("systems[{system}].material.{field}");
        for (field, value) in &self.fields {
            set_field(preset, &path(field), value)?;
        }
        let of = preset.systems.get(system).map_or("", |system| &system.name);
        let said = self.fields.first().map(|(field, name)| {
            let idle = no_effect_reason(preset, &path(field), size);
            let idle = idle.map(|reason| format!(", but has no effect now: {reason}")).unwrap_or_default();
            format!("{name} is now the {} of {of}{idle}", field.replace('_', " "))
        });
        let doubt = self.doubt.map(|doubt| format!(". Check it: {doubt}")).unwrap_or_default();
        Ok(said.unwrap_or_default() + &doubt)
    }
}

/// Returns the preset folder that contains a file, and the file's path relative to it.
pub fn location_of(path: &Path, folders: &AssetFolders) -> Option<(PathBuf, String)> {
    let path = file_io::absolute(path);
    let folders = folders.candidate_paths(Path::new(".")).map(|folder| file_io::absolute(&folder));
    let mut locations = folders.filter_map(|folder| {
        let name = path.strip_prefix(&folder).ok()?.to_str()?.replace('\\', "/");
        Some((folder, name))
    });
    locations.next()
}

/// Returns the material field that the file name, or a recipe beside the file, indicates: `scatter_fog.png` is for soft
/// scatter.
fn field_of_name(path: &Path) -> Option<&'static str> {
    let name = path.file_name()?.to_str()?;
    let beside = [(".detail.png", "detail"), (".six_way.png", "six_way")];
    if let Some((_, field)) = beside.into_iter().find(|(ending, _)| name.ends_with(ending)) {
        return Some(field);
    }
    let word = name.split(['_', '.', '-']).next()?;
    let role = RampRole::from_name(name);
    let has_recipe = |field: &str| file_io::exists(&path.with_extension(format!("{field}.json")));
    let is_told =
        |field: &&str| (role.is_some() && RampRole::from_field(field) == role) || *field == word || has_recipe(field);
    image_fields().into_iter().find(is_told)
}

/// Fields to set for an image in a role, and a doubt about that role.
type Checked = (Vec<(&'static str, String)>, Option<String>);

fn checked(field: &'static str, folder: &Path, name: &str, material: &MaterialSources) -> Result<Checked, Error> {
    let mut fields = vec![(field, name.to_owned())];
    let mut names = MaterialSources::default();
    if field == "sprite" {
        let SpriteLayout { columns, rows, y_down } = layout(&folder.join(name), material);
        let name = Path::new(name);
        let beside = |path: PathBuf| {
            let is_there = file_io::exists(&folder.join(&path));
            path.to_str().filter(|_| is_there).unwrap_or_default().to_owned()
        };
        let layout = [("columns", columns.to_string()), ("rows", rows.to_string()), ("y_down", y_down.to_string())];
        fields.extend([("detail", beside(detail_of(name))), ("six_way", beside(six_way_path(name)))]);
        fields.extend(layout);
    } else if ["detail", "six_way"].contains(&field) {
        // The image must have the layout of the system's present sprite.
        let MaterialSources { sprite, columns, rows, y_down, .. } = material.clone();
        names = MaterialSources { sprite, columns, rows, y_down, ..names };
    }
    for (field, value) in &fields {
        set_field(&mut names, field, value)?;
    }
    let doubts = role_warnings(&names, &asset_loading::material(&names, folder)?);
    Ok((fields, doubts.into_iter().find(|(of, _)| *of == field).map(|(_, doubt)| doubt)))
}

/// Returns the layout of a sheet: from its recipe, or else from the sprite that it replaces.
fn layout(sheet: &Path, material: &MaterialSources) -> SpriteLayout {
    let as_before = SpriteLayout { columns: material.columns, rows: material.rows, y_down: material.y_down };
    asset_loading::sprite_recipe(&recipe_of(sheet)).map_or(as_before, |recipe| recipe.layout())
}

/// Returns the material fields that hold names of images.
fn image_fields() -> Vec<&'static str> {
    let mut fields = Vec::new();
    for_each_field(&mut MaterialSources::default(), &mut |path, leaf| {
        let name = path.last().filter(|_| matches!(leaf, FieldRef::Text(_)));
        fields.extend(name.map(|(name, _)| *name));
    });
    fields
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};

    use super::*;

    #[test]
    fn a_dropped_image_gets_the_role_of_its_name_or_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let save = |name: &str, size: (u32, u32), color: fn(u32, u32) -> [u8; 3]| {
            RgbImage::from_fn(size.0, size.1, |x, y| Rgb(color(x, y))).save(path(name)).unwrap();
        };
        let across = |x: u32, _| [4 * x as u8; 3];
        for name in ["mine.png", "scatter_a.png", "coverage_a.png", "age_a.png", "specular_a.png"] {
            save(name, (64, 1), across);
        }
        save("plane.png", (64, 64), |x, y| [((63 - x) * y / 16) as u8; 3]);
        save("rows.png", (64, 64), |x, y| [(x * y / 16) as u8; 3]);
        save("down.png", (4, 64), |_, y| [4 * y as u8; 3]);
        save("motif_a.png", (32, 32), across);
        for name in ["sheet.png", "puff.png", "puff.detail.png"] {
            let alpha = |x, y| if (1..31).contains(&x) && (1..31).contains(&y) { 255 } else { 0 };
            let texel = |x: u32, y: u32| image::Rgba([112 + x as u8, 112 + y as u8, 240, alpha(x, y)]);
            image::RgbaImage::from_fn(32, 32, texel).save(path(name)).unwrap();
        }
        image::RgbaImage::from_pixel(32, 64, image::Rgba([90, 120, 60, 0])).save(path("puff.six_way.png")).unwrap();
        save("opaque.png", (32, 32), |x, y| [112 + x as u8, 112 + y as u8, 240]);
        std::fs::write(path("broken.png"), "no image").unwrap();
        let folders = AssetFolders::new(folder.path());
        let mut preset = Preset::load("column").unwrap();
        let mut drop = |name: &str| {
            let dropped = DroppedImage::read(&path(name), &folders, &preset.systems[0].material)?;
            dropped.apply(&mut preset, 0, UVec2::new(640, 360)).map(|said| (said, preset.systems[0].material.clone()))
        };
        type Field = fn(&MaterialSources) -> &String;
        let all: [(&str, &str, Field); 11] = [
            ("rows.png", "diffuse ramp of smoke", |m| &m.diffuse_ramp),
            ("mine.png", "diffuse ramp of smoke", |m| &m.diffuse_ramp),
            ("scatter_a.png", "soft scatter ramp of smoke", |m| &m.soft_scatter_ramp),
            ("coverage_a.png", "coverage ramp of smoke", |m| &m.coverage_ramp),
            ("age_a.png", "age ramp of smoke", |m| &m.age_ramp),
            ("plane.png", "specular ramp of smoke", |m| &m.specular_ramp),
            ("motif_a.png", "motif of smoke", |m| &m.motif),
            ("sheet.png", "sprite of smoke", |m| &m.sprite),
            ("puff.png", "sprite of smoke", |m| &m.sprite),
            ("puff.detail.png", "detail of smoke", |m| &m.detail),
            ("puff.six_way.png", "six way of smoke", |m| &m.six_way),
        ];
        for (name, told, field) in all {
            let (said, material) = drop(name).unwrap();
            assert!(said.starts_with(&format!("{name} is now the {told}")), "{said}");
            assert_eq!(field(&material), name);
        }
        let said = drop("specular_a.png").unwrap().0;
        assert!(said.contains("now the specular ramp of smoke. Check it: specular_a.png: its one row"), "{said}");
        assert!(drop("scatter_a.png").unwrap().0.contains("has no effect now: "));
        let error = drop("down.png").err().unwrap().to_string();
        assert!(error.contains("such as diffuse_down.png; down.png: painted from top to bottom"), "{error}");
        let error = drop("opaque.png").err().unwrap().to_string();
        assert!(error.contains("looks like the normals of a sprite"), "{error}");
        assert!(drop("broken.png").err().unwrap().to_string().contains("not a PNG"));
        let elsewhere = DroppedImage::read(Path::new("/elsewhere/a.png"), &folders, &MaterialSources::default());
        assert!(elsewhere.err().unwrap().to_string().contains("an image in the folder of the preset"));
    }
}
