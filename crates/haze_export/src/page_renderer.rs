//! The renderer of a page: the GPU of its canvas, which must not be waited for.

use std::cell::RefCell;

use eframe::wgpu;
use glam::Vec4;
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use wasm_bindgen_futures::JsFuture;

/// Device of the canvas, and the pipelines on it.
#[derive(Clone)]
pub struct PageGpu {
    /// The device of the page.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Shaders, pipelines and scene on the device.
    pub context: OffscreenContext,
}

thread_local! {
    static GPU: RefCell<Option<PageGpu>> = const { RefCell::new(None) };
}

/// Uses another device from now on.
pub fn set_gpu(gpu: PageGpu) {
    GPU.set(Some(gpu));
}

/// A renderer on that device.
pub struct PageRenderer {
    gpu: PageGpu,
    renderer: RefCell<OffscreenRenderer>,
}

impl PageRenderer {
    /// # Errors
    /// [`Error::Device`] if the canvas has no device yet, and those of [`OffscreenRenderer::new`].
    pub fn open() -> Result<Self, Error> {
        let gpu = GPU.with_borrow(Clone::clone).ok_or_else(|| failed("not open yet"))?;
        let renderer = RefCell::new(OffscreenRenderer::new(&gpu.context, false)?);
        Ok(Self { gpu, renderer })
    }

    /// Renders an image in linear HDR. The page goes on meanwhile.
    ///
    /// # Errors
    /// Those of [`OffscreenRenderer::record`], or [`Error::Device`] if the image cannot be read back.
    pub async fn render(&self, shot: &Shot) -> Result<Image<Vec4>, Error> {
        let PageGpu { device, queue, .. } = &self.gpu;
        let image = {
            let mut renderer = self.renderer.borrow_mut();
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            renderer.record(&mut encoder, shot, &[shot.debug_view])?;
            let image =
                renderer.read_later(&mut encoder, shot.debug_view).ok_or_else(|| failed("nothing was drawn"))?;
            queue.submit([encoder.finish()]);
            image
        };
        while !image.is_finished() {
            // The browser runs the callbacks of WebGPU, wgpu those of WebGL.
            next_task().await;
            let _ = device.poll(wgpu::PollType::Poll);
        }
        image.take().ok_or_else(|| failed("the image was not read back"))
    }
}

/// Waits until the browser has run other tasks.
async fn next_task() {
    let wait = js_sys::Promise::new(&mut |done, _| {
        let window = web_sys::window();
        let _ = window.map(|window| window.set_timeout_with_callback_and_timeout_and_arguments_0(&done, 4));
    });
    let _ = JsFuture::from(wait).await;
}

fn failed(reason: &str) -> Error {
    Error::Device(reason.into())
}
