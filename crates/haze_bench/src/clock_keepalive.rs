//! Keeps the GPU's clock up while the benchmark runs. A GPU that idles while the CPU prepares the next frame lowers its
//! clock, runs several times slower, and takes a while to raise it again.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use glam::UVec2;
use haze::wgpu;
use haze_core::error::Error;
use haze_core::settings::AccumulationFormat;
use haze_demo::headless::Headless;

use super::limit_work::{LimitBench, Work};

/// Time for which the GPU is kept busy before the first measurement.
const SPIN_UP: Duration = Duration::from_secs(2);
/// Least duration of one piece of filler work, milliseconds. A measurement waits for one or two pieces at most.
const FILLER_MS: f64 = 1.0;
const MAX_LAYERS: u32 = 1 << 16;

/// Keeps the GPU busy from a second thread. Does nothing on a CPU adapter or on OpenGL.
pub struct ClockKeepalive<'a> {
    busy: Option<(LimitBench<'a>, Work)>,
    /// Locked before `running`, so that [`Self::pause`] waits only for the piece in flight.
    next: Mutex<()>,
    running: Mutex<()>,
    is_over: AtomicBool,
}

/// While this exists, the GPU executes only what the holder submits.
pub struct KeepalivePause<'a> {
    _next: MutexGuard<'a, ()>,
    _running: MutexGuard<'a, ()>,
}

impl<'a> ClockKeepalive<'a> {
    /// # Errors
    /// If the device failed.
    pub fn new(gpu: &'a Headless) -> Result<Self, Error> {
        let info = gpu.adapter.get_info();
        // On OpenGL a second thread waits only a few seconds for the context, and a shader may take longer to compile.
        let is_left_alone = info.device_type == wgpu::DeviceType::Cpu || info.backend == wgpu::Backend::Gl;
        let busy = if is_left_alone { None } else { Some(filler_work(gpu)?) };
        Ok(Self { busy, next: Mutex::default(), running: Mutex::default(), is_over: AtomicBool::new(false) })
    }

    /// Runs `work`, and keeps the GPU busy until it returns, except while a [`KeepalivePause`] exists.
    pub fn during<R>(&self, work: impl FnOnce() -> R) -> R {
        let Some((bench, filler_work)) = &self.busy else { return work() };
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !self.is_over.load(Ordering::Relaxed) {
                    let next = lock(&self.next);
                    let _running = lock(&self.running);
                    drop(next);
                    // The measuring thread gets the error of a failed device itself.
                    if bench.frame(filler_work).is_err() {
                        break;
                    }
                }
            });
            let _stop = StopOnDrop(&self.is_over);
            std::thread::sleep(SPIN_UP);
            work()
        })
    }

    pub fn pause(&self) -> KeepalivePause<'_> {
        let next = lock(&self.next);
        KeepalivePause { _next: next, _running: lock(&self.running) }
    }
}

/// Ends the thread when the work returns or panics.
struct StopOnDrop<'a>(&'a AtomicBool);

impl Drop for StopOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn lock(mutex: &Mutex<()>) -> MutexGuard<'_, ()> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Finds a number of layers that keeps this GPU busy for at least [`FILLER_MS`].
fn filler_work(gpu: &Headless) -> Result<(LimitBench<'_>, Work), Error> {
    let bench = LimitBench::new(gpu, UVec2::splat(512));
    let mut layers = 64;
    loop {
        let work = bench.draw(Some("constant"), AccumulationFormat::Rgba16Float, layers);
        let ms = bench.frame(&work)?.unwrap_or_default();
        if ms >= FILLER_MS || layers >= MAX_LAYERS {
            return Ok((bench, work));
        }
        layers *= 2;
    }
}
