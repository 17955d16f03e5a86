//! Recipes of images beside the preset that were edited in this session.

use std::collections::BTreeMap;
use std::sync::Arc;

use haze_author::ramp::RampRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_preset::Preset;

use super::display_names::sentence_case;
use super::preset_diff::step_name;

/// Edited recipes of every kind. Cheap to clone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recipes {
    pub ramps: RecipeMap<RampRecipe>,
    pub sprites: RecipeMap<SpriteRecipe>,
}

/// Recipes by the names that the preset has for their images.
#[derive(Clone, Debug, PartialEq)]
pub struct RecipeMap<T>(BTreeMap<String, Arc<T>>);

impl<T> Default for RecipeMap<T> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T: PartialEq> RecipeMap<T> {
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.get(name).map(|recipe| &**recipe)
    }

    pub fn set(&mut self, name: &str, recipe: T) {
        self.0.insert(name.into(), Arc::new(recipe));
    }

    /// Removes a recipe: its image was changed elsewhere, or is as it was read.
    pub fn forget(&mut self, name: &str) {
        self.0.remove(name);
    }

    /// Returns the first name whose recipe has changed.
    fn changed<'a>(&'a self, before: &'a Self) -> Option<&'a str> {
        let mut names = self.0.keys().chain(before.0.keys());
        names.find(|name| before.get(name) != self.get(name)).map(String::as_str)
    }
}

/// Value of an undo step: the preset and the recipes.
pub type Work = (Preset, Recipes);

/// Ramp, and the gradient editor's name for the change of its stops.
pub type GradientStep = (String, &'static str);

/// Returns the name of a step. If it changed stops, the name is that of the gradient editor.
pub fn step_name_of_work(before: &Work, after: &Work, step: Option<&GradientStep>) -> String {
    // A changed recipe also changes the preset's columns and rows, so recipes are tested first.
    if let Some(name) = after.1.sprites.changed(&before.1.sprites) {
        return format!("Recipe of {name}");
    }
    match after.1.ramps.changed(&before.1.ramps) {
        Some(name) if before.0 == after.0 => match step.filter(|(of, _)| of == name) {
            Some((_, step)) => format!("{}: {name}", sentence_case(step)),
            None => format!("Stops of {name}"),
        },
        _ => step_name(&before.0, &after.0),
    }
}
