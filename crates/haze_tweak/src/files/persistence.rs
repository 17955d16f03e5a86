//! Persists window layout and unsaved work.

use std::path::{Path, PathBuf};

use eframe::egui;
use haze_core::error::Error;
use serde::{Deserialize, Serialize};

use super::file_actions::FileActions;
use crate::document::Document;
use crate::document::recovery::{CrashedWork, RECOVERY_WRITE_INTERVAL, Recovery, find_crashed_work};
use crate::platform::asset_loading::LoadedAssets;
use crate::platform::clock::{self, Duration, Instant};
use crate::platform::{file_io, json_store};
use crate::session::Session;

/// Writes the layout and the recovery files.
pub struct Persistence {
    folder: PathBuf,
    recovery: Recovery,
    /// Unsaved work of crashed instances. The user is asked about one after the other.
    pub crashed_work: Vec<CrashedWork>,
    /// Layout as it was last written, and when.
    written: Option<(Layout, Instant)>,
}

/// Least time between two writes of the layout.
const LAYOUT_WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// Window layout. Sizes are in points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// Inner size of the window.
    pub window: Option<[f32; 2]>,
    /// Width of the settings panel, if the user has chosen one.
    pub settings_width: Option<PanelSize>,
    /// Height of the debug view strip, likewise.
    pub strip_height: Option<PanelSize>,
    pub has_strip: Option<bool>,
    pub has_docked_inspector: Option<bool>,
    /// Folder of the last export.
    pub export_folder: Option<PathBuf>,
    /// `dark`, `light` or `system`.
    pub theme: Option<String>,
    /// Names of the hints that are still to be shown.
    pub hints: Option<Vec<String>>,
    /// Files that were open, the last one first.
    pub recent: Vec<PathBuf>,
}

/// Size of a panel that the user has chosen, and the size of the window along the panel, in points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PanelSize {
    pub size: f32,
    pub room: f32,
}

/// Largest ratio of two windows that share the size of a panel.
const MAX_ROOM_RATIO: f32 = 1.5;

impl PanelSize {
    /// Returns the size for a window; `None` if it was chosen in a much smaller or larger one.
    pub fn in_room(self, room: f32) -> Option<f32> {
        let ratio = room.max(self.room) / room.min(self.room).max(1.0);
        (ratio <= MAX_ROOM_RATIO && self.size > 0.0).then_some(self.size)
    }
}

/// egui themes by their names in the layout file.
const THEMES: [(&str, egui::ThemePreference); 3] = [
    ("system", egui::ThemePreference::System),
    ("dark", egui::ThemePreference::Dark),
    ("light", egui::ThemePreference::Light),
];

/// Name that the layout is stored under.
const LAYOUT: &str = "layout";

impl Layout {
    /// Reads the layout without implausible values. The error tells why the file could not be read.
    pub fn read(folder: &Path) -> (Self, Option<Error>) {
        let (found, error): (Self, _) = json_store::read(folder, LAYOUT);
        let window = found.window.filter(|sides| sides.iter().all(|side| (320.0..=16_384.0).contains(side)));
        let is_finite = |panel: &PanelSize| panel.size.is_finite() && panel.room.is_finite();
        let settings_width = found.settings_width.filter(is_finite);
        let strip_height = found.strip_height.filter(is_finite);
        (Self { window, settings_width, strip_height, ..found }, error)
    }

    pub fn theme(&self) -> Option<egui::ThemePreference> {
        THEMES.into_iter().find(|(name, _)| self.theme.as_deref() == Some(name)).map(|(_, theme)| theme)
    }

    /// Returns the layout without sizes.
    fn chosen(&self) -> Self {
        Self { window: None, settings_width: None, strip_height: None, ..self.clone() }
    }

    /// Records the present layout of the window.
    pub fn record(&mut self, context: &egui::Context, session: &Session) {
        let shown = context.options(|options| options.theme_preference);
        if self.theme() != Some(shown) {
            let name = THEMES.into_iter().find(|(_, theme)| *theme == shown);
            self.theme = name.map(|(name, _)| name.to_owned());
        }
        let is_full = context.input(|input| input.viewport().maximized.or(input.viewport().fullscreen)) == Some(true);
        if !is_full {
            self.window = Some(context.content_rect().size().into());
        }
        self.has_strip = Some(session.view.has_strip);
        self.has_docked_inspector = Some(session.inspect.is_docked);
        self.hints = Some(session.hints.left());
        self.record_open_file(session);
    }
}

/// Number of files that are remembered.
const MAX_RECENT: usize = 12;

impl Layout {
    /// Puts the open file first in the list.
    fn record_open_file(&mut self, session: &Session) {
        let path = session.document.path();
        if session.document.is_built_in() || self.recent.first().is_some_and(|first| first == path) {
            return;
        }
        let path = file_io::absolute(path);
        if self.recent.first() != Some(&path) {
            self.recent.retain(|other| *other != path);
            self.recent.insert(0, path);
            self.recent.truncate(MAX_RECENT);
        }
    }
}

