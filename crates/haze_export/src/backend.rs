//! The renderer that draws to images: the GPU or the CPU.

use std::cell::RefCell;

use glam::Vec4;
use haze::shader::Sources;
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_demo::headless::Headless;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;

#[cfg(target_arch = "wasm32")]
use crate::page_renderer::PageRenderer;

/// The renderer in use.
pub enum Backend {
    /// A GPU, or a software driver for one.
    Gpu(Box<Gpu>),
    /// The GPU of a page.
    #[cfg(target_arch = "wasm32")]
    Page(Box<PageRenderer>),
    /// The CPU renderer.
    Cpu,
}

/// A device, and the renderer on it, which is kept for all images.
pub struct Gpu {
    /// The device.
    pub headless: Headless,
    /// Shaders, pipelines and scene on the device.
    pub context: OffscreenContext,
    renderer: RefCell<OffscreenRenderer>,
    has_own_shaders: bool,
}

impl Backend {
    /// Opens the GPU if there is one, else the CPU, which cannot use custom shaders.
    pub fn open(sources: Option<&Sources>) -> Result<Self, Error> {
        match Headless::new() {
            Ok(gpu) => Self::on(gpu, sources),
            Err(Error::NoDevice(_) | Error::Device(_)) if sources.is_none() => Ok(Self::Cpu),
            Err(error) => Err(error),
        }
    }

    /// Uses an opened GPU.
    pub fn on(gpu: Headless, sources: Option<&Sources>) -> Result<Self, Error> {
        let mut context = OffscreenContext::new(&gpu.adapter, &gpu.device, &gpu.queue);
        if let Some(sources) = sources {
            context = context.with_shaders(sources)?;
        }
        let renderer = RefCell::new(OffscreenRenderer::new(&context, false)?);
        Ok(Self::Gpu(Box::new(Gpu { headless: gpu, context, renderer, has_own_shaders: sources.is_some() })))
    }

    /// Renders an image in linear HDR.
    pub fn render(&self, shot: &Shot) -> Result<Image<Vec4>, Error> {
        match self {
            Self::Gpu(gpu) => {
                let mut renderer = gpu.renderer.borrow_mut();
                let mut draw = || {
                    // Locates errors; without them, drawing compiles what it needs, which is less.
                    if gpu.has_own_shaders {
                        renderer.warm_up(shot)?;
                    }
                    renderer.draw(&gpu.headless, shot)?;
                    renderer.read(&gpu.headless, shot)
                };
                // A texture for which memory ran out is also refused where it is bound: the first failure is the cause.
                draw().map_err(|error| gpu.headless.check().err().unwrap_or(error))
            }
            #[cfg(target_arch = "wasm32")]
            Self::Page(_) => shot.render_on_cpu(),
            Self::Cpu => shot.render_on_cpu(),
        }
    }

    /// As [`Backend::render`]. A page goes on meanwhile, if its GPU renders.
    pub async fn render_async(&self, shot: &Shot) -> Result<Image<Vec4>, Error> {
        match self {
            #[cfg(target_arch = "wasm32")]
            Self::Page(page) => page.render(shot).await,
            _ => self.render(shot),
        }
    }

    /// Describes the renderer in one line.
    pub fn description(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.headless.description(),
            #[cfg(target_arch = "wasm32")]
            Self::Page(_) => "the page's GPU".into(),
            Self::Cpu => "the CPU renderer".into(),
        }
    }
}
