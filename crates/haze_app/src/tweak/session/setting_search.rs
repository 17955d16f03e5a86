//! Search for settings by name or tooltip.

use haze::preset::Preset;
use haze::settings::{field_path, for_each_field};
use haze_author::preset::Tooltips;

use super::light_view::LightView;
use super::look_controls::{ControlTarget, LOOK_CONTROLS};
use super::view_options::Tab;

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
    pub name: String,
    /// Path of the group that it belongs to.
    pub place: String,
    pub tooltip: String,
    /// Tab that shows it.
    pub tab: Tab,
}

/// Returns settings whose names contain all words of a text, those that begin with it first; then those whose paths or
/// tooltips do. Controls of the look tab are also found by their names there; `lights` tells which lights are key
/// lights.
pub fn matches(preset: &Preset, tooltips: &Tooltips, lights: &LightView, text: &str) -> Vec<SearchResult> {
    let words: Vec<_> = text.split_whitespace().map(str::to_lowercase).collect();
    let holds = |text: &str| words.iter().all(|word| text.to_lowercase().contains(word.as_str()));
    let begins = |name: &str| name.starts_with(&text.trim().to_lowercase());
    let mut found = Vec::new();
    for (index, system) in preset.systems.iter().enumerate() {
        for control in LOOK_CONTROLS.iter().filter(|control| holds(control.name)) {
            let Some(path) = control.path(index, lights.chosen_key_light(index)) else { continue };
            let (is_made, tooltip) = match control.target {
                ControlTarget::Macro(made) => (true, made.tooltip.to_owned()),
                _ => (false, path.clone()),
            };
            // A control that is named like its field is found below.
            if is_made || !path.ends_with(&format!(".{}", control.name.replace(' ', "_"))) {
                let place = if preset.systems.len() > 1 { format!("look of {}", system.name) } else { "look".into() };
                let (name, rank) = (control.name.to_owned(), i32::from(!begins(control.name)));
                found.push((rank, SearchResult { path, name, place, tooltip, tab: Tab::Look }));
            }
        }
    }
    for_each_field(&mut preset.clone(), &mut |steps, _| {
        let plain = steps.iter().map(|step| step.0).collect::<Vec<_>>().join(".");
        let path = field_path(steps);
        // The preset's own name and description are on no tab.
        let Some((place, name)) = path.rsplit_once('.') else { return };
        let tooltip = tooltips.field(&plain).unwrap_or_default();
        let spelled = path.replace('_', " ");
        let own = name.replace('_', " ");
        let rank = match () {
            () if begins(&own) => 0,
            () if holds(&own) => 1,
            () if holds(&spelled) => 2,
            () if holds(tooltip) => 3,
            () => return,
        };
        let (name, place, tooltip, tab) = (name.into(), place.into(), tooltip.into(), tab_of(&path));
        found.push((rank, SearchResult { path, name, place, tooltip, tab }));
    });
    found.sort_by_key(|(rank, _)| *rank);
    found.truncate(MAX_RESULTS);
    found.into_iter().map(|(_, found)| found).collect()
}

/// Groups of a system's settings on the Smoke tab. The others are on the Advanced tab.
pub const SMOKE_TAB_GROUPS: [&str; 5] = ["diffuse", "shadow", "soft_scatter", "specular_scatter", "soft_fade"];

/// Returns the tab of a setting.
fn tab_of(path: &str) -> Tab {
    let is_in = |part: &&str| path.contains(&format!(".{part}."));
    if !path.starts_with("systems") {
        Tab::Light
    } else if ["emitter", "cache", "material"].iter().chain(&SMOKE_TAB_GROUPS).any(is_in) {
        Tab::Smoke
    } else {
        Tab::Advanced
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze::settings::field_values;

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
    fn every_setting_can_be_brought_into_view() {
        let preset = Preset::load("column").unwrap();
        let tooltips = Tooltips::of::<Preset>();
        for (path, _) in field_values(&preset).into_iter().filter(|(path, _)| path.contains('.')) {
            let found = matches(&preset, &tooltips, &LightView::default(), &path.replace('_', " "));
            assert!(found.iter().any(|found| found.path == path), "{path}");
        }
    }
}
