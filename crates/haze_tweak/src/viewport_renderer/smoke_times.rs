//! Times of the smoke of an image, and their source.

use eframe::wgpu;
use haze::Timing;

use super::cached_render::CachedRender;
use crate::platform::IS_PAGE;

/// Name of the only entry of [`TimeSource::WallTime`].
const WALL_TIME: &str = "Smoke";

/// Source of the times of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeSource {
    /// GPU timestamps around each pass.
    Timestamps,
    /// Wall time of the smoke, for which the window waits: lavapipe's timestamps of compute passes leave their work out.
    WallTime,
    /// CPU time of the whole frame.
    #[default]
    CpuTime,
}

impl TimeSource {
    /// Returns the best source of a device.
    pub fn of(adapter: &wgpu::AdapterInfo, features: wgpu::Features) -> Self {
        if adapter.device_type == wgpu::DeviceType::Cpu && !IS_PAGE {
            Self::WallTime
        } else if features.contains(wgpu::Features::TIMESTAMP_QUERY) {
            Self::Timestamps
        } else {
            Self::CpuTime
        }
    }
}

/// Times of the smoke of an image.
#[derive(Clone, Debug, Default)]
pub struct SmokeTimes {
    /// Number of the frame, which increases.
    pub frame: u64,
    /// Milliseconds of each pass, or of all.
    pub passes: Vec<(&'static str, f32)>,
}

impl SmokeTimes {
    /// Returns what was measured last of an image that was drawn `renders` times.
    pub fn latest(render: &CachedRender, renders: u64, timing: Option<&Timing>) -> Option<Self> {
        if let Some(time) = render.smoke_time {
            return Some(Self { frame: renders, passes: vec![(WALL_TIME, 1.0e3 * time.as_secs_f32())] });
        }
        let times = timing?.latest()?;
        let own = times.passes.iter().filter(|pass| !pass.is_host);
        Some(Self { frame: times.frame, passes: own.map(|pass| (pass.name, pass.ms)).collect() })
    }

    /// Returns the milliseconds of all passes.
    pub fn sum_ms(&self) -> f32 {
        self.passes.iter().map(|(_, ms)| ms).sum()
    }
}
