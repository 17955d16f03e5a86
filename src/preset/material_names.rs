//! The pictures that a preset names, and where they are looked for.

use std::path::{Component, Path, PathBuf};

use super::pictures::Pictures;
use crate::assets::builtin;
use crate::assets::material::MaterialAssets;
use crate::assets::sprite::{Sprite, SpriteLayout};
use crate::error::{Error, FieldError};
use crate::settings::{PictureRole, settings};

settings! {
    /// The pictures of a system: names of built-in ones, or PNG files beside the preset.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct MaterialNames {
        /// Flipbook of normal maps.
        sprite: String = "puff".into(), picture(PictureRole::Sprite);
        /// Depth and motion of a sprite from a file, laid out as it; empty for none. A built-in sprite has its own.
        detail: String = String::new(), picture(PictureRole::Detail);
        /// Frames beside each other, for a sprite from a file. A built-in one knows its own.
        columns: u32 = 1, integer(1..=256, "frames");
        /// Frames below each other, for a sprite from a file.
        rows: u32 = 1, integer(1..=256, "frames");
        /// True for a sprite file painted with green pointing down.
        y_down: bool = false, flag;
        /// Light by dot(n, l).
        diffuse_ramp: String = "diffuse_soft".into(), picture(PictureRole::Ramp);
        /// Light by amount.
        soft_scatter_ramp: String = "scatter_mist".into(), picture(PictureRole::Ramp);
        /// Glow by distance² and amount.
        specular_ramp: String = "specular_halo".into(), picture(PictureRole::Ramp);
        /// Painted lit sphere.
        motif: String = "motif_studio".into(), picture(PictureRole::Motif);
        /// Colour by age.
        age_ramp: String = "age_smoke".into(), picture(PictureRole::Ramp);
        /// Coverage by amount.
        coverage_ramp: String = "coverage_soft".into(), picture(PictureRole::Ramp);
        /// Tiling 3D noise: a built-in one, or a PNG of slices below each other.
        noise: String = "fbm".into(), picture(PictureRole::Noise);
    }
}

impl MaterialNames {
    /// Loads every picture. `folder` is the preset's; files are looked for there and nowhere else.
    ///
    /// # Errors
    /// [`Error::Picture`] naming the field and the file, or [`Error::Field`] for a name that is neither built in nor a file
    /// inside the folder, or for more than [`MAX_PICTURE_BYTES`](super::MAX_PICTURE_BYTES).
    pub fn load(&self, folder: &Path) -> Result<MaterialAssets, Error> {
        self.load_from(&mut Pictures::default(), folder)
    }

    /// The same, where other systems may have loaded some already.
    pub(super) fn load_from(&self, pictures: &mut Pictures, folder: &Path) -> Result<MaterialAssets, Error> {
        let (sprite, detail) = self.load_sprite(pictures, folder)?;
        let noise = match builtin::find(builtin::NOISES, &self.noise) {
            Some(noise) => noise.noise()?,
            None => pictures.noise("noise", inside("noise", &self.noise, builtin::NOISES, folder)?)?,
        };
        let mut ramp = |field, name: &str, list| match builtin::find(list, name) {
            Some(ramp) => ramp.ramp(),
            None => pictures.ramp(field, inside(field, name, list, folder)?),
        };
        Ok(MaterialAssets {
            sprite,
            detail,
            noise,
            diffuse_ramp: ramp("diffuse_ramp", &self.diffuse_ramp, builtin::RAMPS)?,
            soft_scatter_ramp: ramp("soft_scatter_ramp", &self.soft_scatter_ramp, builtin::RAMPS)?,
            specular_ramp: ramp("specular_ramp", &self.specular_ramp, builtin::RAMPS)?,
            motif: ramp("motif", &self.motif, builtin::MOTIFS)?,
            age_ramp: ramp("age_ramp", &self.age_ramp, builtin::RAMPS)?,
            coverage_ramp: ramp("coverage_ramp", &self.coverage_ramp, builtin::RAMPS)?,
        })
    }

    fn load_sprite(&self, pictures: &mut Pictures, folder: &Path) -> Result<(Sprite, Option<Sprite>), Error> {
        if let Some(sprite) = builtin::find(builtin::SPRITES, &self.sprite) {
            let refuse = |field: &str, value: String, expected: &str| {
                let expected = format!("{expected} with a built-in sprite, which knows its own");
                Err(FieldError::new(format!("material.{field}"), value, expected).into())
            };
            if !self.detail.is_empty() {
                return refuse("detail", format!("{:?}", self.detail), "\"\"");
            }
            if (self.columns, self.rows) != (1, 1) {
                return refuse("columns and rows", format!("{}x{}", self.columns, self.rows), "1 and 1");
            }
            if self.y_down {
                return refuse("y_down", self.y_down.to_string(), "false");
            }
            return Ok((sprite.sprite()?, sprite.detail()?));
        }
        let layout = SpriteLayout { columns: self.columns, rows: self.rows, y_down: self.y_down };
        let path = inside("sprite", &self.sprite, builtin::SPRITES, folder)?;
        let sprite = pictures.sprite("sprite", path, layout)?;
        if self.detail.is_empty() {
            return Ok((sprite, None));
        }
        let path = inside("detail", &self.detail, &[], folder)?;
        Ok((sprite, Some(pictures.sprite("detail", path, SpriteLayout { y_down: false, ..layout })?)))
    }
}

/// The file that the name of a picture stands for, from the preset's folder on; none for a built-in one's, and for what lies
/// outside.
pub fn picture_file(name: &str) -> Option<&Path> {
    let path = Path::new(name);
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (is_png && stays).then_some(path)
}

/// The path of an asset inside the preset's folder.
fn inside(field: &str, name: &str, list: &[builtin::Builtin], folder: &Path) -> Result<PathBuf, FieldError> {
    if let Some(path) = picture_file(name) {
        return Ok(folder.join(path));
    }
    let mut expected = "a PNG inside the preset's folder".to_owned();
    if !list.is_empty() {
        let names: Vec<_> = list.iter().map(|builtin| builtin.name).collect();
        expected = format!("one of {}, or {expected}", names.join(", "));
    }
    Err(FieldError::new(format!("material.{field}"), format!("{name:?}"), expected))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assets_stay_inside_the_presets_folder() {
        let folder = Path::new("shots");
        assert_eq!(inside("sprite", "a/b.png", &[], folder).unwrap(), Path::new("shots/a/b.png"));
        for outside in ["../b.png", "/etc/b.png", "a/../../b.png", "puf", "b.jpg"] {
            assert!(inside("sprite", outside, builtin::SPRITES, folder).is_err(), "{outside}");
        }
    }
}
