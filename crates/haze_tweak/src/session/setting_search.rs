//! Search for settings by name or tooltip.

use haze_author::preset::Tooltips;
use haze_core::settings::{field_path, for_each_field};
use haze_preset::Preset;

use super::light_view::LightView;
use super::look_controls::{ControlTarget, LOOK_SECTIONS};
use super::view_options::Tab;
use crate::document::display_names::display_name;
use crate::document::light_defaults::light_name;

/// Largest number of results.
const MAX_RESULTS: usize = 12;

/// State of the search.
#[derive(Default)]
pub struct SettingSearch {
    pub is_open: bool,
    pub text: String,
    /// Index of the selected result.
    pub chosen: usize,
    /// Path of the setting that was found last, and the number of frames for which it is still brought into view.
    pub found: Option<(String, u32)>,
}

/// Number of frames that collapsed sections need to open and scroll.
const SCROLL_FRAMES: u32 = 60;

impl SettingSearch {
    pub fn open(&mut self) {
        *self = Self { is_open: true, ..Self::default() };
    }

    /// Brings a setting into view.
    pub fn go_to(&mut self, path: String) {
        *self = Self { found: Some((path, SCROLL_FRAMES)), ..Self::default() };
    }

    /// Returns true while a setting is to be brought into view. Call once a frame.
    pub fn advance(&mut self) -> bool {
        if let Some((_, frames)) = &mut self.found {
            *frames -= 1;
            if *frames == 0 {
                self.found = None;
            }
        }
        self.found.is_some()
    }
}

/// Result of a search.
pub struct SearchResult {
    pub path: String,
    /// Name with its location: "Soft fade: Fade scale".
    pub name: String,
    pub tooltip: String,
    /// Tab that shows it.
    pub tab: Tab,
}

/// Words that no setting has, or few, and words of the settings that come nearest.
const SYNONYMS: [(&str, &[&str]); 29] = [
    ("additive", &["blend"]),
    ("alpha", &["opacity", "thickness"]),
    ("animation", &["frame", "flipbook"]),
    ("blur", &["softness", "scale"]),
    ("brightness", &["exposure", "intensity"]),
    ("color", &["color"]),
    ("count", &["rate"]),
    ("density", &["thickness"]),
    ("detail", &["grain"]),
    ("distortion", &["heat"]),
    ("fog", &["thickness", "scatter"]),
    ("gravity", &["buoyancy", "rise"]),
    ("hue", &["color", "tonemap"]),
    ("lamp", &["kind"]),
    ("life", &["age"]),
    ("opacity", &["thickness"]),
    ("over", &["age"]),
    ("quality", &["scale"]),
    ("resolution", &["scale"]),
    ("rotation", &["spin"]),
    ("shimmer", &["heat"]),
    ("size", &["radius"]),
    ("speed", &["velocity", "wind"]),
    ("sun", &["kind"]),
    ("temperature", &["heat", "color"]),
    ("texture", &["sprite"]),
    ("transparency", &["opacity", "thickness"]),
    ("vortex", &["ring", "orbit", "turbulence"]),
    ("zoom", &["fov"]),
];

/// Text that is searched for, as words in lower case.
struct Query {
    text: String,
    words: Vec<String>,
}

