//! Images of a material by name, and their loading.

use std::path::{Component, Path};

use haze_core::assets::material_assets::MaterialAssets;
use haze_core::assets::sprite::{Sprite, SpriteLayout, six_way_layout};
use haze_core::error::{AssetError, FieldError};
use haze_core::settings::{ImageRole, settings};

use super::asset_folders::MIN_SIMILARITY;
use super::image_cache::ImageCache;
use super::image_source::ImageSource;
use crate::builtin::{self, Builtin};

settings! {
    /// Images of a system: names of built-in ones, or PNG files beside the preset.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct MaterialSources {
        "sprite":
        /// Flipbook of normal maps: shape and outline of every puff.
        sprite: String = "puff".into(), image(ImageRole::Sprite);
        /// Depth and motion of a sprite file, with the same layout; empty for none. Built-in sprites have their own.
        detail: String = String::new(), image(ImageRole::Detail);
        /// The sprite under light from six sides, with the same layout but twice as high: right, top and front above;
        /// left, bottom and back below. A file, for built-in sprites too; empty for none. `haze sprite bake --six-way`
        /// makes it.
        six_way: String = String::new(), image(ImageRole::SixWay);
        /// Number of frames side by side in a sprite file. Built-in sprites have their own.
        columns: u32 = 1, integer(1..=256, "frames");
        /// Number of frames one below the other in a sprite file.
        rows: u32 = 1, integer(1..=256, "frames");
        /// True for a sprite file painted with green pointing down. With the wrong value, light from above lights it
        /// from below.
        y_down: bool = false, flag;
        "ramps and noise":
        /// Light by dot(n, l) and, if it has rows, by amount times boost: the colors of shade, terminator and lit
        /// side.
        diffuse_ramp: String = "diffuse_soft".into(), image(ImageRole::Ramp);
        /// The same for light from behind: a glowing rim, a dark middle.
        backlight_ramp: String = "backlight_traced_ash".into(), image(ImageRole::Ramp);
        /// Light that has come through smoke: by the smoke's optical depth and, if it has rows, by how far behind the
        /// smoke the light is.
        shadow_ramp: String = "shadow_neutral".into(), image(ImageRole::Ramp);
        /// Light by amount: the colors of thin and thick smoke, independent of the lights.
        soft_scatter_ramp: String = "scatter_mist".into(), image(ImageRole::Ramp);
        /// Glow by distance² and amount: the look of a light that shines through smoke.
        specular_ramp: String = "specular_halo".into(), image(ImageRole::Ramp);
        /// Painted lit sphere: light by paint alone.
        motif: String = "motif_studio".into(), image(ImageRole::Motif);
        /// Color by age: from flame to ash.
        age_ramp: String = "age_smoke".into(), image(ImageRole::Ramp);
        /// Heat by age: where flames end and smoke begins. White is hottest.
        heat_ramp: String = "heat_flame".into(), image(ImageRole::Ramp);
        /// Light of hot smoke, by heat and, if it has rows, by amount: the colors of flames.
        fire_ramp: String = "fire_campfire".into(), image(ImageRole::Ramp);
        /// Coverage by amount: soft, wispy or sharp silhouettes.
        coverage_ramp: String = "coverage_soft".into(), image(ImageRole::Ramp);
        /// Tiling 3D noise: a built-in one, or a PNG of slices one below the other.
        noise: String = "fbm".into(), image(ImageRole::Noise);
    }
}

impl MaterialSources {
    /// Loads all images. Built-in ones are found by their names, and the source is asked for the others.
    ///
    /// # Errors
    /// [`AssetError::Named`] with the field and the file, or [`AssetError::Field`] for a name that is neither built in nor a
    /// file inside the folder, and for more than [`MAX_IMAGE_BYTES`](super::MAX_IMAGE_BYTES).
    pub fn load(&self, source: ImageSource<'_>) -> Result<MaterialAssets, AssetError> {
        let loaded = self.load_with_cache(&mut ImageCache::new(source));
        loaded.map_err(|mut errors| errors.swap_remove(0).1)
    }

