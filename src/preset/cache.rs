//! Particles of a system that come from files in place of an emitter.

use std::path::{Component, Path};

use glam::Vec3;

use super::sequence::Sequence;
use crate::settings::{choice, settings};

choice! {
    /// Which axis of a file points up.
    UpAxis {
        /// y, as Houdini has it.
        #[default]
        Y = "y",
        /// z, as Blender has it.
        Z = "z",
    }
}

choice! {
    /// What follows the last frame.
    CacheEnd {
        /// The last frame stays.
        #[default]
        Hold = "hold",
        /// The first frame; it has always been so.
        Loop = "loop",
    }
}

settings! {
    /// Particles from a simulation, in files: docs/particles.md.
    #[derive(Clone, Debug, PartialEq)]
    pub struct CacheSource {
        /// A CSV or PLY file, or one a frame: `smoke_####.ply`, with `#` for the digits of the frame's number. It takes the place of
        /// the emitter; empty for none.
        path: String = String::new(), particles;
        /// Metres of one unit of the file: sizes and distances of the smoke grow with it.
        units: f32 = 1.0, number(1.0e-6..=1.0e6, "m");
        /// Which axis of the file points up: with the wrong one the smoke lies on its side.
        up: UpAxis = UpAxis::Y, choice;
        /// Where the file's origin is: moves all of the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Frames of the simulation per second: more plays it faster.
        fps: f32 = 24.0, number(0.01..=1000.0, "frames/s");
        /// When the first frame is shown: later holds it back.
        start: f32 = 0.0, number(-1.0e5..=1.0e5, "s");
        /// What follows the last frame.
        after: CacheEnd = CacheEnd::Hold, choice;
        /// Radius of particles of a file without one: large ones blur into each other, small ones show one by one.
        default_radius: f32 = 0.25, number(0.0..=1.0e3, "m");
        /// Amount of particles of a file without one: how dense the smoke is.
        default_amount: f32 = 0.3, number(0.0..=1.0, "");
        /// Flipbook frames per second: how fast each puff boils. 0: still.
        flipbook_rate: f32 = 4.0, number(0.0..=120.0, "frames/s");
    }
}

impl CacheSource {
    /// Whether particles come from files.
    pub fn is_used(&self) -> bool {
        !self.path.is_empty()
    }
}

/// The file that the path of a cache stands for, from the preset's folder on; none for what is no CSV or PLY, and for what lies
/// outside.
pub fn cache_file(name: &str) -> Option<&Path> {
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
    fn caches_stay_inside_the_presets_folder() {
        for inside in ["a.ply", "sim/smoke_####.PLY", "./1_#.csv"] {
            assert_eq!(cache_file(inside), Some(Path::new(inside)));
        }
        for outside in ["", "../a.ply", "/a.ply", "a.png", "a", "a_#_#.ply", "s#/a.ply"] {
            assert_eq!(cache_file(outside), None, "{outside}");
        }
    }
}
