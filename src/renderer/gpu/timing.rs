//! GPU timing by timestamp queries: passes write them, each frame resolves them once, and they are read back when the
//! GPU has finished.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Gpu;
use super::frame_times::{FrameTimes, Results, Span};
use crate::renderer::auto::PathChoice;

/// Queries for passes of the host, first in the set. They are separate from haze's queries, so that no query is written
/// twice in one pass (which wgpu refuses), whenever the host uses them.
const HOST_QUERIES: u32 = 64;

/// Total number of queries, two per interval: enough for about 100 systems.
const QUERIES: u32 = 1024;

/// Maximum number of frames in flight. Further frames are not measured.
const READ_BACKS: usize = 4;

/// Measures the GPU time of every pass. A clone refers to the same measurement; one `Timing` serves all renderers of a
/// frame.
///
/// [`Context::create_timing`](crate::Context::create_timing) creates it. Pass it to the renderers with
/// [`Renderer::set_timing`](crate::Renderer::set_timing), and call
/// [`resolve`](Self::resolve) at the end of the frame's last encoder. Results arrive some frames later, without
/// blocking: the first submission after the GPU has finished delivers them.
///
/// Passes that haze begins itself (`depth_resolve`, `measure`, `emit`, `sort`, `depth_downsample`, `diffuse_bake`,
/// `accumulate`, `light_target`, `depth_slopes`, `mark_cells`, `upsample_lit`, and those of the path `tiled`) are always measured,
/// one by one or together: see [`TimingDetail`]. Passes that haze records into the host's pass (`transfer`, `specular_scatter`,
/// `forward`) are measured if the device has `Features::TIMESTAMP_QUERY_INSIDE_PASSES`. Without it,
/// [`host_pass`](Self::host_pass) measures the host's whole pass. A device without `Features::TIMESTAMP_QUERY` measures
/// nothing. There, a host can measure the CPU time of its calls, and should label it as such, because it says little
/// about GPU time.
///
/// At most 480 intervals of haze and 32 of the host are measured in a frame; more are counted in
/// [`FrameTimes::discarded`].
#[derive(Clone, Debug)]
pub struct Timing(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    device_number: u64,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_backs: [Arc<ReadBack>; READ_BACKS],
    ms_per_tick: f64,
    inside_passes: bool,
    is_by_pass: AtomicBool,
    recording: Mutex<Recording>,
    results: Mutex<Results>,
}

/// Extent of what a [`Timing`] measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimingDetail {
    /// Every pass, by its name. Measuring takes time itself: on an NVIDIA H200, 0.01 to 0.07 ms of a frame.
    #[default]
    Passes,
    /// The frame as it runs without [`Timing`]: compute passes that follow each other are one, `compute`.
    Frame,
}

/// Buffer for the timestamps of a frame, and the recording that they belong to. It is in use while an encoder, or wgpu
/// after submission, holds another reference.
#[derive(Debug)]
struct ReadBack {
    buffer: wgpu::Buffer,
    recorded: Mutex<Recording>,
}

/// Measured intervals of a frame.
#[derive(Debug, Default)]
struct Recording {
    frame: u64,
    spans: Vec<Span>,
    choices: Vec<(u64, PathChoice)>,
    /// Queries used by the host, and by haze.
    host_queries: u32,
    own_queries: u32,
    missed: u32,
}