    /// As [`MaterialSources::load`], with the images that other systems have loaded already. The errors are those of all
    /// fields in order, at least one, each with its field. Images that belong to the sprite report under `sprite`.
    pub fn load_with_cache(
        &self,
        images: &mut ImageCache<'_>,
    ) -> Result<MaterialAssets, Vec<(&'static str, AssetError)>> {
        let mut errors = Vec::new();
        let sprite = ok_or_record("sprite", self.load_sprite(images), &mut errors);
        let mut ramp = |field, name: &str, list| {
            let found = match builtin::find(list, name) {
                Some(ramp) => ramp.ramp(),
                None => resolve_image_path(field, name, list).and_then(|file| images.ramp(field, file)),
            };
            ok_or_record(field, found, &mut errors)
        };
        let ramps = (
            ramp("diffuse_ramp", &self.diffuse_ramp, builtin::RAMPS),
            ramp("soft_scatter_ramp", &self.soft_scatter_ramp, builtin::RAMPS),
            ramp("specular_ramp", &self.specular_ramp, builtin::RAMPS),
            ramp("motif", &self.motif, builtin::MOTIFS),
            ramp("age_ramp", &self.age_ramp, builtin::RAMPS),
            ramp("coverage_ramp", &self.coverage_ramp, builtin::RAMPS),
            ramp("backlight_ramp", &self.backlight_ramp, builtin::RAMPS),
            ramp("shadow_ramp", &self.shadow_ramp, builtin::RAMPS),
            ramp("heat_ramp", &self.heat_ramp, builtin::RAMPS),
            ramp("fire_ramp", &self.fire_ramp, builtin::RAMPS),
        );
        let noise = match builtin::find(builtin::NOISES, &self.noise) {
            Some(noise) => images.builtin_noise(noise),
            None => {
                resolve_image_path("noise", &self.noise, builtin::NOISES).and_then(|file| images.noise("noise", file))
            }
        };
        let noise = ok_or_record("noise", noise, &mut errors);
        match (sprite, ramps, noise) {
            (
                Some(SpriteImages { sprite, detail, six_way }),
                (Some(a), Some(b), Some(c), Some(d), Some(e), Some(f), Some(g), Some(h), Some(i), Some(j)),
                Some(noise),
            ) => Ok(MaterialAssets {
                sprite,
                detail,
                six_way,
                noise,
                diffuse_ramp: a,
                soft_scatter_ramp: b,
                specular_ramp: c,
                motif: d,
                age_ramp: e,
                coverage_ramp: f,
                backlight_ramp: g,
                shadow_ramp: h,
                heat_ramp: i,
                fire_ramp: j,
            }),
            _ => Err(errors),
        }
    }

    /// Copy with default images for some fields, named as in the errors of [`MaterialSources::load_with_cache`].
    pub fn with_defaults_for(&self, fields: &[&str]) -> Self {
        let defaults = Self::default();
        let mut names = self.clone();
        for field in fields {
            let (own, defaults) = match *field {
                "diffuse_ramp" => (&mut names.diffuse_ramp, &defaults.diffuse_ramp),
                "soft_scatter_ramp" => (&mut names.soft_scatter_ramp, &defaults.soft_scatter_ramp),
                "specular_ramp" => (&mut names.specular_ramp, &defaults.specular_ramp),
                "motif" => (&mut names.motif, &defaults.motif),
                "age_ramp" => (&mut names.age_ramp, &defaults.age_ramp),
                "coverage_ramp" => (&mut names.coverage_ramp, &defaults.coverage_ramp),
                "backlight_ramp" => (&mut names.backlight_ramp, &defaults.backlight_ramp),
                "shadow_ramp" => (&mut names.shadow_ramp, &defaults.shadow_ramp),
                "heat_ramp" => (&mut names.heat_ramp, &defaults.heat_ramp),
                "fire_ramp" => (&mut names.fire_ramp, &defaults.fire_ramp),
                "noise" => (&mut names.noise, &defaults.noise),
                _ => {
                    names.detail = String::new();
                    names.six_way = String::new();
                    names.columns = 1;
                    names.rows = 1;
                    names.y_down = false;
                    (&mut names.sprite, &defaults.sprite)
                }
            };
            own.clone_from(defaults);
        }
        names
    }

