//! The page around the canvas: downloads, the file picker, the address.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use haze_core::assets::{bounded_read, memory_files};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Document, HtmlCanvasElement, HtmlInputElement};

/// Event of a canvas.
const LOST: &str = "webglcontextlost";

/// Largest file to download.
const MAX_BYTES: u64 = 1 << 30;

/// Returns false in a web worker.
pub fn is_page() -> bool {
    web_sys::window().is_some()
}

fn document() -> Option<Document> {
    web_sys::window()?.document()
}

fn create<T: JsCast>(tag: &str) -> Option<T> {
    document()?.create_element(tag).ok()?.dyn_into().ok()
}

#[wasm_bindgen]
extern "C" {
    /// Functions of page.js.
    #[wasm_bindgen(js_name = pickSaveFile)]
    async fn pick_save_file(suggested: &str) -> JsValue;
    #[wasm_bindgen(js_name = offerFile)]
    fn offer_file(name: &str, bytes: js_sys::Uint8Array);
}

/// Writes a file to where the user has saved it before, or offers it as a download.
pub fn offer(path: &Path) {
    let Ok(bytes) = bounded_read::read(path, "file", MAX_BYTES) else { return };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    offer_file(&name, js_sys::Uint8Array::from(&bytes[..]));
}

/// Returns true if the browser has a dialog for saving.
pub fn has_save_dialog() -> bool {
    let name = JsValue::from_str("showSaveFilePicker");
    web_sys::window().is_some_and(|window| js_sys::Reflect::has(&window, &name).unwrap_or(false))
}

/// Opens the browser's dialog for saving, and calls `done` with the chosen name; `None` if it was cancelled.
pub fn pick_save(suggested: String, done: impl FnOnce(Option<PathBuf>) + 'static) {
    spawn_local(async move { done(pick_save_file(&suggested).await.as_string().map(PathBuf::from)) });
}

/// Opens the file picker, and calls `done` with the names of the files once they are read.
pub fn pick_files(done: impl FnOnce(Vec<PathBuf>) + 'static) {
    let Some(input) = create::<HtmlInputElement>("input") else { return };
    input.set_type("file");
    input.set_multiple(true);
    input.set_accept(".json,.png,.csv,.ply");
    let shown = input.clone();
    let read = Closure::once_into_js(move || {
        spawn_local(async move {
            let mut names = Vec::new();
            let files = input.files();
            for file in files.iter().flat_map(|files| (0..files.length()).filter_map(|index| files.get(index))) {
                let Ok(buffer) = JsFuture::from(file.array_buffer()).await else { continue };
                let path = PathBuf::from(file.name());
                if memory_files::write_file(&path, &js_sys::Uint8Array::new(&buffer).to_vec()).is_ok() {
                    names.push(path);
                }
            }
            done(names);
        });
    });
    shown.set_onchange(Some(read.unchecked_ref()));
    shown.click();
}

/// Returns the part of the address after `#`.
pub fn fragment() -> String {
    let hash = web_sys::window().and_then(|window| window.location().hash().ok());
    hash.unwrap_or_default().trim_start_matches('#').to_owned()
}

/// Returns the part of the address from `?` to `#`.
pub fn query() -> String {
    web_sys::window().and_then(|window| window.location().search().ok()).unwrap_or_default()
}

/// Replaces the part of the address after `#`. Returns the address.
pub fn set_fragment(fragment: &str) -> String {
    let Some(window) = web_sys::window() else { return format!("#{fragment}") };
    let address = window.location().href().unwrap_or_default();
    let address = format!("{}#{fragment}", address.split('#').next().unwrap_or_default());
    if let Ok(history) = window.history() {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&address));
    }
    address
}

/// Returns the canvas of the page.
pub fn canvas() -> Option<HtmlCanvasElement> {
    document()?.get_element_by_id("canvas")?.dyn_into().ok()
}

/// Replaces the canvas by a new one: the graphics context of a canvas that was lost does not come back.
pub fn replace_canvas() -> Option<HtmlCanvasElement> {
    let old = canvas()?;
    let new: HtmlCanvasElement = old.clone_node().ok()?.dyn_into().ok()?;
    old.parent_node()?.replace_child(&new, &old).ok()?;
    Some(new)
}

/// Listener for the loss of a canvas's graphics context. Dropping it ends it.
pub struct ContextEvents {
    canvas: HtmlCanvasElement,
    lost: Closure<dyn FnMut(web_sys::Event)>,
}

/// Sets a flag when the graphics context of a canvas is lost. WebGPU reports the loss of its device instead.
pub fn watch_context(canvas: &HtmlCanvasElement, is_lost: Rc<Cell<bool>>, wake: impl Fn() + 'static) -> ContextEvents {
    let lost = Closure::new(move |event: web_sys::Event| {
        event.prevent_default();
        is_lost.set(true);
        wake();
    });
    let _ = canvas.add_event_listener_with_callback(LOST, lost.as_ref().unchecked_ref());
    ContextEvents { canvas: canvas.clone(), lost }
}

impl Drop for ContextEvents {
    fn drop(&mut self) {
        let _ = self.canvas.remove_event_listener_with_callback(LOST, self.lost.as_ref().unchecked_ref());
    }
}

/// Tells the page's style what is shown: `loading`, `running` or `failed`, with a reason.
pub fn set_state(state: &str, reason: &str) {
    let Some(document) = document() else { return };
    if let Some(message) = document.get_element_by_id("reason") {
        message.set_text_content(Some(reason));
    }
    if let Some(body) = document.body() {
        let _ = body.set_attribute("data-state", state);
    }
}