impl Persistence {
    /// Stores files in `folder`, and searches it for unsaved work of crashed instances.
    pub fn new(folder: PathBuf, session: &mut Session) -> Self {
        let (crashed_work, errors) = find_crashed_work(&folder);
        errors.into_iter().for_each(|error| session.messages.error("recovery", error));
        Self { recovery: Recovery::new(&folder), folder, crashed_work, written: None }
    }

    /// Writes unsaved work every few seconds. Call once a frame.
    pub fn advance(&mut self, session: &mut Session, context: &egui::Context) {
        if let Err(error) = self.recovery.write_periodically(&session.document, clock::now()) {
            session.messages.error("recovery", error);
        }
        if self.recovery.has_pending_write(&session.document) {
            context.request_repaint_after(RECOVERY_WRITE_INTERVAL);
        }
    }

    /// Writes the layout if it has changed. Call once a frame.
    pub fn write_layout(&mut self, layout: &Layout, file_actions: &FileActions, context: &egui::Context) {
        let now = clock::now();
        if let Some((written, at)) = &self.written {
            let left = LAYOUT_WRITE_INTERVAL.saturating_sub(now.saturating_duration_since(*at));
            if left > Duration::ZERO || written == layout {
                // A new size is written in a later frame: a resize alone requests no repaint.
                if written.chosen() != layout.chosen() {
                    context.request_repaint_after(left);
                }
                return;
            }
        }
        self.written = Some((layout.clone(), now));
        let folder = self.folder.clone();
        let layout = layout.clone();
        file_actions.write_in_background(move || json_store::write(&folder, LAYOUT, &layout));
    }

    /// Restores the unsaved work of a crashed instance, or discards it.
    pub fn answer(&mut self, is_wanted: bool, session: &mut Session) {
        let Some(one) = self.crashed_work.pop() else { return };
        if is_wanted {
            let document = Document::recovered(one.preset.clone(), &one.source);
            let written = self.recovery.write(&document);
            // Hot reload loads the images of another file or other names as soon as it sees the document.
            let loaded = LoadedAssets {
                materials: session.loaded_materials.of(&document.preset),
                particles: session.particle_files.of(&document.preset),
                backdrop: session.backdrop.of(&document.preset),
            };
            session.replace_document(document, loaded);
            // If it was not written, the old file stays and is offered again at the next start.
            if let Err(error) = written {
                return session.messages.error("recovery", error);
            }
        }
        one.discard();
    }

    /// Writes unsaved work now, for the next start.
    pub fn write(&mut self, document: &Document) -> Result<(), Error> {
        self.recovery.write(document)
    }

    /// Removes the recovery files and writes the layout. Call at exit.
    pub fn finish(self, layout: &Layout) {
        self.recovery.finish();
        // The window is closed, so nothing can show the error.
        let _ = json_store::write(&self.folder, LAYOUT, layout);
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::kittest::Queryable as _;

    use super::*;
    use crate::window::Start;
    use crate::window::testing;

    #[test]
    fn the_layout_is_written_when_it_changes_and_not_only_at_exit() {
        let folder = tempfile::tempdir().unwrap();
        let mut session = Session::open("column".as_ref(), None).unwrap();
        let persistence = Some(Persistence::new(folder.path().into(), &mut session));
        let start = Start { persistence, ..testing::start_of(session) };
        let mut harness = testing::open(start, egui::Vec2::new(1000.0, 640.0), egui::Theme::Dark);
        type Bench = egui_kittest::Harness<'static, crate::window::Window>;
        let until = |harness: &mut Bench, is_so: fn(&Layout) -> bool| {
            let begin = Instant::now();
            while !is_so(&Layout::read(folder.path()).0) {
                let found = Layout::read(folder.path());
                assert!(begin.elapsed() < Duration::from_secs(10), "never written: {found:?}");
                harness.step();
            }
            harness.state().persistence.as_ref().unwrap().written.clone().unwrap().1
        };
        until(&mut harness, |layout| layout.hints.as_ref().is_some_and(|left| left.len() == 9));
        harness.get_by_label("Got it").click();
        harness.run_steps(3);
        harness.state_mut().session.view.has_strip = false;
        let first = until(&mut harness, |layout| {
            layout.has_strip == Some(false) && layout.hints.as_ref().is_some_and(|left| left.len() == 8)
        });
        harness.ctx.set_theme(egui::Theme::Light);
        let second = until(&mut harness, |layout| layout.theme.as_deref() == Some("light"));
        assert!(second - first >= LAYOUT_WRITE_INTERVAL);
    }
}
