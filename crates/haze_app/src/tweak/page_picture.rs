//! Pictures for scripts on the page, drawn by the GPU of the canvas.

use std::cell::RefCell;
use std::path::Path;

use eframe::wgpu;
use glam::UVec2;
use haze::Error;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use wasm_bindgen::prelude::*;

use super::platform::web::page;

/// Device of the canvas, and the pipelines on it.
#[derive(Clone)]
pub struct PageGpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub context: OffscreenContext,
}

thread_local! {
    static GPU: RefCell<Option<PageGpu>> = const { RefCell::new(None) };
}

/// Uses another device from now on.
pub fn set_gpu(gpu: PageGpu) {
    GPU.set(Some(gpu));
}

/// Draws a built-in preset. Resolves to its pixels as RGB, row by row from the top.
#[wasm_bindgen]
pub async fn picture(preset: String, width: u32, height: u32) -> Result<Vec<u8>, JsValue> {
    draw(&preset, UVec2::new(width, height)).await.map_err(|error| JsValue::from_str(&error.to_string()))
}

async fn draw(preset: &str, size: UVec2) -> Result<Vec<u8>, Error> {
    let failed = |reason: &str| Error::Device(reason.into());
    let PageGpu { device, queue, context } = GPU.with_borrow(Clone::clone).ok_or_else(|| failed("not open yet"))?;
    let shot = Shot::load(Path::new(preset), size)?;
    let mut renderer = OffscreenRenderer::new(&context, false)?;
    renderer.warm_up(&shot)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.record(&mut encoder, &shot, &[shot.debug_view])?;
    let image = renderer.read_later(&mut encoder, shot.debug_view).ok_or_else(|| failed("nothing was drawn"))?;
    queue.submit([encoder.finish()]);
    while !image.is_finished() {
        // The browser runs the callbacks of WebGPU, wgpu those of WebGL.
        page::next_task().await;
        let _ = device.poll(wgpu::PollType::Poll);
    }
    let image = image.take().ok_or_else(|| failed("the picture was not read back"))?;
    Ok(tonemap(&image, &shot).into_raw())
}
