//! Options of a run of `haze bench`, the order of its measurements, and its output files.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use glam::UVec2;
use haze::wgpu;
use haze_core::error::Error;
use haze_demo::headless::Headless;
use haze_export::interrupt;
use haze_export::options::{parse_size, whole_number};
use haze_export::output::{Failures, FileChecks};
use haze_export::progress::with_progress;
use haze_preset::write_file;

use super::adapter::adapter;
use super::clock_keepalive::ClockKeepalive;
use super::limits;
use super::measure::CaseBench;
use super::particle_cpu_time;
use super::report::{Report, VERSION};
use super::run_time::RunTime;
use super::stop::check_stop;
use super::suites::{Group, Suite, groups};

#[derive(Args)]
#[group(id = "run")]
pub struct Arguments {
    /// Suite to measure.
    #[arg(value_enum, default_value = "all")]
    suite: Suite,
    /// Measure for two minutes instead of ten, with fewer cases.
    #[arg(long)]
    quick: bool,
    /// Seconds of the run, about, after the limits of the adapter. Each case is prepared, checked and measured three times even
    /// if they do not suffice; a line then says how long it will take. Default: 100 with --quick, else 360.
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(0..=86_400))]
    seconds: Option<u32>,
    /// Image size in pixels. Default: 1280x720, or 640x360 on a software adapter.
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    size: Option<UVec2>,
    /// Write the report as JSON.
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
    /// Write the rows as CSV.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Write an HTML page with charts.
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
}

/// Default seconds of measurement of a run.
const QUICK: u32 = 100;
const THOROUGH: u32 = 360;
/// Suites that render shots; the limits are measured before them.
const SHOTS: [Suite; 11] = [
    Suite::Scale,
    Suite::Overdraw,
    Suite::Lights,
    Suite::Shadow,
    Suite::Sprites,
    Suite::Soft,
    Suite::Upsample,
    Suite::Presets,
    Suite::Frame,
    Suite::Particles,
    Suite::Auto,
];

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    let mut files = FileChecks::for_inputs::<PathBuf>([]);
    for (option, path, kind) in arguments.outputs() {
        files.check_output(option, path, kind)?;
    }
    let features = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
    let gpu = Headless::with(wgpu::Limits::default(), features)?;
    interrupt::catch();
    let keepalive = ClockKeepalive::new(&gpu)?;
    let (report, failure) = keepalive.during(|| measure(arguments, &gpu, &keepalive));
    super::terminal_table::write(&report)?;
    arguments.write(&report)?;
    failure.map_or(Ok(()), |error| Err(error.into()))
}

/// Returns everything that was measured, and the error that ended the run early, if there was one.
fn measure(arguments: &Arguments, gpu: &Headless, keepalive: &ClockKeepalive<'_>) -> (Report, Option<Error>) {
    let mut report = Report {
        version: VERSION,
        adapter: adapter(gpu),
        complete: false,
        discarded: 0,
        rows: Vec::new(),
        left_out: Vec::new(),
    };
    let size =
        arguments.size.unwrap_or(if report.adapter.software { UVec2::new(640, 360) } else { UVec2::new(1280, 720) });
    let longest = Duration::from_millis(if arguments.quick { 1500 } else { 2000 });
    let mut bench = CaseBench::new(gpu, keepalive, longest);
    let result = bench.measure_paths().and_then(|()| arguments.all(gpu, keepalive, &mut bench, size));
    report.discarded = bench.discarded;
    report.rows = bench.rows;
    report.left_out = bench.left_out;
    report.complete = result.is_ok();
    (report, result.err())
}

impl Arguments {
    /// Returns the requested outputs: option, path, file extension.
    fn outputs(&self) -> impl Iterator<Item = (&'static str, &PathBuf, &'static str)> {
        let all = [("--json", &self.json, "json"), ("--csv", &self.csv, "csv"), ("--html", &self.html, "html")];
        all.into_iter().filter_map(|(option, path, kind)| Some((option, path.as_ref()?, kind)))
    }

    fn suites(&self) -> impl Iterator<Item = Suite> {
        SHOTS.into_iter().filter(|&suite| self.suite == Suite::All || self.suite == suite)
    }

    /// Measures all requested suites.
    fn all(
        &self,
        gpu: &Headless,
        keepalive: &ClockKeepalive<'_>,
        bench: &mut CaseBench<'_>,
        size: UVec2,
    ) -> Result<(), Error> {
        // All other rows are compared with the limits.
        let limits = with_progress("haze: measuring the limits of this adapter".into(), || {
            limits::measure(gpu, keepalive, size, self.quick)
        })?;
        bench.limits = limits.floor;
        bench.copy_rate = limits.copy_rate;
        bench.discarded = limits.discarded;
        if matches!(self.suite, Suite::All | Suite::Limits) {
            bench.rows.extend(limits.rows);
        }
        let groups: Vec<Group> = self
            .suites()
            // In full, this suite of sixty cases would take a third of the time of all suites.
            .map(|suite| groups(suite, size, self.quick || (suite == Suite::Auto && self.suite == Suite::All)))
            .collect::<Result<Vec<_>, _>>()?
            .into_iter()
            .flatten()
            .collect();
        let whole = Duration::from_secs(self.seconds.unwrap_or(if self.quick { QUICK } else { THOROUGH }).into());
        let mut time = RunTime::start(whole);
        for (index, group) in groups.iter().enumerate() {
            let left: usize = groups[index..].iter().map(|group| group.cases.len()).sum();
            if let Some(text) = time.overrun(left) {
                eprintln!("{text}");
            }
            let what = format!(
                "haze: {}, group {} of {}, about {} s left",
                group.suite.name(),
                index + 1,
                groups.len(),
                time.remaining(left).as_secs()
            );
            let budget = time.budget(group.cases.len(), left);
            let least = with_progress(what, || bench.group(group, budget))?;
            time.add(least, group.cases.len());
            if group.suite == Suite::Particles {
                // The CPU is measured without filler work on the GPU.
                let _pause = keepalive.pause();
                let rows = particle_cpu_time::rows(gpu, group)?;
                bench.rows.extend(rows);
            }
        }
        check_stop()
    }

    fn write(&self, report: &Report) -> Result<(), Error> {
        for (option, path, _) in self.outputs() {
            let text = match option {
                "--json" => super::report_json::json(report),
                "--csv" => super::report_csv::csv(report),
                _ => super::page::page(report),
            };
            write_file(path, text.as_bytes())?;
        }
        Ok(())
    }
}
