//! GPU time by timestamps: queries written by passes, resolved once a frame, read back when the GPU is done.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::frame_times::{FrameTimes, Results, Span};
use crate::renderer::auto::PathChoice;

/// Queries for passes of the host, first in the set. They are apart from the others, so that whenever the host uses them, none is
/// written twice in a pass, which wgpu refuses.
const HOST_QUERIES: u32 = 64;

/// All queries, two an interval: some 100 systems.
const QUERIES: u32 = 1024;

/// Frames that may be in flight. When more are, some are not measured.
const READ_BACKS: usize = 4;

/// Measures the GPU time of every pass. A clone is the same; one serves all renderers of a frame.
///
/// Hand it to the renderers with [`Renderer::set_timing`](crate::Renderer::set_timing) and call [`resolve`](Self::resolve) at the
/// end of the frame's last encoder. Results come some frames later, without waiting: whichever submission finds the GPU
/// done brings them.
///
/// The passes that haze begins itself (`depth_downsample`, `diffuse_bake`, `accumulate`, `light_target`, and those of the path
/// `tiled`) are always measured; those that it
/// records into the host's pass (`transfer`, `specular_scatter`, `forward`) where the device has
/// `Features::TIMESTAMP_QUERY_INSIDE_PASSES`. Elsewhere [`host_pass`](Self::host_pass) measures the whole of the host's pass. A
/// device without `Features::TIMESTAMP_QUERY` measures nothing: there a host can take the CPU time of its calls, and should say
/// that this is what it shows, for it tells little of the GPU.
///
/// At most 480 intervals of haze and 32 of the host are measured in a frame; what is beyond is counted in
/// [`FrameTimes::discarded`].
#[derive(Clone, Debug)]
pub struct Timing(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    device: wgpu::Device,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_backs: [Arc<ReadBack>; READ_BACKS],
    ms_per_tick: f64,
    inside_passes: bool,
    recording: Mutex<Recording>,
    results: Mutex<Results>,
}

/// A buffer, and what was recorded of the frame whose timestamps come into it. In use while the encoder, or wgpu after it, holds
/// another share of it.
#[derive(Debug)]
struct ReadBack {
    buffer: wgpu::Buffer,
    recorded: Mutex<Recording>,
}

/// What is measured in a frame.
#[derive(Debug, Default)]
struct Recording {
    frame: u64,
    spans: Vec<Span>,
    choices: Vec<(u64, PathChoice)>,
    /// Queries taken, of the host's and of all others.
    host_queries: u32,
    own_queries: u32,
    missed: u32,
}

impl Timing {
    /// `None` where the device lacks `Features::TIMESTAMP_QUERY`.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
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
            device: device.clone(),
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("haze timing"),
                ty: wgpu::QueryType::Timestamp,
                count: QUERIES,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            read_backs: std::array::from_fn(read_back),
            ms_per_tick: f64::from(period) * 1.0e-6,
            inside_passes: features.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES),
            recording: Mutex::default(),
            results: Mutex::default(),
        })))
    }

    /// To measure a pass of the host under a label: `timestamp_writes` of its descriptor. `None` beyond 32 a frame.
    pub fn host_pass(&self, label: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.writes(label, true)
    }

    /// Ends the frame. Call it once, after the last pass: the commands go to the end of this encoder. Without it there is no
    /// result; of a renderer that is prepared twice before, only the second time counts.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let shared = &*self.0;
        let mut recording = lock(&shared.recording);
        let next_frame = recording.frame + 1;
        if let Some(read_back) = shared.read_backs.iter().find(|read_back| Arc::strong_count(read_back) == 1) {
            for queries in [0..recording.host_queries, HOST_QUERIES..HOST_QUERIES + recording.own_queries] {
                if !queries.is_empty() {
                    let (offset, size) = (bytes(queries.start), bytes(queries.end - queries.start));
                    encoder.resolve_query_set(&shared.queries, queries, &shared.resolved, offset);
                    encoder.copy_buffer_to_buffer(&shared.resolved, offset, &read_back.buffer, offset, size);
                }
            }
            std::mem::swap(&mut *recording, &mut *lock(&read_back.recorded));
            let (timing, read_back) = (self.clone(), read_back.clone());
            let buffer = read_back.buffer.clone();
            encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |mapped| {
                if mapped.is_ok() {
                    timing.read(&read_back);
                }
            });
        }
        recording.start(next_frame);
    }

    /// The newest result, from some frames ago; `None` before the first.
    pub fn latest(&self) -> Option<FrameTimes> {
        lock(&self.0.results).latest.clone()
    }

    pub(crate) fn is_of(&self, device: &wgpu::Device) -> bool {
        self.0.device == *device
    }

    /// A renderer is prepared, last in the frame `last`, and this is the frame now. If that was this one, its commands were
    /// dropped, or submitted without [`resolve`](Self::resolve), and what was recorded goes.
    pub(crate) fn enter(&self, last: Option<u64>) -> u64 {
        let mut recording = lock(&self.0.recording);
        if last == Some(recording.frame) {
            let next_frame = recording.frame + 1;
            recording.start(next_frame);
        }
        recording.frame
    }

    pub(crate) fn add_choice(&self, key: u64, choice: PathChoice) {
        lock(&self.0.recording).choices.push((key, choice));
    }

    /// For the descriptor of a pass.
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

    /// Measures what `record` records into a pass, where the device can.
    pub(crate) fn inside(
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

    fn writes(&self, name: &'static str, of_host: bool) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let query = self.add(name, of_host)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &self.0.queries,
            beginning_of_pass_write_index: Some(query),
            end_of_pass_write_index: Some(query + 1),
        })
    }

    fn add(&self, name: &'static str, of_host: bool) -> Option<u32> {
        lock(&self.0.recording).add(name, of_host)
    }

    /// Takes what has come into a buffer that is mapped.
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
    /// Starts a frame, with the memory of the last.
    fn start(&mut self, frame: u64) {
        self.spans.clear();
        self.choices.clear();
        let (spans, choices) = (std::mem::take(&mut self.spans), std::mem::take(&mut self.choices));
        *self = Self { frame, spans, choices, ..Self::default() };
    }

    /// The first of the two queries of one more interval.
    fn add(&mut self, name: &'static str, of_host: bool) -> Option<u32> {
        let (taken, range) = if of_host {
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
        self.spans.push(Span { name, of_host, query });
        Some(query)
    }
}

/// Bytes of so many timestamps.
fn bytes(queries: u32) -> u64 {
    u64::from(queries) * u64::from(wgpu::QUERY_SIZE)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
