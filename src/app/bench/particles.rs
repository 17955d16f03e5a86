//! What particles cost a CPU core before anything is drawn: evaluating them, sorting and uploading them.

use std::time::Instant;

use haze::demo::stage::{Stage, StageContext};
use haze::headless::Headless;
use haze::settings::{Order, ShadeTree};
use haze::{Error, wgpu};

use super::measure::size_name;
use super::report::{Clock, Milliseconds, Row};
use super::suites::{Group, Suite};
use crate::app::interrupt;

const ROUNDS: u32 = 9;

/// Three rows for the shot of a group: the emitter, and a whole `prepare` with and without the sort.
pub fn rows(gpu: &Headless, context: &StageContext, group: &Group) -> Result<Vec<Row>, Error> {
    let shot = &group.reference;
    let ordered = [Order::Sorted, Order::Weighted].map(|order| {
        let mut shot = shot.clone();
        shot.preset.systems.iter_mut().for_each(|system| system.settings.accumulate.order = order);
        shot
    });
    let mut stages = [Stage::new(context, false)?, Stage::new(context, false)?];
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    let mut particles = Vec::new();
    for round in 0..=ROUNDS {
        if interrupt::is_asked() {
            break;
        }
        let started = Instant::now();
        shot.preset.systems.iter().for_each(|system| system.particles(None, shot.preset.time, &mut particles));
        let mut found = vec![started.elapsed().as_secs_f64() * 1000.0];
        for (stage, shot) in stages.iter_mut().zip(&ordered) {
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let started = Instant::now();
            stage.record(&mut encoder, shot, &[ShadeTree::Final])?;
            // Recording evaluates the emitter as well.
            found.push((started.elapsed().as_secs_f64() * 1000.0 - found[0]).max(0.0));
            gpu.submit(encoder)?;
        }
        if round > 0 {
            times.iter_mut().zip(found).for_each(|(times, ms)| times.push(ms));
        }
    }
    let count = particles.len() as u32;
    let names = ["evaluate", "prepare sorted", "prepare weighted"];
    let row = |(name, times): (&str, &mut Vec<f64>)| {
        Some(Row {
            particles: Some(count),
            samples: times.len() as u32,
            ..Row::of(
                Suite::Particles,
                format!("{name} {count} particles"),
                size_name(shot.size),
                Clock::Cpu,
                Milliseconds::of(times)?,
            )
        })
    };
    Ok(names.into_iter().zip(&mut times).filter_map(row).collect())
}
