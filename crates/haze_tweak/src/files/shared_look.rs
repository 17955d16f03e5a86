//! Looks that links hold: made from a session, and opened as one.

use std::path::Path;

use haze::FieldError;
use haze_author::backdrop::backdrop_names;
use haze_core::error::Error;
use haze_export::inputs::relative_image_paths;
use haze_export::share_link::Look;
use haze_preset::builtin;

use crate::document::Document;
use crate::document::ramp_edits::{self, RampOrigin};
use crate::platform::file_io;
use crate::session::Session;

/// Returns the part of a link after `#` for the present look.
///
/// # Errors
/// If the look has files of its own other than ramps with recipes, or is too large for a link.
pub fn fragment_of(session: &mut Session) -> Result<String, FieldError> {
    let preset = session.document.preset.clone();
    for (index, system) in preset.systems.iter().enumerate() {
        if system.particle_files.is_used() {
            let problem = format!("systems[{index}] has particle files");
            return Err(refuse(problem, "an emitter; save the preset as a file instead"));
        }
    }
    if let Some((_, field, _)) = backdrop_names(&preset.environment).iter().find(|(.., name)| !name.is_empty()) {
        let expected = "the demo scene and a sky of colors; save the preset as a file instead";
        return Err(refuse(format!("{field} names a file"), expected));
    }
    let folders = session.folders();
    let mut ramps = std::collections::BTreeMap::new();
    for file in relative_image_paths(&preset) {
        let name = file.to_string_lossy().into_owned();
        let edited = session.document.recipes.ramps.get(&name).cloned();
        let recipe = match session.ramps.source(&name, &folders) {
            RampOrigin::Recipe(recipe) => edited.unwrap_or_else(|| recipe.clone()),
            _ => {
                let expected = "built-in images and ramps with a recipe; save the preset as a file instead";
                return Err(refuse(format!("{name} is an image of its own"), expected));
            }
        };
        ramps.insert(name, recipe);
    }
    let path = session.document.path().to_str();
    let own = path.and_then(|name| builtin::find(builtin::PRESETS, name));
    let look = Look { base: own.map_or("column", |preset| preset.name), preset, ramps };
    if own.is_some() {
        return look.to_fragment();
    }
    // Any built-in preset may be nearest to a file.
    let others = builtin::PRESETS.iter().filter_map(|base| Look { base: base.name, ..look.clone() }.to_fragment().ok());
    others.min_by_key(String::len).map_or_else(|| look.to_fragment(), Ok)
}

fn refuse(problem: String, expected: &str) -> FieldError {
    FieldError::from_problem("link", problem, expected)
}

/// Opens the look of a link as unsaved work. If it has ramps of its own, it becomes a file beside them in `folder`.
///
/// # Errors
/// If the link is not valid, or the ramps cannot be written.
pub fn open(fragment: &str, folder: &Path) -> Result<Session, Error> {
    let Look { base, preset, ramps } = Look::from_fragment(fragment)?;
    if ramps.is_empty() {
        return Session::show(Document::recovered(preset, Path::new(base)), None);
    }
    let path = folder.join(base).with_extension("json");
    file_io::make_folder(folder)?;
    for (name, recipe) in &ramps {
        ramp_edits::write(&folder.join(name), recipe, &recipe.bake()?)?;
    }
    file_io::write(&path, preset.to_json("").as_bytes())?;
    Session::open(&path, None)
}
