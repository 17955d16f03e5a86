//! Sprite recipes by name or path.

use std::path::{Path, PathBuf};

use haze::FieldError;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::error::Error;
use haze_preset::builtin;

use super::recipe_files::has_extension;

/// Loads a sprite recipe: a file, or a built-in one by name.
///
/// # Errors
/// As [`SpriteRecipe::load`], and if the name is neither a file nor built in.
pub fn sprite_recipe(name: &Path) -> Result<SpriteRecipe, Error> {
    if has_extension(name, "json") {
        return Ok(SpriteRecipe::load(name)?);
    }
    let builtin = name.to_str().and_then(|name| builtin::find(builtin::SPRITES, name));
    let names: Vec<_> = builtin::SPRITES.iter().map(|sprite| sprite.name).collect();
    let expected = || format!("a *.sprite.json file, or one of {}", names.join(", "));
    let builtin = builtin.ok_or_else(|| FieldError::new("--sprite", name.display(), expected()))?;
    Ok(SpriteRecipe::of_builtin(builtin)?)
}

/// The sprite that is traced if none is named.
pub fn default_sprite() -> PathBuf {
    "billow".into()
}