/// Returns the words of a text in lower case.
fn words(text: &str) -> Vec<String> {
    text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

impl Query {
    fn new(text: &str) -> Self {
        Self { text: text.trim().to_lowercase(), words: words(text) }
    }

    /// Returns true if each word of the query begins a word of the text. With `is_loose`, a synonym may stand for it.
    fn is_in(&self, text: &str, is_loose: bool) -> bool {
        let text = words(text);
        let has = |word: &str| text.iter().any(|own| own.starts_with(word));
        let has_synonym = |word: &str| {
            let near = SYNONYMS.iter().filter(|(absent, _)| is_loose && word.len() > 2 && absent.starts_with(word));
            near.flat_map(|(_, near)| near.iter()).any(|near| has(near))
        };
        self.words.iter().all(|word| has(word) || has_synonym(word))
    }

    /// Returns the rank of a setting, the best first; `None` if it does not match.
    fn rank(&self, name: &str, position: &str, path: &str, tooltip: &str) -> Option<u32> {
        let whole = format!("{position} {name} {path}");
        match () {
            () if name.to_lowercase().starts_with(&self.text) => Some(0),
            () if self.is_in(name, false) => Some(1),
            () if self.is_in(&whole, false) => Some(2),
            () if self.is_in(&whole, true) => Some(3),
            () if self.is_in(tooltip, false) => Some(IN_TOOLTIP),
            () => None,
        }
    }
}

/// Rank of a setting that only its description matches. Such results are shown if there are no others.
const IN_TOOLTIP: u32 = 4;

/// Returns settings whose names contain the words of a text, those that begin with it first; then those in a location of
/// such a name, those with a similar word, or else those whose descriptions contain them. Controls of the look tab are
/// also found by their names there; `lights` tells which light is the key light.
pub fn matches(preset: &Preset, tooltips: &Tooltips, lights: &LightView, text: &str) -> Vec<SearchResult> {
    let query = Query::new(text);
    let has_many = preset.systems.len() > 1;
    let mut found = Vec::new();
    for (index, system) in preset.systems.iter().enumerate() {
        let sections = LOOK_SECTIONS.iter().filter(|section| section.is_shown(system, index, |_| false));
        for control in sections.flat_map(|section| section.controls) {
            let Some(path) = control.path(index, lights.key_light(preset, index)) else { continue };
            let (is_made, tooltip) = match control.target {
                ControlTarget::Macro(made) => (true, made.tooltip),
                _ => (false, tooltips.field(&plain(&path)).unwrap_or_default()),
            };
            // A control that is named like its field is found below.
            if is_made || !path.ends_with(&format!(".{}", control.name.replace(' ', "_"))) {
                let position = if has_many { format!("Look of {}", system.name) } else { "Look".into() };
                if let Some(rank) = query.rank(control.name, &position, "", "") {
                    let name = format!("{position}: {}", display_name(control.name));
                    found.push((rank, SearchResult { path, name, tooltip: tooltip.into(), tab: Tab::Look }));
                }
            }
        }
    }
    for_each_field(&mut preset.clone(), &mut |steps, _| {
        let path = field_path(steps);
        // The preset's own name and description are on no tab.
        let Some((name, groups)) = steps.split_last().filter(|(_, groups)| !groups.is_empty()) else { return };
        let own = display_name(name.0);
        let position = location_of(preset, groups);
        let tooltip = tooltips.field(&plain(&path)).unwrap_or_default();
        if let Some(rank) = query.rank(&own, &position, &path, tooltip) {
            let name = format!("{position}: {own}");
            let tab = tab_of(&path);
            found.push((rank, SearchResult { path, name, tooltip: tooltip.into(), tab }));
        }
    });
    found.sort_by_key(|(rank, _)| *rank);
    if found.first().is_some_and(|(rank, _)| *rank < IN_TOOLTIP) {
        found.retain(|(rank, _)| *rank < IN_TOOLTIP);
    }
    found.truncate(MAX_RESULTS);
    found.into_iter().map(|(_, found)| found).collect()
}

/// Returns a path without the indices of lists.
fn plain(path: &str) -> String {
    let parts = path.split('.').map(|step| step.split('[').next().unwrap_or(step));
    parts.collect::<Vec<_>>().join(".")
}

/// Returns the location of a field in words: the name of its light, or its system, if there are several, and its groups.
fn location_of(preset: &Preset, groups: &[(&'static str, Option<usize>)]) -> String {
    let mut names = Vec::new();
    for (list, index) in groups {
        match (*list, *index) {
            ("lights", Some(index)) => names.extend(preset.lights.get(index).map(|light| light_name(index, light))),
            ("systems", Some(index)) => {
                let system = preset.systems.get(index).filter(|_| preset.systems.len() > 1 || groups.len() == 1);
                names.extend(system.map(|system| system.name.clone()));
            }
            // Named by what is inside.
            ("settings", _) if groups.len() > 2 => {}
            ("settings", _) => names.push("Smoke".into()),
            (group, _) => names.push(display_name(group)),
        }
    }
    names.join(", ")
}

/// Groups of a system's settings on the Smoke tab. The others are on the Advanced tab.
pub const SMOKE_TAB_GROUPS: [&str; 8] =
    ["grain", "diffuse", "shadow", "ambient", "fire", "soft_scatter", "specular_scatter", "soft_fade"];

/// Returns the tab of a setting.
fn tab_of(path: &str) -> Tab {
    let is_in = |part: &&str| path.contains(&format!(".{part}."));
    if !path.starts_with("systems") {
        Tab::Light
    } else if ["emitter", "particle_files", "material"].iter().chain(&SMOKE_TAB_GROUPS).any(is_in) {
        Tab::Smoke
    } else {
        Tab::Advanced
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_core::settings::field_values;

    fn first(text: &str) -> String {
        let preset = Preset::load("column").unwrap();
        let found = matches(&preset, &Tooltips::of::<Preset>(), &LightView::default(), text);
        found.first().map(|found| found.path.clone()).unwrap_or_default()
    }

    #[test]
    fn settings_are_found_by_name_path_and_tooltip() {
        assert_eq!(first("boost"), "systems[0].settings.boost");
        assert_eq!(first("fade sc"), "systems[0].settings.soft_fade.fade_scale");
        assert_eq!(first("specular intensity"), "systems[0].settings.specular_scatter.intensity");
        assert_eq!(first("Births per second"), "systems[0].emitter.rate");
        assert_eq!(first("no such thing"), "");
    }

    #[test]
    fn results_have_names_and_places_instead_of_paths() {
        let preset = Preset::load("column").unwrap();
        let found = matches(&preset, &Tooltips::of::<Preset>(), &LightView::default(), "intensity");
        let names: Vec<_> = found.iter().map(|found| found.name.as_str()).collect();
        assert!(names.contains(&"Key (Point 1): Intensity") && names.contains(&"Diffuse: Intensity"), "{names:?}");
        assert!(names.iter().all(|name| !name.contains(['[', '.', '_'])), "{names:?}");
    }

    #[test]
    fn a_word_that_no_setting_has_finds_what_comes_nearest() {
        for (text, path) in [
            ("shadow", "shadow.strength"),
            ("sun", "lights[1]."),
            ("fog", "thickness"),
            ("brightness", "camera.exposure"),
            ("additive", "settings.blend_mode"),
            ("gravity", "emitter.buoyancy"),
            ("color", "color"),
            ("detail", "grain.tiles"),
            ("color over life", "sprite.age_color"),
            ("bloom", "camera.bloom"),
            ("shimmer", "camera.heat_haze"),
            ("distortion", "camera.heat_haze"),
            ("tone", "camera.tonemap"),
            ("hue", "camera.tonemap"),
            ("vortex", "ring_speed"),
        ] {
            let preset = Preset::load("column").unwrap();
            let found = matches(&preset, &Tooltips::of::<Preset>(), &LightView::default(), text);
            let paths: Vec<_> = found.iter().map(|found| found.path.as_str()).collect();
            assert!(paths.iter().any(|found| found.contains(path)), "{text}: {paths:?}");
        }
        // Without a sun, the kind of a light makes one.
        let mut preset = Preset::load("column").unwrap();
        preset.lights.remove(1);
        let found = matches(&preset, &Tooltips::of::<Preset>(), &LightView::default(), "sun");
        assert_eq!(found[0].path, "lights[0].kind");
    }

    #[test]
    fn parts_of_words_find_nothing() {
        assert_eq!(first("adius"), "");
        assert_eq!(first("qqq"), "");
    }

    #[test]
    fn every_setting_can_be_brought_into_view() {
        let preset = Preset::load("column").unwrap();
        let tooltips = Tooltips::of::<Preset>();
        for (path, _) in field_values(&preset).into_iter().filter(|(path, _)| path.contains('.')) {
            let found = matches(&preset, &tooltips, &LightView::default(), &path.replace('_', " "));
            assert!(found.iter().any(|found| found.path == path), "{path}");
        }
    }
}
