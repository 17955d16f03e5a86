//! Keeps a GPU's clock up. One that idles while a CPU gets the next frame ready runs several times slower, and takes a while
//! to notice that it has work again.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use glam::UVec2;
use haze::settings::AccumulationFormat;
use haze::{Error, wgpu};
use haze_demo::headless::Headless;

use super::limits::work::{Bench, Work};

/// How long it is kept busy before anything is measured.
const FIRST: Duration = Duration::from_secs(2);
/// Milliseconds that a piece of work takes at the least: what is measured waits for no more than one or two of them.
const PIECE_MS: f64 = 1.0;
const MOST_LAYERS: u32 = 1 << 16;

/// Does nothing for a CPU that draws, nor on OpenGL.
pub struct Awake<'a> {
    busy: Option<(Bench<'a>, Work)>,
    /// Taken first, so that who wants the GPU to itself never waits for more than the piece that runs.
    next: Mutex<()>,
    running: Mutex<()>,
    is_over: AtomicBool,
}

/// While it lives the GPU does what its owner submits, and nothing else.
pub struct Quiet<'a> {
    _next: MutexGuard<'a, ()>,
    _running: MutexGuard<'a, ()>,
}

impl<'a> Awake<'a> {
    /// # Errors
    /// When the device failed.
    pub fn new(gpu: &'a Headless) -> Result<Self, Error> {
        let info = gpu.adapter.get_info();
        // A second thread waits for the context of OpenGL no longer than some seconds, which a shader may take to compile.
        let is_left_alone = info.device_type == wgpu::DeviceType::Cpu || info.backend == wgpu::Backend::Gl;
        let busy = if is_left_alone { None } else { Some(piece(gpu)?) };
        Ok(Self { busy, next: Mutex::default(), running: Mutex::default(), is_over: AtomicBool::new(false) })
    }

    /// Keeps the GPU busy until `work` is done, but where that asks for quiet.
    pub fn during<R>(&self, work: impl FnOnce() -> R) -> R {
        let Some((bench, piece)) = &self.busy else { return work() };
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !self.is_over.load(Ordering::Relaxed) {
                    let next = lock(&self.next);
                    let _running = lock(&self.running);
                    drop(next);
                    // A device that failed tells those who measure as well.
                    if bench.frame(piece).is_err() {
                        break;
                    }
                }
            });
            let _over = Over(&self.is_over);
            std::thread::sleep(FIRST);
            work()
        })
    }

    pub fn quiet(&self) -> Quiet<'_> {
        let next = lock(&self.next);
        Quiet { _next: next, _running: lock(&self.running) }
    }
}

/// Ends the thread, whichever way the work ends.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn lock(mutex: &Mutex<()>) -> MutexGuard<'_, ()> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// As many layers as keep this GPU busy for a piece.
fn piece(gpu: &Headless) -> Result<(Bench<'_>, Work), Error> {
    let bench = Bench::new(gpu, UVec2::splat(512));
    let mut layers = 64;
    loop {
        let work = bench.draw(Some("constant"), AccumulationFormat::Rgba16Float, layers);
        let ms = bench.frame(&work)?.unwrap_or_default();
        if ms >= PIECE_MS || layers >= MOST_LAYERS {
            return Ok((bench, work));
        }
        layers *= 2;
    }
}