impl Timing {
    /// Creates the queries and read-back buffers; `None` if the device lacks `Features::TIMESTAMP_QUERY`.
    /// `device_number`: number of the device in the process.
    pub(crate) fn new(gpu: &Gpu<'_>, device_number: u64) -> Option<Self> {
        let Gpu { device, queue } = gpu;
        let features = device.features();
        let period = queue.get_timestamp_period();
        if !features.contains(wgpu::Features::TIMESTAMP_QUERY) || period <= 0.0 {
            return None;
        }
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("haze timing"),
                size: bytes(QUERIES),
                usage,
                mapped_at_creation: false,
            })
        };
        let read_back = |_| {
            let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
            Arc::new(ReadBack { buffer: buffer(usage), recorded: Mutex::default() })
        };
        Some(Self(Arc::new(Shared {
            device_number,
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("haze timing"),
                ty: wgpu::QueryType::Timestamp,
                count: QUERIES,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            read_backs: std::array::from_fn(read_back),
            ms_per_tick: f64::from(period) * 1.0e-6,
            inside_passes: features.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES),
            is_by_pass: AtomicBool::new(true),
            recording: Mutex::default(),
            results: Mutex::default(),
        })))
    }

    /// Returns `timestamp_writes` for the descriptor of a host's pass, to measure it under a label. `None` after 32
    /// passes in a frame.
    pub fn host_pass(&self, label: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.writes(label, true)
    }

    /// Ends the frame. Call it once, after the last pass; its commands go to the end of this encoder. Without this call
    /// there is no result. If a renderer is prepared twice before it, only the second time counts.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let shared = &*self.0;
        let mut recording = lock(&shared.recording);
        let next_frame = recording.frame + 1;
        if let Some(read_back) = shared.read_backs.iter().find(|read_back| Arc::strong_count(read_back) == 1) {
            for queries in [0..recording.host_queries, HOST_QUERIES..HOST_QUERIES + recording.own_queries] {
                if !queries.is_empty() {
                    let offset = bytes(queries.start);
                    let size = bytes(queries.end - queries.start);
                    encoder.resolve_query_set(&shared.queries, queries, &shared.resolved, offset);
                    encoder.copy_buffer_to_buffer(&shared.resolved, offset, &read_back.buffer, offset, size);
                }
            }
            std::mem::swap(&mut *recording, &mut *lock(&read_back.recorded));
            let timing = self.clone();
            let read_back = read_back.clone();
            let buffer = read_back.buffer.clone();
            encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |mapped| {
                if mapped.is_ok() {
                    timing.read(&read_back);
                }
            });
        }
        recording.start(next_frame);
    }

    /// Returns the newest result, from some frames ago; `None` before the first.
    pub fn latest(&self) -> Option<FrameTimes> {
        lock(&self.0.results).latest.clone()
    }

    /// Returns the number of the device in the process.
    pub(crate) fn device_number(&self) -> u64 {
        self.0.device_number
    }

    /// Registers that a renderer is prepared, and returns the current frame. `last`: the frame in which it was prepared
    /// before. If that is the current frame, its commands were dropped, or submitted without
    /// [`resolve`](Self::resolve), and the frame's recording is discarded.
    pub(crate) fn register_prepare(&self, last: Option<u64>) -> u64 {
        let mut recording = lock(&self.0.recording);
        if last == Some(recording.frame) {
            let next_frame = recording.frame + 1;
            recording.start(next_frame);
        }
        recording.frame
    }

    /// Sets what is measured. Call it between frames.
    pub fn set_detail(&self, detail: TimingDetail) {
        self.0.is_by_pass.store(detail == TimingDetail::Passes, Ordering::Relaxed);
    }

    /// Returns true if compute passes are measured one by one.
    pub(crate) fn is_by_pass(&self) -> bool {
        self.0.is_by_pass.load(Ordering::Relaxed)
    }

    pub(crate) fn add_choice(&self, key: u64, choice: PathChoice) {
        lock(&self.0.recording).choices.push((key, choice));
    }

    /// Returns the timestamp writes for the descriptor of a pass.
    pub(crate) fn pass(&self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.writes(name, false)
    }

    pub(crate) fn compute_pass(&self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let query = self.add(name, false)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.0.queries,
            beginning_of_pass_write_index: Some(query),
            end_of_pass_write_index: Some(query + 1),
        })
    }

    /// Measures the commands of `record` in a pass, if the device supports timestamps inside passes.
    pub(crate) fn measure_in_pass(
        timing: Option<&Self>,
        name: &'static str,
        pass: &mut wgpu::RenderPass<'_>,
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let able = timing.filter(|timing| timing.0.inside_passes);
        let span = able.and_then(|timing| Some((&timing.0.queries, timing.add(name, false)?)));
        if let Some((queries, query)) = span {
            pass.write_timestamp(queries, query);
        }
        record(pass);
        if let Some((queries, query)) = span {
            pass.write_timestamp(queries, query + 1);
        }
    }

    fn writes(&self, name: &'static str, is_host: bool) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let query = self.add(name, is_host)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &self.0.queries,
            beginning_of_pass_write_index: Some(query),
            end_of_pass_write_index: Some(query + 1),
        })
    }

    fn add(&self, name: &'static str, is_host: bool) -> Option<u32> {
        lock(&self.0.recording).add(name, is_host)
    }

    /// Reads the timestamps of a mapped buffer.
    fn read(&self, read_back: &ReadBack) {
        let Shared { results, ms_per_tick, .. } = &*self.0;
        if let Ok(view) = read_back.buffer.get_mapped_range(..) {
            let Recording { frame, spans, choices, missed, .. } = &*lock(&read_back.recorded);
            let tick = |query| bytemuck::pod_read_unaligned(&view[bytes(query) as usize..][..size_of::<u64>()]);
            lock(results).read(*frame, spans, choices, *missed, *ms_per_tick, tick);
        }
        read_back.buffer.unmap();
    }
}

impl Recording {
    /// Starts a frame and reuses the memory of the last.
    fn start(&mut self, frame: u64) {
        self.spans.clear();
        self.choices.clear();
        let spans = std::mem::take(&mut self.spans);
        let choices = std::mem::take(&mut self.choices);
        *self = Self { frame, spans, choices, ..Self::default() };
    }

    /// Adds an interval. Returns the first of its two queries, or `None` if no queries are left.
    fn add(&mut self, name: &'static str, is_host: bool) -> Option<u32> {
        let (taken, range) = if is_host {
            (&mut self.host_queries, 0..HOST_QUERIES)
        } else {
            (&mut self.own_queries, HOST_QUERIES..QUERIES)
        };
        let query = range.start + *taken;
        if query + 2 > range.end {
            self.missed += 1;
            return None;
        }
        *taken += 2;
        self.spans.push(Span { name, is_host, query });
        Some(query)
    }
}

/// Returns the bytes of this many timestamps.
fn bytes(queries: u32) -> u64 {
    u64::from(queries) * u64::from(wgpu::QUERY_SIZE)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
