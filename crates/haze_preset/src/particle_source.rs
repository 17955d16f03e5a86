//! Particles of a system from files, instead of an emitter.

use std::path::{Component, Path};

use haze_core::glam::Vec3;
use haze_core::settings::{choice, settings};

use super::animation::MAX_TIME;
use super::sequence::Sequence;

choice! {
    /// Axis of a file that points up.
    UpAxis {
        /// y, as in Houdini.
        #[default]
        Y = "y",
        /// z, as in Blender.
        Z = "z",
    }
}

choice! {
    /// Continuation after the last frame.
    EndBehavior {
        /// The last frame stays.
        #[default]
        Hold = "hold",
        /// The sequence repeats, before its start too.
        Loop = "loop",
    }
}

settings! {
    /// Particles of a simulation, from files: docs/particles.md.
    #[derive(Clone, Debug, PartialEq)]
    pub struct ParticleFiles {
        /// CSV or PLY file, or one file per frame: `smoke_####.ply`, with `#` for the digits of the frame's number. It
        /// replaces the emitter; empty for none.
        path: String = String::new(), particles;
        /// Metres per unit of the file. Higher: larger smoke.
        units: f32 = 1.0, number(1.0e-6..=1.0e6, "m");
        /// Axis of the file that points up. With the wrong one the smoke lies on its side.
        up: UpAxis = UpAxis::Y, choice;
        /// Position of the file's origin. Moves all of the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Frames of the simulation per second. Higher: faster playback.
        fps: f32 = 24.0, number(0.01..=1000.0, "frames/s");
        /// Time at which the first frame is shown. Higher: delays the smoke.
        start: f32 = 0.0, number(-MAX_TIME..=MAX_TIME, "s");
        /// Continuation after the last frame: hold it, or repeat.
        after: EndBehavior = EndBehavior::Hold, choice;
        /// Radius of particles if the file has none. Higher: particles blur into each other. Lower: they show one by
        /// one.
        default_radius: f32 = 0.25, number(0.0..=1.0e3, "m");
        /// Amount of particles if the file has none. Higher: denser smoke.
        default_amount: f32 = 0.3, number(0.0..=1.0, "");
        /// Flipbook frames per second. Higher: puffs boil faster. 0: still.
        flipbook_rate: f32 = 4.0, number(0.0..=120.0, "frames/s");
    }
}

impl ParticleFiles {
    /// True if particles come from files.
    pub fn is_used(&self) -> bool {
        !self.path.is_empty()
    }
}

/// File that the path of particle files stands for, relative to the preset's folder. `None` if it is no CSV or PLY, lies
/// outside, or has more than one run of `#`.
pub fn particle_file_path(name: &str) -> Option<&Path> {
    let path = Path::new(name);
    let ending = path.extension()?;
    let is_known = ["csv", "ply"].iter().any(|known| ending.eq_ignore_ascii_case(known));
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let is_one_run = !name.contains('#') || Sequence::of(path).is_some();
    (is_known && stays && is_one_run).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particle_files_stay_inside_the_presets_folder() {
        for inside in ["a.ply", "sim/smoke_####.PLY", "./1_#.csv"] {
            assert_eq!(particle_file_path(inside), Some(Path::new(inside)));
        }
        for outside in ["", "../a.ply", "/a.ply", "a.png", "a", "a_#_#.ply", "s#/a.ply"] {
            assert_eq!(particle_file_path(outside), None, "{outside}");
        }
    }
}
