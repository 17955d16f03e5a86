//! Start of the tweaker on a page.

use std::path::Path;

use haze_core::error::Error;
use wasm_bindgen_futures::spawn_local;

use super::document::Document;
use super::files::hot_reload::ShaderFolder;
use super::files::persistence::{Layout, Persistence};
use super::files::shared_look;
use super::files::thumbnail_cache::ThumbnailCache;
use super::platform::web::{page, storage};
use super::session::Session;
use super::window::Start;
use super::window::page_window;

/// Folder of the files that the page keeps for itself.
const STATE: &str = "state";

/// Folder of the thumbnails of presets.
const THUMBNAILS: &str = "thumbnails";

/// Folder of the ramps that came with a link.
const LINK: &str = "link";

/// Opens the tweaker in the page's canvas. A web worker has no canvas; it waits for its job.
pub fn open_page() {
    if !page::is_page() {
        return;
    }
    spawn_local(async {
        if let Err(reason) = open().await {
            page::set_state("failed", &reason);
        }
    });
}

async fn open() -> Result<(), String> {
    storage::load();
    let fragment = page::fragment();
    let (mut session, refused) = match open_fragment(&fragment) {
        Ok(session) => (session, None),
        Err(error) => (open_fragment("").map_err(|error| error.to_string())?, Some(error)),
    };
    if let Some(error) = refused {
        session.messages.error("link", error);
    }
    let (layout, error) = Layout::read(Path::new(STATE));
    if let Some(error) = error {
        session.messages.error("layout", error);
    }
    let mut persistence = Persistence::new(STATE.into(), &mut session);
    let has_start_view = fragment.is_empty() && persistence.crashed_work.is_empty();
    session.playback.is_playing = has_start_view;
    // A reload is no crash: the work goes on. Over a link, also a broken one, the user is asked.
    if fragment.is_empty() {
        persistence.answer(true, &mut session);
    }
    let start = Start {
        session,
        shaders: ShaderFolder::None,
        persistence: Some(persistence),
        layout,
        has_dialogs: true,
        cache: ThumbnailCache { folder: Some(THUMBNAILS.into()) },
        has_start_view,
    };
    page_window::open(start).await
}

/// Opens the look that the address has after `#`: that of a link, or `NAME&FIELD=VALUE` with a built-in preset and values of
/// its fields, all optional.
fn open_fragment(fragment: &str) -> Result<Session, Error> {
    if fragment.starts_with(|first: char| first.is_ascii_digit()) {
        return shared_look::open(fragment, Path::new(LINK));
    }
    let mut parts = fragment.split('&');
    let name = parts.next().filter(|name| !name.is_empty()).unwrap_or("column");
    let mut document = Document::open(Path::new(name))?;
    for assignment in parts {
        let (field, value) = assignment.split_once('=').unwrap_or((assignment, ""));
        document.preset.set_field(field, value)?;
    }
    document.preset.validate()?;
    Session::show(document, None)
}
