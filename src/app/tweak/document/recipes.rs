//! The recipes of ramps that were changed here, beside the preset.

use std::collections::BTreeMap;
use std::sync::Arc;

use haze::preset::Preset;
use haze::ramp::bake::RampRecipe;

use super::difference::step_name;

/// By the names that the preset has for their pictures. A clone is cheap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recipes(BTreeMap<String, Arc<RampRecipe>>);

impl Recipes {
    pub fn get(&self, name: &str) -> Option<&RampRecipe> {
        self.0.get(name).map(|recipe| &**recipe)
    }

    pub fn set(&mut self, name: &str, recipe: RampRecipe) {
        self.0.insert(name.into(), Arc::new(recipe));
    }

    /// Its picture is another's work now.
    pub fn forget(&mut self, name: &str) {
        self.0.remove(name);
    }
}

/// What steps are made of: the preset, and the recipes.
pub type Work = (Preset, Recipes);

/// What a step is called.
pub fn name_of(before: &Work, after: &Work) -> String {
    let names = after.1.0.keys().chain(before.1.0.keys());
    match names.into_iter().find(|name| before.1.get(name) != after.1.get(name)) {
        Some(name) if before.0 == after.0 => format!("stops of {name}"),
        _ => step_name(&before.0, &after.0),
    }
}
