//! Origin of a sprite: reads, checks, bakes, writes and copies its files.

use std::path::{Path, PathBuf};

use haze::FieldError;
use haze_author::simulation::SimRecipe;
use haze_author::sprite::bake::{BakedSprite, SpriteRecipe};
use haze_author::sprite::lint::lint_sprite;
use haze_core::assets::image::decode_png;
use haze_core::assets::json;
use haze_core::assets::sprite::SpriteLayout;
use haze_core::error::{Error, builtin_path};
use haze_preset::builtin::{self, Builtin};
use haze_preset::encode_baked_png;
use image::RgbaImage;
use serde::{Deserialize, Serialize};

use crate::platform::asset_loading::sprite_recipe;
use crate::platform::file_io::{self, Stamp, read_png};
use crate::platform::portable_job::PortableJob;

/// Origin of a sprite, which decides whether it can be edited.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpriteOrigin {
    /// Not known yet.
    Reading,
    /// Embedded in the program.
    BuiltIn(SpriteRecipe),
    /// Made from a recipe, which can be edited.
    Recipe(SpriteRecipe),
    /// The recipe beside it makes another image: another program has changed one of the two.
    Apart(SpriteRecipe),
    /// Made from a simulation beside it.
    Simulated(Box<SimRecipe>),
    /// There is no recipe beside it.
    Painted,
    /// Unreadable.
    Missing,
}

/// Stamps of the image, its detail image, the recipe and the simulation.
pub type Stamps = [Option<Stamp>; 4];

/// Sprite as read from its files.
#[derive(Serialize, Deserialize)]
pub struct SpriteState {
    pub source: SpriteOrigin,
    /// Findings of the check of the image, one per line.
    pub findings: Vec<String>,
    /// Error in the recipe's file.
    pub broken: Option<String>,
}

/// Returns `mine.sprite.json` for `mine.png`.
pub fn recipe_of(image: &Path) -> PathBuf {
    image.with_extension("sprite.json")
}

/// Returns `mine.sim.json` for `mine.png`.
pub fn simulation_of(image: &Path) -> PathBuf {
    image.with_extension("sim.json")
}

/// Returns `mine.detail.png` for `mine.png`.
pub fn detail_of(image: &Path) -> PathBuf {
    image.with_extension("detail.png")
}

pub fn stamps(image: &Path) -> Stamps {
    [image, &detail_of(image), &recipe_of(image), &simulation_of(image)].map(Stamp::of)
}

/// Job that reads a sprite and its recipe, and bakes it to compare both.
#[derive(Serialize, Deserialize)]
pub struct ReadSprite {
    pub name: String,
    pub image: PathBuf,
    /// The one in the preset.
    pub layout: SpriteLayout,
}

impl PortableJob for ReadSprite {
    const NAME: &'static str = "read_sprite";
    type Output = SpriteState;

    fn reads(&self) -> Vec<PathBuf> {
        vec![self.image.clone(), recipe_of(&self.image), simulation_of(&self.image)]
    }

    fn run(self, _: &dyn Fn(u32) -> bool) -> SpriteState {
        let (source, findings, broken) = match builtin::find(builtin::SPRITES, &self.name) {
            Some(found) => {
                built_in(found).unwrap_or_else(|error| (SpriteOrigin::Missing, vec![error.to_string()], None))
            }
            None => file(&self.image, self.layout),
        };
        SpriteState { source, findings, broken }
    }
}

type Found = (SpriteOrigin, Vec<String>, Option<String>);

fn built_in(found: &Builtin) -> Result<Found, Error> {
    let path = builtin_path(found.name);
    let recipe = recipe_of_built_in(found.name)?;
    let findings = findings(&path, &decode_png(&path, found.bytes)?.to_rgba8(), recipe.layout());
    Ok((SpriteOrigin::BuiltIn(recipe), findings, None))
}

fn file(image: &Path, layout: SpriteLayout) -> Found {
    let sheet = match read_png(image) {
        Ok(sheet) => sheet.to_rgba8(),
        Err(error) => return (SpriteOrigin::Missing, vec![error.to_string()], None),
    };
    let recipe = recipe_of(image);
    let (source, layout, broken) = match file_io::exists(&recipe).then(|| sprite_recipe(&recipe)) {
        None => {
            let (source, broken) = simulated(image);
            (source, layout, broken)
        }
        Some(Err(error)) => (SpriteOrigin::Painted, layout, Some(error.to_string())),
        Some(Ok(recipe)) if makes(&recipe, &sheet) => {
            let layout = recipe.layout();
            (SpriteOrigin::Recipe(recipe), layout, None)
        }
        Some(Ok(recipe)) => (SpriteOrigin::Apart(recipe), layout, None),
    };
    (source, findings(image, &sheet, layout), broken)
}

