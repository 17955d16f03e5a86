//! Entry point of a web worker, which runs one job of the page.

use std::path::Path;

use haze_core::assets::memory_files;
use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;

use super::document::simulation_edit::SimulateSprite;
use super::document::sprite_edits::sprite_source::{BakeSprite, ReadSprite};
use super::platform::portable_job::PortableJob;
use super::viewport::path_traced_puff::TracePuff;

/// Runs a job in a web worker. `progress` is called with the number of finished steps. Returns the output as text.
#[wasm_bindgen]
pub fn run_job(name: &str, job: &str, files: Array, progress: &js_sys::Function) -> Result<String, JsValue> {
    for file in files.iter() {
        let file = Array::from(&file);
        let path = file.get(0).as_string().unwrap_or_default();
        let _ = memory_files::write_file(Path::new(&path), &Uint8Array::new(&file.get(1)).to_vec());
    }
    let run = match name {
        BakeSprite::NAME => run::<BakeSprite>,
        ReadSprite::NAME => run::<ReadSprite>,
        SimulateSprite::NAME => run::<SimulateSprite>,
        TracePuff::NAME => run::<TracePuff>,
        _ => return Err(JsValue::from_str(&format!("unknown job: {name}"))),
    };
    let output = run(job, &|steps| progress.call1(&JsValue::NULL, &steps.into()).is_ok());
    output.map_err(|error| JsValue::from_str(&error.to_string()))
}

fn run<J: PortableJob>(job: &str, progress: &dyn Fn(u32) -> bool) -> serde_json::Result<String> {
    serde_json::to_string(&serde_json::from_str::<J>(job)?.run(progress))
}
