//! Measures the best this adapter can do without any code of haze: the floor that all other figures are compared with.

use std::collections::HashMap;

use glam::UVec2;
use haze::wgpu;
use haze_core::error::Error;
use haze_core::settings::AccumulationFormat;
use haze_demo::headless::Headless;
use haze_export::interrupt;

use super::clock_keepalive::ClockKeepalive;
use super::limit_work::{LimitBench, Work, bytes, texture};
use super::report::{Clock, Milliseconds, Row};
use super::suites::Suite;

/// Times of the bare passes: milliseconds per fragment of an unlit disc, by format, and a row for every case.
pub struct Limits {
    pub floor: HashMap<AccumulationFormat, f64>,
    /// Bytes that a copy reads and writes per millisecond; `None` if it was not measured.
    pub copy_rate: Option<f64>,
    pub rows: Vec<Row>,
    /// Number of timestamps that were reversed or zero.
    pub discarded: u64,
}

/// One case to measure.
struct LimitCase {
    name: String,
    work: Work,
    /// Fragments of a draw, or texels times layers of a dispatch; 0 if it has none.
    fragments: u64,
    /// Least number of bytes that are moved; 0 for an empty pass.
    bytes: u64,
    /// Format whose floor this case sets or is compared with.
    format: Option<AccumulationFormat>,
}

/// Measures all cases in turn, round by round; the first round is a warm-up.
pub fn measure(gpu: &Headless, keepalive: &ClockKeepalive<'_>, size: UVec2, quick: bool) -> Result<Limits, Error> {
    let (layers, rounds) = if quick { (16, 5) } else { (32, 15) };
    let bench = LimitBench::new(gpu, size);
    let cases = limit_cases(&bench, layers);
    gpu.check()?;
    let mut times = vec![Vec::new(); cases.len()];
    let mut discarded = 0;
    for round in 0..=rounds {
        if interrupt::is_requested() {
            break;
        }
        for (case, times) in cases.iter().zip(&mut times) {
            let pause = keepalive.pause();
            let ms = bench.frame(&case.work)?;
            drop(pause);
            discarded += u64::from(ms.is_none());
            times.extend(ms.filter(|_| round > 0));
        }
    }
    let mut floor = HashMap::new();
    let mut copy_rate = None;
    let mut rows = Vec::new();
    for (case, times) in cases.iter().zip(&mut times) {
        let Some(gpu_ms) = Milliseconds::of(times) else { continue };
        let per_fragment = gpu_ms.median / case.fragments.max(1) as f64;
        if let Some(format) = case.format {
            // The first case of a format sets its floor.
            floor.entry(format).or_insert(per_fragment);
        }
        if matches!(case.work, Work::Copy { .. }) {
            copy_rate = Some(case.bytes as f64 / gpu_ms.median);
        }
        let clock = if bench.is_timed(&case.work) { Clock::Gpu } else { Clock::Wall };
        let rate = (case.fragments > 0).then(|| case.fragments as f64 / gpu_ms.median * 1.0e-6);
        rows.push(Row {
            format: case.format.map(|format| format.name().into()),
            samples: times.len() as u32,
            fragments: (case.fragments > 0).then_some(case.fragments),
            gfragments_per_s: rate.filter(|_| case.bytes > 0),
            bytes: (case.bytes > 0).then_some(case.bytes),
            limit_ratio: case.format.and_then(|format| floor.get(&format)).map(|limit| per_fragment / limit),
            ..Row::of(Suite::Limits, case.name.clone(), size, clock, gpu_ms)
        });
    }
    Ok(Limits { floor, copy_rate, rows, discarded })
}

/// Lists the cases. The first case of every format is its floor: an unlit disc.
fn limit_cases(bench: &LimitBench<'_>, layers: u32) -> Vec<LimitCase> {
    let pixels = u64::from(bench.size.x) * u64::from(bench.size.y);
    let mut all = vec![LimitCase {
        name: "empty pass".into(),
        work: bench.draw(None, AccumulationFormat::Rgba16Float, 0),
        fragments: 0,
        bytes: 0,
        format: None,
    }];
    for &format in AccumulationFormat::ALL {
        for (what, entry) in [("disc", "one_fetch"), ("disc of two fetches", "two_fetches"), ("blend", "constant")] {
            let fragments = pixels * u64::from(layers);
            all.push(LimitCase {
                name: format!("{what} {}", format.name()),
                work: bench.draw(Some(entry), format, layers),
                fragments,
                bytes: fragments * 2 * u64::from(bytes(format)),
                format: Some(format),
            });
        }
    }
    all.push(LimitCase {
        name: "joint bilateral".into(),
        work: bench.draw(Some("joint_bilateral"), AccumulationFormat::Rgba16Float, 1),
        fragments: pixels,
        bytes: pixels * 2 * u64::from(bytes(AccumulationFormat::Rgba16Float)),
        format: None,
    });
    if bench.gpu.adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
        all.push(LimitCase {
            name: "disc in compute".into(),
            work: bench.compute(layers),
            fragments: pixels * u64::from(layers),
            // Compute writes every texel once.
            bytes: pixels * 8,
            format: None,
        });
    }
    let times = 16;
    let usage = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST;
    let [from, to] = [(); 2].map(|()| texture(bench.gpu, bench.size, wgpu::TextureFormat::Rgba16Float, usage));
    all.push(LimitCase {
        name: "copy".into(),
        work: Work::Copy { from, to, times },
        fragments: 0,
        bytes: pixels * 8 * 2 * u64::from(times),
        format: None,
    });
    all
}