    fn load_sprite(&self, images: &mut ImageCache<'_>) -> Result<SpriteImages, AssetError> {
        let ((sprite, detail), layout) = match builtin::find(builtin::SPRITES, &self.sprite) {
            Some(builtin) => (self.load_builtin(images, builtin)?, builtin.sprite_layout()?),
            None => {
                let layout = SpriteLayout { columns: self.columns, rows: self.rows, y_down: false };
                let path = resolve_image_path("sprite", &self.sprite, builtin::SPRITES)?;
                let sprite = images.sprite("sprite", path, SpriteLayout { y_down: self.y_down, ..layout })?;
                ((sprite, load_companion(images, "detail", &self.detail, layout)?), layout)
            }
        };
        let six_way = load_companion(images, "six_way", &self.six_way, six_way_layout(layout))?;
        Ok(SpriteImages { sprite, detail, six_way })
    }

    fn load_builtin(
        &self,
        images: &mut ImageCache<'_>,
        sprite: &'static Builtin,
    ) -> Result<(Sprite, Option<Sprite>), AssetError> {
        let refuse = |field: &str, value: String, expected: &str| {
            let expected = format!("{expected} with a built-in sprite, which has its own");
            Err(FieldError::new(format!("material.{field}"), value, expected).into())
        };
        if !self.detail.is_empty() {
            return refuse("detail", format!("{:?}", self.detail), "\"\"");
        }
        if (self.columns, self.rows) != (1, 1) {
            return refuse("columns and rows", format!("{}x{}", self.columns, self.rows), "1x1");
        }
        if self.y_down {
            return refuse("y_down", self.y_down.to_string(), "false");
        }
        images.builtin_sprite(sprite)
    }
}

/// Loads an image that accompanies a sprite, if one is named.
fn load_companion(
    images: &mut ImageCache<'_>,
    field: &'static str,
    name: &str,
    layout: SpriteLayout,
) -> Result<Option<Sprite>, AssetError> {
    if name.is_empty() {
        return Ok(None);
    }
    Ok(Some(images.sprite(field, resolve_image_path(field, name, &[])?, layout)?))
}

/// Sprite with its accompanying images.
struct SpriteImages {
    sprite: Sprite,
    detail: Option<Sprite>,
    six_way: Option<Sprite>,
}

/// File that the name of an image stands for, relative to the preset's folder. `None` for built-in images and for files
/// outside.
pub fn image_file_path(name: &str) -> Option<&Path> {
    let path = Path::new(name);
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (is_png && stays).then_some(path)
}

/// File that a name stands for, relative to the preset's folder.
fn resolve_image_path<'a>(field: &str, name: &'a str, list: &[Builtin]) -> Result<&'a Path, AssetError> {
    if let Some(path) = image_file_path(name) {
        return Ok(path);
    }
    let mut expected = "a PNG inside the preset's folder".to_owned();
    if !list.is_empty() {
        let names: Vec<_> = list.iter().map(|builtin| builtin.name).collect();
        let small = name.to_ascii_lowercase();
        let alike = names.iter().map(|other| (strsim::jaro_winkler(&small, other), other));
        let nearest = alike.filter(|(alike, _)| *alike >= MIN_SIMILARITY).max_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = nearest.map(|(_, name)| format!("; the nearest name is {name:?}")).unwrap_or_default();
        expected = format!("one of {}, or {expected}{nearest}", names.join(", "));
    }
    Err(FieldError::new(format!("material.{field}"), format!("{name:?}"), expected).into())
}

