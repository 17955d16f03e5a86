//! Web workers: each runs the program again, without a window, for one job.

use std::cell::RefCell;
use std::rc::Rc;

use haze_core::assets::bounded_read;
use js_sys::{Array, Object, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::{MessageEvent, WorkerOptions, WorkerType};

use crate::platform::portable_job::PortableJob;

/// Script of a web worker, beside the page.
const SCRIPT: &str = "./job.js";

/// Largest file to send.
const MAX_BYTES: u64 = 1 << 30;

/// A running job. Dropping it ends it.
pub struct WebJob {
    worker: web_sys::Worker,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_error: Closure<dyn FnMut()>,
}

impl Drop for WebJob {
    fn drop(&mut self) {
        self.worker.terminate();
    }
}

/// Starts a job. `progress` gets the number of finished steps and returns false to stop; `done` gets the output, `None` if
/// the job has failed. Returns `None` after a failure to start.
pub fn start<J: PortableJob>(
    job: &J,
    progress: impl Fn(u32) -> bool + 'static,
    done: impl FnOnce(Option<J::Output>) + 'static,
) -> Option<WebJob> {
    let done = Rc::new(RefCell::new(Some(done)));
    let finish = move |output| {
        if let Some(done) = done.take() {
            done(output);
        }
    };
    let started = start_worker(job, progress, finish.clone());
    if started.is_err() {
        finish(None);
    }
    started.ok()
}

fn start_worker<J: PortableJob>(
    job: &J,
    progress: impl Fn(u32) -> bool + 'static,
    finish: impl Fn(Option<J::Output>) + Clone + 'static,
) -> Result<WebJob, JsValue> {
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let worker = web_sys::Worker::new_with_options(SCRIPT, &options)?;
    let ended = worker.clone();
    let failed = finish.clone();
    let on_message = Closure::new(move |event: MessageEvent| {
        let message = event.data();
        let part = |name| Reflect::get(&message, &JsValue::from_str(name)).unwrap_or_default();
        if let Some(steps) = part("steps").as_f64() {
            if !progress(steps as u32) {
                ended.terminate();
                finish(J::stopped());
            }
        } else {
            finish(part("output").as_string().and_then(|text| serde_json::from_str(&text).ok()));
        }
    });
    let on_error = Closure::new(move || failed(None));
    worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
    let text = serde_json::to_string(job).map_err(|error| JsValue::from_str(&error.to_string()))?;
    let message = Object::new();
    let program = web_sys::window().and_then(|window| window.document()?.body()?.dataset().get("program"));
    for (name, value) in [
        ("program", JsValue::from(program.unwrap_or_default())),
        ("module", wasm_bindgen::module()),
        ("name", J::NAME.into()),
        ("job", text.into()),
        ("files", files(job).into()),
    ] {
        Reflect::set(&message, &name.into(), &value)?;
    }
    worker.post_message(&message)?;
    Ok(WebJob { worker, _on_message: on_message, _on_error: on_error })
}

/// Returns path and contents of the files that a job reads.
fn files(job: &impl PortableJob) -> Array {
    let files = job.reads().into_iter().filter_map(|path| {
        let bytes = bounded_read::read(&path, "file", MAX_BYTES).ok()?;
        Some(Array::of2(&path.to_string_lossy().as_ref().into(), &Uint8Array::from(&bytes[..])))
    });
    files.collect()
}
