//! `haze bench soft-particles`: the experiment of NV's paper, section "Performance": two big sprites of size 3.2, drawn
//! 1000 times each, with the hardware depth test, with depth read from the depth buffer, and with depth read from a
//! linear target.

use std::path::Path;

use clap::Args;
use haze::read_only_depth_is_supported;
use haze_core::error::Error;
use haze_core::settings::{DepthSource, Technique};
use haze_demo::shot::Shot;
use haze_export::backend::Backend;
use haze_export::options::{RunArguments, whole_number};
use haze_export::output::{print_error, print_line};
use haze_preset::Preset;

use crate::frame_timer::{FrameTimer, measure_interleaved, median_of};

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    run: RunArguments,
    /// Number of times that the sprites are drawn per frame.
    #[arg(long, value_name = "N", default_value = "1000", allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(1..=10_000))]
    loops: u32,
    /// Number of measurements of each technique.
    #[arg(long, value_name = "N", default_value = "5", allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(1..=1000))]
    rounds: u32,
}

/// Techniques, with the paper's frames per second.
const TECHNIQUES: [(Technique, f64); 3] =
    [(Technique::Hard, 34.6), (Technique::Soft, 13.3), (Technique::SoftLinear, 26.7)];

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let path = Path::new("soft_particles.json");
    let preset = Preset::parse(path, include_str!("soft_particles.json"))?;
    let shot = Shot::new(preset, path, arguments.run.size)?;
    let backend = arguments.run.backend()?;
    let mut timer = FrameTimer::new(&backend)?;
    let reads_attached = match &backend {
        Backend::Gpu(gpu) => read_only_depth_is_supported(&gpu.headless.device),
        Backend::Cpu => true,
    };
    let mut variants = Vec::new();
    for source in [DepthSource::Reduced, DepthSource::Host] {
        for (technique, paper) in TECHNIQUES {
            if source == DepthSource::Host && technique == Technique::Soft && !reads_attached {
                print_error("left out: host soft; this backend cannot sample the depth buffer that it tests against");
                continue;
            }
            let mut shot = shot.clone();
            for system in &mut shot.preset.systems {
                let settings = &mut system.settings;
                settings.technique = technique;
                settings.debug.draw_count = arguments.loops;
                settings.path = arguments.run.path.unwrap_or(settings.path);
                settings.accumulate.depth_source = source;
            }
            variants.push(Variant { technique, source, paper, shot });
        }
    }
    let costs =
        measure_interleaved(arguments.rounds, variants.len(), |variant| timer.frame_seconds(&variants[variant].shot))?;

    let size = arguments.run.size;
    print_line!(
        "two sprites of size 3.2, drawn {} times, {}x{}, on {}; {}",
        arguments.loops,
        size.x,
        size.y,
        backend.description(),
        median_of(arguments.rounds)
    )?;
    print_line!("depth    technique      fps here   spread   / hard   fps NV 2007   / hard")?;
    let mut hard = 1.0;
    for (variant, cost) in variants.iter().zip(&costs) {
        if variant.technique == Technique::Hard {
            hard = cost.median();
        }
        print_line!(
            "{:<8} {:<12} {:>10.3} {:>8} {:>8.2} {:>13.1} {:>8.2}",
            variant.source.name(),
            variant.technique.name(),
            1.0 / cost.median(),
            cost.spread().map_or("-".into(), |spread| format!("{:.1}%", 100.0 * spread)),
            cost.median() / hard,
            variant.paper,
            TECHNIQUES[0].1 / variant.paper
        )?;
    }
    Ok(())
}

struct Variant {
    technique: Technique,
    /// `reduced`, at scale 1, is linearized once per frame; `host` reads the host's depth buffer directly, as the paper
    /// does.
    source: DepthSource,
    /// Frames per second in the paper.
    paper: f64,
    shot: Shot,
}
