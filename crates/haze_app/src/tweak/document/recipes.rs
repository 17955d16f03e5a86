//! The recipes of pictures that were changed here, beside the preset.

use std::collections::BTreeMap;
use std::sync::Arc;

use haze::preset::Preset;
use haze_author::ramp::bake::RampRecipe;
use haze_author::sprite::bake::SpriteRecipe;

use super::difference::step_name;

/// Those of every kind. A clone is cheap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recipes {
    pub ramps: Of<RampRecipe>,
    pub sprites: Of<SpriteRecipe>,
}

/// By the names that the preset has for their pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Of<T>(BTreeMap<String, Arc<T>>);

impl<T> Default for Of<T> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T: PartialEq> Of<T> {
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.get(name).map(|recipe| &**recipe)
    }

    pub fn set(&mut self, name: &str, recipe: T) {
        self.0.insert(name.into(), Arc::new(recipe));
    }

    /// Its picture is another's work now, or as it was read.
    pub fn forget(&mut self, name: &str) {
        self.0.remove(name);
    }

    /// The first that is not as it was.
    fn changed<'a>(&'a self, before: &'a Self) -> Option<&'a str> {
        let mut names = self.0.keys().chain(before.0.keys());
        names.find(|name| before.get(name) != self.get(name)).map(String::as_str)
    }
}

/// What steps are made of: the preset, and the recipes.
pub type Work = (Preset, Recipes);

/// A change of a ramp's stops, as the editor of gradients calls it, and the ramp that it is made to.
pub type GradientStep = (String, &'static str);

/// What a step is called; one of stops by what the editor says, if that is what has changed.
pub fn name_of(before: &Work, after: &Work, step: Option<&GradientStep>) -> String {
    // The preset's columns and rows follow those of the recipe.
    if let Some(name) = after.1.sprites.changed(&before.1.sprites) {
        return format!("recipe of {name}");
    }
    match after.1.ramps.changed(&before.1.ramps) {
        Some(name) if before.0 == after.0 => match step.filter(|(of, _)| of == name) {
            Some((_, step)) => format!("{step}: {name}"),
            None => format!("stops of {name}"),
        },
        _ => step_name(&before.0, &after.0),
    }
}
