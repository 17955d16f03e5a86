//! Images for scripts on the page, drawn by the GPU of the canvas.

use std::path::Path;

use glam::UVec2;
use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use wasm_bindgen::prelude::*;

use haze_export::page_renderer::PageRenderer;

/// Draws a built-in preset. Resolves to its pixels as RGB, row by row from the top.
#[wasm_bindgen]
pub async fn image(preset: String, width: u32, height: u32) -> Result<Vec<u8>, JsValue> {
    draw(&preset, UVec2::new(width, height)).await.map_err(|error| JsValue::from_str(&error.to_string()))
}

async fn draw(preset: &str, size: UVec2) -> Result<Vec<u8>, Error> {
    let shot = Shot::load(Path::new(preset), size)?;
    Ok(tonemap(&PageRenderer::open()?.render(&shot).await?, &shot).into_raw())
}
