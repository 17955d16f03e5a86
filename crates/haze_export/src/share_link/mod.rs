//! A look as a link: the difference of a preset from a built-in one, and the recipes of its own ramps.
//!
//! The link is an address, `#`, the digit of the version, and the look: JSON with the keys `b` (name of the built-in preset),
//! `d` (difference from it) and `r` (recipes of ramps by the names of their images), packed by `packed_text`. A page shows
//! the look after `#` in its own address.

mod json_diff;
mod packed_text;

use std::collections::BTreeMap;
use std::path::Path;

use haze::FieldError;
use haze_author::ramp::RampRecipe;
use haze_core::error::Error;
use haze_core::settings::rename_old_keys;
use haze_preset::{Preset, builtin};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Digit before the look.
const VERSION: char = '1';

/// Most characters after `#`: with the page's address a link stays below 2,000, which chats and mail programs leave whole.
const MAX_LENGTH: usize = 1800;

/// Most texels of a ramp's image, which is baked when the link is opened.
const MAX_TEXELS: u32 = 1 << 20;

/// A look that a link holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Name of the built-in preset that it differs from.
    pub base: &'static str,
    /// The whole look.
    pub preset: Preset,
    /// Recipes of ramps that the preset names, by the file names of their images.
    pub ramps: BTreeMap<String, RampRecipe>,
}

/// Earlier names of built-in presets, which links may have, and their names now.
const RENAMED: [(&str, &str); 1] = [("explosion", "colored_lights")];

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Packed {
    b: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    d: Option<Value>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    r: BTreeMap<String, Value>,
}

/// Returns the part of a text after `#`, if the text is a link of any version.
pub fn fragment(text: &str) -> Option<&str> {
    let (_, fragment) = text.rsplit_once('#')?;
    fragment.starts_with(|first: char| first.is_ascii_digit()).then_some(fragment)
}

/// Returns the part after `#` of a link instead of a preset's name. A file may have the name of a link.
pub fn fragment_of_name(name: &Path) -> Option<&str> {
    name.to_str().filter(|_| !name.exists()).and_then(fragment)
}

impl Look {
    /// Returns the part of the link after `#`.
    ///
    /// # Errors
    /// If the look is too large for a link.
    pub fn to_fragment(&self) -> Result<String, FieldError> {
        let too_long = |found: &str| {
            let expected = format!("at most {MAX_LENGTH} characters; save the preset as a file instead");
            FieldError::from_problem("link", format!("this look takes {found}"), expected)
        };
        let ramps = self.ramps.iter().map(|(name, recipe)| (name.clone(), json_of(recipe)));
        let packed = Packed {
            b: self.base.into(),
            d: json_diff::difference(&json_of(&base(self.base)?), &json_of(&self.preset)),
            r: ramps.collect(),
        };
        let text = serde_json::to_string(&packed).unwrap_or_default();
        let packed = packed_text::pack(&text).ok_or_else(|| too_long("too many characters"))?;
        let fragment = format!("{VERSION}{packed}");
        if fragment.len() > MAX_LENGTH {
            return Err(too_long(&format!("{} characters", fragment.len())));
        }
        Ok(fragment)
    }

    /// Reads the part of a link after `#`. Nothing is loaded.
    ///
    /// # Errors
    /// If the link is of another version, was damaged, or describes an invalid preset or ramp.
    pub fn from_fragment(fragment: &str) -> Result<Self, Error> {
        let refuse = |problem: &str, expected: &str| FieldError::from_problem("link", problem, expected);
        let whole = "a whole link, as it was copied";
        if fragment.len() > MAX_LENGTH {
            let problem = format!("{} characters are too many", fragment.len());
            return Err(refuse(&problem, &format!("at most {MAX_LENGTH}")).into());
        }
        let packed = fragment
            .strip_prefix(VERSION)
            .ok_or_else(|| refuse("it is of a version that this program does not know", "a link of version 1"))?;
        let damaged = || refuse("it is damaged", whole);
        let text = packed_text::unpack(packed).ok_or_else(damaged)?;
        let Packed { b, d, r } = serde_json::from_str(&text).map_err(|_| damaged())?;
        let name = RENAMED.iter().find(|(old, _)| *old == b).map_or(b.as_str(), |(_, new)| new);
        let name = builtin::find(builtin::PRESETS, name).ok_or_else(damaged)?.name;
        let mut json = json_of(&base(name)?);
        if let Some(mut difference) = d {
            rename_old_keys(&mut difference);
            if !json_diff::apply(&mut json, difference) {
                return Err(damaged().into());
            }
        }
        let preset = Preset::parse(Path::new("link"), &json.to_string())?;
        let mut ramps = BTreeMap::new();
        for (name, recipe) in r {
            if !is_image_name(&name) {
                let problem = format!("{name:?} is not valid for a ramp");
                return Err(refuse(&problem, "letters, digits, _ and -, with the ending .png").into());
            }
            let recipe = RampRecipe::parse(Path::new(&name), &recipe.to_string())?;
            if recipe.width.saturating_mul(recipe.height) > MAX_TEXELS {
                let problem = format!("{name} has {}x{} texels", recipe.width, recipe.height);
                return Err(refuse(&problem, &format!("at most {MAX_TEXELS}")).into());
            }
            ramps.insert(name, recipe);
        }
        Ok(Self { base: name, preset, ramps })
    }
}

/// Returns true for a plain file name, which leads nowhere else.
fn is_image_name(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    name.strip_suffix(".png").is_some_and(|stem| !stem.is_empty() && stem.chars().all(is_plain))
}

/// Loads a built-in preset.
fn base(name: &str) -> Result<Preset, FieldError> {
    Preset::load(name).map_err(|error| FieldError::from_problem("link", error.to_string(), "a built-in preset"))
}

/// Converts by way of text: numbers then have the digits of `f32`.
fn json_of(value: &impl Serialize) -> Value {
    serde_json::to_string(value).ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests;