/// Returns the simulation beside an image, or the error in its file.
fn simulated(image: &Path) -> (SpriteOrigin, Option<String>) {
    let recipe = simulation_of(image);
    if !file_io::exists(&recipe) {
        return (SpriteOrigin::Painted, None);
    }
    match SimRecipe::load(&recipe) {
        Ok(recipe) => (SpriteOrigin::Simulated(Box::new(recipe)), None),
        Err(error) => (SpriteOrigin::Painted, Some(error.to_string())),
    }
}

/// Returns true if a recipe makes a sheet.
fn makes(recipe: &SpriteRecipe, sheet: &RgbaImage) -> bool {
    if sheet.dimensions() != (recipe.size * recipe.columns, recipe.size * recipe.rows) {
        return false;
    }
    recipe.bake(|_| Ok::<_, FieldError>(())).is_ok_and(|baked| baked.image == *sheet)
}

/// Returns the findings of a check of a sheet.
fn findings(path: &Path, sheet: &RgbaImage, layout: SpriteLayout) -> Vec<String> {
    match lint_sprite(path, sheet, layout) {
        Ok(findings) => {
            findings.into_iter().map(|finding| format!("{}: {}", finding.name, finding.description)).collect()
        }
        Err(error) => vec![error.to_string()],
    }
}

/// Job that bakes a recipe in full.
#[derive(Serialize, Deserialize)]
pub struct BakeSprite {
    pub recipe: SpriteRecipe,
    /// Image that it is baked for.
    pub image: PathBuf,
}

/// Contents of the files of a baked sprite.
#[derive(Serialize, Deserialize)]
pub struct BakedFiles {
    pub image: Vec<u8>,
    pub detail: Vec<u8>,
    /// Findings of the check of the image, one per line.
    pub findings: Vec<String>,
}

/// Reason why nothing was baked.
#[derive(Serialize, Deserialize)]
pub enum NotBaked {
    Stopped,
    /// The fields of a [`FieldError`].
    Refused {
        field: String,
        problem: String,
        expected: String,
    },
}

impl From<FieldError> for NotBaked {
    fn from(FieldError { field, problem, expected, .. }: FieldError) -> Self {
        Self::Refused { field, problem, expected }
    }
}

impl PortableJob for BakeSprite {
    const NAME: &'static str = "bake_sprite";
    type Output = Result<BakedFiles, NotBaked>;

    fn stopped() -> Option<Self::Output> {
        Some(Err(NotBaked::Stopped))
    }

    fn run(self, progress: &dyn Fn(u32) -> bool) -> Self::Output {
        let Self { recipe, image } = self;
        let baked = recipe.bake(|frames| if progress(frames) { Ok(()) } else { Err(NotBaked::Stopped) })?;
        encode(&image, recipe.layout(), baked).map_err(|error| {
            let expected = "an image that can be written as PNG";
            FieldError::from_problem("sprite", error.to_string(), expected).into()
        })
    }
}

/// Checks and encodes a baked sprite.
pub fn encode(image: &Path, layout: SpriteLayout, baked: BakedSprite) -> Result<BakedFiles, Error> {
    Ok(BakedFiles {
        findings: findings(image, &baked.image, layout),
        image: encode_baked_png(image, &baked.image.into())?,
        detail: encode_baked_png(&detail_of(image), &baked.detail.into())?,
    })
}

/// Writes the recipe first, because the images can be made again from it.
pub fn write(image: &Path, recipe: &SpriteRecipe, baked: &BakedFiles) -> Result<(), Error> {
    file_io::write(&recipe_of(image), recipe.to_json().as_bytes())?;
    file_io::write(&detail_of(image), &baked.detail)?;
    file_io::write(image, &baked.image)
}

/// Returns the recipe of a built-in sprite.
pub fn recipe_of_built_in(name: &str) -> Result<SpriteRecipe, Error> {
    let recipe = builtin::find(builtin::SPRITES, name).map_or("", |builtin| builtin.recipe);
    Ok(json::parse(&builtin_path(name), recipe)?)
}

/// Writes a copy of a built-in sprite beside a preset under a free name, and returns the name.
pub fn copy(name: &str, preset: &Path) -> Result<String, Error> {
    let folder = preset.parent().unwrap_or(Path::new(""));
    let file = file_io::free_copy_name(name, |file| {
        let image = folder.join(file);
        [image.clone(), detail_of(&image), recipe_of(&image)].iter().all(|path| !file_io::is_taken(path))
    });
    let image = folder.join(&file);
    let find = |list| builtin::find(list, name);
    if let Some((sprite, detail)) = find(builtin::SPRITES).zip(find(builtin::DETAILS)) {
        file_io::write(&recipe_of(&image), sprite.recipe.as_bytes())?;
        file_io::write(&detail_of(&image), detail.bytes)?;
        file_io::write(&image, sprite.bytes)?;
    }
    Ok(file)
}
