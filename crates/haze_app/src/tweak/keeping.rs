//! What outlives the window: unsaved work, for after a crash, and where things were.

use std::path::{Path, PathBuf};

use eframe::egui;
use haze::Error;
use serde::{Deserialize, Serialize};

use super::document::document::Document;
use super::document::recovery::{Abandoned, Recovery, WRITE_EVERY, abandoned};
use super::filing::Filing;
use super::platform::clock::{Duration, Instant};
use super::platform::memory::{recall, remember};
use super::session::Session;

/// See the module.
pub struct Keeping {
    folder: PathBuf,
    recovery: Recovery,
    /// What crashed tweakers have left; asked about one by one.
    pub abandoned: Vec<Abandoned>,
    /// Where things were when that was written last, and the time then.
    written: Option<(Layout, Instant)>,
}

/// Where things are is written no oftener.
const REMEMBER_EVERY: Duration = Duration::from_secs(1);

/// Where things were. Points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// The window's inside.
    pub window: Option<[f32; 2]>,
    /// Width of the settings.
    pub settings: Option<f32>,
    /// Height of the shade tree strip.
    pub strip: Option<f32>,
    pub has_strip: Option<bool>,
    /// `dark`, `light` or `system`.
    pub theme: Option<String>,
    /// Hints that are still to be shown.
    pub hints: Option<Vec<String>>,
}

/// Themes by name.
const THEMES: [(&str, egui::ThemePreference); 3] = [
    ("system", egui::ThemePreference::System),
    ("dark", egui::ThemePreference::Dark),
    ("light", egui::ThemePreference::Light),
];

/// The name that the layout is remembered under.
const LAYOUT: &str = "layout";

impl Layout {
    /// As it was remembered, but what cannot be; with what was wrong with the file.
    pub fn recall(folder: &Path) -> (Self, Option<Error>) {
        let (found, error): (Self, _) = recall(folder, LAYOUT);
        let side = |side: Option<f32>, most: f32| side.filter(|side| (1.0..=most).contains(side));
        let window = found.window.filter(|sides| sides.iter().all(|side| (320.0..=16_384.0).contains(side)));
        (Self { window, settings: side(found.settings, 560.0), strip: side(found.strip, 320.0), ..found }, error)
    }

    pub fn theme(&self) -> Option<egui::ThemePreference> {
        THEMES.into_iter().find(|(name, _)| self.theme.as_deref() == Some(name)).map(|(_, theme)| theme)
    }

    /// All but sizes.
    fn chosen(&self) -> (Option<bool>, Option<&str>, Option<&[String]>) {
        (self.has_strip, self.theme.as_deref(), self.hints.as_deref())
    }

    /// Takes note of what the window says about itself.
    pub fn see(&mut self, context: &egui::Context, session: &Session) {
        let shown = context.options(|options| options.theme_preference);
        if self.theme() != Some(shown) {
            let name = THEMES.into_iter().find(|(_, theme)| *theme == shown);
            self.theme = name.map(|(name, _)| name.to_owned());
        }
        let is_full = context.input(|input| input.viewport().maximized.or(input.viewport().fullscreen)) == Some(true);
        if !is_full {
            self.window = Some(context.content_rect().size().into());
        }
        self.has_strip = Some(session.show.has_strip);
        self.hints = Some(session.hints.left());
    }
}

impl Keeping {
    /// Keeps in a folder, and looks there for what others have left.
    pub fn new(folder: PathBuf, session: &mut Session) -> Self {
        let (abandoned, errors) = abandoned(&folder);
        errors.into_iter().for_each(|error| session.messages.complain("recovery", error));
        Self { recovery: Recovery::new(&folder), folder, abandoned, written: None }
    }

    /// Once a frame: writes what is not saved, every few seconds.
    pub fn advance(&mut self, session: &mut Session, context: &egui::Context) {
        if let Err(error) = self.recovery.keep(&session.document, Instant::now()) {
            session.messages.complain("recovery", error);
        }
        if self.recovery.is_behind(&session.document) {
            context.request_repaint_after(WRITE_EVERY);
        }
    }

    /// Once a frame: has it written where things are, when that is not what was written last.
    pub fn remember(&mut self, layout: &Layout, filing: &Filing, context: &egui::Context) {
        let now = Instant::now();
        if let Some((written, at)) = &self.written {
            let left = REMEMBER_EVERY.saturating_sub(now.saturating_duration_since(*at));
            if left > Duration::ZERO || written == layout {
                // Sizes are for the next frame: none is drawn because a window was resized.
                if written.chosen() != layout.chosen() {
                    context.request_repaint_after(left);
                }
                return;
            }
        }
        self.written = Some((layout.clone(), now));
        let (folder, layout) = (self.folder.clone(), layout.clone());
        filing.remember(move || remember(&folder, LAYOUT, &layout));
    }

    /// Goes on with what was left, or throws it away.
    pub fn answer(&mut self, is_wanted: bool, session: &mut Session) {
        let Some(one) = self.abandoned.pop() else { return };
        if is_wanted {
            let document = Document::recovered(one.preset.clone(), &one.source);
            let written = self.recovery.write(&document);
            // Those of another file or other names are loaded as soon as this is seen.
            let loaded = (session.pictures.of(&document.preset), session.caches.of(&document.preset));
            session.put(document, loaded);
            // Else it is offered again at the next start.
            if let Err(error) = written {
                return session.messages.complain("recovery", error);
            }
        }
        one.discard();
    }

    /// Keeps what is not saved for the next start, now.
    pub fn write(&mut self, document: &Document) -> Result<(), Error> {
        self.recovery.write(document)
    }

    /// The end: nothing is left but where things were.
    pub fn finish(self, layout: &Layout) {
        self.recovery.finish();
        // The window is gone: there is no one to tell.
        let _ = remember(&self.folder, LAYOUT, layout);
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::kittest::Queryable as _;

    use super::*;
    use crate::tweak::reload::ShaderFolder;
    use crate::tweak::testing;
    use crate::tweak::window::Start;

    #[test]
    fn where_things_are_is_written_when_it_changes_and_not_only_at_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let mut session = Session::open("column".as_ref(), None).unwrap();
        let keeping = Some(Keeping::new(folder.path().into(), &mut session));
        let start =
            Start { session, shaders: ShaderFolder::None, keeping, layout: Layout::default(), has_dialogs: false };
        let mut harness = testing::open(start, egui::Vec2::new(1000.0, 640.0), egui::Theme::Dark);
        type Bench = egui_kittest::Harness<'static, crate::tweak::window::Window>;
        let until = |harness: &mut Bench, is_so: fn(&Layout) -> bool| {
            let begin = Instant::now();
            while !is_so(&Layout::recall(folder.path()).0) {
                let found = Layout::recall(folder.path());
                assert!(begin.elapsed() < Duration::from_secs(10), "never written: {found:?}");
                harness.step();
            }
            harness.state().keeping.as_ref().unwrap().written.clone().unwrap().1
        };
        until(&mut harness, |layout| layout.hints.as_ref().is_some_and(|left| left.len() == 5));
        harness.get_by_label("Got it").click();
        harness.run_steps(3);
        harness.state_mut().session.show.has_strip = false;
        let first = until(&mut harness, |layout| {
            layout.has_strip == Some(false) && layout.hints.as_ref().is_some_and(|left| left.len() == 4)
        });
        harness.ctx.set_theme(egui::Theme::Light);
        let second = until(&mut harness, |layout| layout.theme.as_deref() == Some("light"));
        assert!(second - first >= REMEMBER_EVERY);
    }
}
