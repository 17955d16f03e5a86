//! Start of the tweaker on a page.

use std::path::Path;

use wasm_bindgen_futures::spawn_local;

use super::files::hot_reload::ShaderFolder;
use super::files::persistence::{Layout, Persistence};
use super::platform::web::{page, storage};
use super::session::Session;
use super::window::Start;
use super::window::page_window;

/// Folder of the files that the page keeps for itself.
const STATE: &str = "state";

/// Opens the tweaker in the page's canvas.
pub fn open_page() {
    spawn_local(async {
        if let Err(reason) = open().await {
            page::set_state("failed", &reason);
        }
    });
}

async fn open() -> Result<(), String> {
    storage::load();
    let mut session = Session::open(Path::new("column"), None).map_err(|error| error.to_string())?;
    let (layout, error) = Layout::read(Path::new(STATE));
    if let Some(error) = error {
        session.messages.error("layout", error);
    }
    let mut persistence = Persistence::new(STATE.into(), &mut session);
    // A reload is no crash: the work goes on.
    persistence.answer(true, &mut session);
    let start =
        Start { session, shaders: ShaderFolder::None, persistence: Some(persistence), layout, has_dialogs: true };
    page_window::open(start).await
}