/// Returns the value, or records the error.
fn ok_or_record<T>(
    field: &'static str,
    found: Result<T, AssetError>,
    errors: &mut Vec<(&'static str, AssetError)>,
) -> Option<T> {
    found.map_err(|error| errors.push((field, error))).ok()
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::ops::RangeInclusive;

    use haze_core::glam::Vec3;

    use super::*;
    use haze_core::assets::ramp::RampRole;
    use haze_core::settings::{FieldVisitor, Fields};

    #[test]
    fn every_field_for_a_ramp_has_a_role_and_a_default_of_that_role() {
        struct Roles(Vec<RampRole>);
        impl FieldVisitor for Roles {
            fn number(&mut self, _: &'static str, _: &mut f32, _: RangeInclusive<f32>, _: &'static str) {}
            fn integer(&mut self, _: &'static str, _: &mut u32, _: RangeInclusive<u32>, _: &'static str) {}
            fn vector(&mut self, _: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {}
            fn group(&mut self, _: &'static str, _: &mut dyn Fields) {}
            fn item(&mut self, _: &'static str, _: usize, _: &mut dyn Fields) {}
            fn image(&mut self, name: &'static str, value: &mut String, role: ImageRole) {
                let wanted = RampRole::from_field(name);
                assert_eq!(wanted.is_some(), role == ImageRole::Ramp, "{name}");
                assert!(wanted.is_none() || wanted == RampRole::from_name(value), "{name} {value}");
                self.0.extend(wanted);
            }
        }
        let mut roles = Roles(Vec::new());
        MaterialSources::default().visit(&mut roles);
        assert_eq!(roles.0.len(), RampRole::ALL.len());
    }

    #[test]
    fn images_can_come_from_a_host() {
        let mut png = Vec::new();
        image::RgbImage::new(2, 1).write_to(&mut io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
        let names = MaterialSources { diffuse_ramp: "packed/own.png".to_owned(), ..MaterialSources::default() };
        let mut asked = Vec::new();
        let mut read = |name: &Path| {
            asked.push(name.to_owned());
            Ok(png.clone())
        };
        let loaded = names.load(ImageSource::Reader(&mut read));
        // Built-in images are not asked for.
        assert_eq!(asked, [Path::new("packed/own.png")]);
        assert_eq!(loaded.unwrap().diffuse_ramp.size(), haze_core::glam::UVec2::new(2, 1));
        let absent =
            names.load(ImageSource::Reader(&mut |_| Err(io::ErrorKind::NotFound.into()))).unwrap_err().to_string();
        assert!(absent.starts_with("material.diffuse_ramp: packed/own.png: "), "{absent}");
        let broken = names.load(ImageSource::Reader(&mut |_| Ok(b"no image".to_vec()))).unwrap_err().to_string();
        assert!(broken.starts_with("material.diffuse_ramp: packed/own.png: "), "{broken}");
        let large = names.load(ImageSource::Reader(&mut |_| Ok(vec![0; (64 << 20) + 1]))).unwrap_err().to_string();
        assert!(large.contains("at most 64 MiB"), "{large}");
        let alone = names.load(ImageSource::BuiltIn).unwrap_err().to_string();
        assert!(alone.starts_with("material.diffuse_ramp: packed/own.png: no folder to search"), "{alone}");
        assert!(MaterialSources::default().load(ImageSource::BuiltIn).is_ok());
    }

    #[test]
    fn image_files_stay_inside_the_presets_folder() {
        assert_eq!(resolve_image_path("sprite", "a/b.png", &[]).unwrap(), Path::new("a/b.png"));
        for outside in ["../b.png", "/etc/b.png", "a/../../b.png", "puf", "b.jpg"] {
            assert!(resolve_image_path("sprite", outside, builtin::SPRITES).is_err(), "{outside}");
        }
        let said = resolve_image_path("sprite", "Wisps", builtin::SPRITES).unwrap_err().to_string();
        assert!(said.ends_with("inside the preset's folder; the nearest name is \"wisp\""), "{said}");
        let said = resolve_image_path("sprite", "b.jpg", builtin::SPRITES).unwrap_err().to_string();
        assert!(said.ends_with("inside the preset's folder"), "{said}");
    }
}
