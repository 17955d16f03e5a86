//! A suite of the benchmark, its groups and cases, and changes of a shot that suites share.

use clap::ValueEnum;
use haze_core::settings::{RenderPath, Settings};
use haze_demo::shot::Shot;

/// A suite of measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Suite {
    /// Buffer scale 1 to 1/8, by overdraw, format and path.
    Scale,
    /// 4 to 1024 layers of different alpha, by path.
    Overdraw,
    /// 1 to 64 lights, deferred against forward.
    Lights,
    /// Shadow of smoke on smoke: 3 to 15 lights, and resolutions of the grid.
    Shadow,
    /// Values that sprites carry: tint, heat, stretch, grain.
    Sprites,
    /// Every technique and every fade curve, against hard edges.
    Soft,
    /// Every depth downsample with every upsample filter.
    Upsample,
    /// Every preset, deferred at each scale against forward.
    Presets,
    /// Passes of the frame of every preset at each scale, on the path that `auto` takes.
    Frame,
    /// 1,000 to 1,000,000 particles: evaluating, sorting, drawing.
    Particles,
    /// The path `auto` against `raster` and `tiled`, which it chooses from, by overdraw, scale, technique and size.
    Auto,
    /// The limits of this adapter: bare blending, texture fetches, copies.
    Limits,
    /// All suites.
    All,
}

impl Suite {
    /// Name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

/// Shots that are measured in turn.
pub struct Group {
    pub suite: Suite,
    pub cases: Vec<Case>,
    /// Deferred shot at full resolution that the images are compared with.
    pub reference: Shot,
}

/// One shot to measure.
pub struct Case {
    /// Unique in its suite.
    pub name: String,
    pub shot: Shot,
    /// Kind of work and its amount. The cost of cases of one kind is about proportional to the amount, which predicts
    /// the ones that take too long.
    pub work: (String, f64),
}

/// Returns a shot with the settings of all systems changed.
pub fn changed(shot: &Shot, change: impl Fn(&mut Settings)) -> Shot {
    let mut shot = shot.clone();
    shot.preset.systems.iter_mut().for_each(|system| change(&mut system.settings));
    shot
}

/// Returns a change of settings to a path and a buffer scale.
pub fn at_scale(path: RenderPath, scale: u32) -> impl Fn(&mut Settings) {
    move |settings| {
        settings.path = path;
        settings.accumulate.fix_scale(scale);
    }
}

/// The reference of a group: deferred, at full resolution.
pub fn full_resolution(shot: &Shot) -> Shot {
    changed(shot, at_scale(RenderPath::Raster, 1))
}
