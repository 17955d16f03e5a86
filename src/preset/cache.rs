//! Particles of a system from files, in place of an emitter.

use std::path::{Component, Path};

use glam::{UVec3, Vec3};

use crate::assets::cache::{Around, Cache, Sequence};
use crate::assets::noise::{pcg3d, unit};
use crate::frame::Particle;
use crate::settings::{choice, settings};

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
    CacheEnd {
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
    pub struct CacheSource {
        /// CSV or PLY file, or one file per frame: `smoke_####.ply`, with `#` for the digits of the frame's number. It
        /// replaces the emitter; empty for none.
        path: String = String::new(), particles;
        /// Metres per unit of the file. Higher: larger smoke.
        units: f32 = 1.0, number(1.0e-6..=1.0e6, "m");
        /// Axis of the file that points up. With the wrong one the smoke lies on its side.
        up: UpAxis = UpAxis::Y, choice;
        /// Position of the file's origin. Moves all of the smoke.
        #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::ZERO, vector(-1.0e5..=1.0e5, "m");
        /// Frames of the simulation per second. Higher: faster playback.
        fps: f32 = 24.0, number(0.01..=1000.0, "frames/s");
        /// Time at which the first frame is shown. Higher: delays the smoke.
        start: f32 = 0.0, number(-1.0e5..=1.0e5, "s");
        /// Continuation after the last frame: hold it, or repeat.
        after: CacheEnd = CacheEnd::Hold, choice;
        /// Radius of particles if the file has none. Higher: particles blur into each other. Lower: they show one by
        /// one.
        default_radius: f32 = 0.25, number(0.0..=1.0e3, "m");
        /// Amount of particles if the file has none. Higher: denser smoke.
        default_amount: f32 = 0.3, number(0.0..=1.0, "");
        /// Flipbook frames per second. Higher: puffs boil faster. 0: still.
        flipbook_rate: f32 = 4.0, number(0.0..=120.0, "frames/s");
    }
}

impl CacheSource {
    /// True if particles come from files.
    pub fn is_used(&self) -> bool {
        !self.path.is_empty()
    }

    /// Replaces `particles` with those at `time`, seconds. The same input gives the same output.
    pub fn evaluate(&self, cache: &Cache, time: f32, particles: &mut Vec<Particle>) {
        particles.clear();
        let mut frame = (f64::from(time) - f64::from(self.start)) * f64::from(self.fps);
        if self.after == CacheEnd::Loop {
            frame = frame.rem_euclid(f64::from(cache.length()));
        }
        let Some(Around { before, after, share }) = cache.around(frame) else { return };
        let given = before.given();
        before.between(after, share, |cached, there| {
            let id = cached.id as u64;
            let random = pcg3d(UVec3::new(id as u32, (id >> 32) as u32, 0));
            let [x, y, z] = cached.position.to_array();
            let position = if self.up == UpAxis::Z { Vec3::new(x, z, -y) } else { cached.position };
            particles.push(Particle {
                position: self.position + position * self.units,
                radius: if given.radius { cached.radius * self.units } else { self.default_radius },
                // Random rotations hide that all sprites have the same image.
                rotation: if given.rotation { cached.rotation } else { unit(random.x) * std::f32::consts::TAU },
                amount: there * if given.amount { cached.amount } else { self.default_amount },
                frame: unit(random.y) * 256.0 + time * self.flipbook_rate,
                age: cached.age,
            });
        });
    }
}

/// File that the path of a cache stands for, relative to the preset's folder. `None` if it is no CSV or PLY, lies
/// outside, or has more than one run of `#`.
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
    use crate::assets::cache::Limits;

    fn cache(texts: &[&str]) -> Cache {
        let folder = tempfile::tempdir().unwrap();
        for (number, text) in texts.iter().enumerate() {
            std::fs::write(folder.path().join(format!("{number}.csv")), text).unwrap();
        }
        Cache::load(&folder.path().join("#.csv"), Limits { particles: 9, bytes: 1 << 20 }).unwrap()
    }

    fn at(source: &CacheSource, cache: &Cache, time: f32) -> Vec<Particle> {
        let mut particles = Vec::new();
        source.evaluate(cache, time, &mut particles);
        particles
    }

    #[test]
    fn units_and_up_axis_of_the_settings_are_applied() {
        let cache = cache(&["x,y,z,pscale,amount,rotation,age\n1,2,3,4,0.5,6,0.25"]);
        let plain = CacheSource { flipbook_rate: 0.0, ..CacheSource::default() };
        let [y_up] = at(&plain, &cache, 0.0)[..] else { panic!("one particle") };
        assert_eq!((y_up.position, y_up.radius), (Vec3::new(1.0, 2.0, 3.0), 4.0));
        assert_eq!((y_up.amount, y_up.rotation, y_up.age), (0.5, 6.0, 0.25));
        let moved = CacheSource { up: UpAxis::Z, units: 0.01, position: Vec3::new(0.0, 10.0, 0.0), ..plain };
        let [z_up] = at(&moved, &cache, 0.0)[..] else { panic!("one particle") };
        // Blender's forward axis, y, points away from the viewer.
        assert!(z_up.position.distance(Vec3::new(0.01, 10.03, -0.02)) < 1e-6 && (z_up.radius - 0.04).abs() < 1e-7);
        assert_eq!(Particle { position: y_up.position, radius: y_up.radius, ..z_up }, y_up);
    }

    #[test]
    fn last_frame_is_held_or_the_sequence_repeats() {
        let cache = cache(&["id,x,y,z\n1,0,0,0", "id,x,y,z\n1,1,0,0\n2,0,0,0", "id,x,y,z\n2,4,0,0"]);
        let mut source = CacheSource { fps: 2.0, start: 1.0, default_amount: 0.4, ..CacheSource::default() };
        let mut seen = |after, time| {
            source.after = after;
            at(&source, &cache, time).iter().map(|particle| (particle.position.x, particle.amount)).collect::<Vec<_>>()
        };
        assert_eq!(seen(CacheEnd::Hold, 0.9), []);
        assert_eq!(seen(CacheEnd::Hold, 1.0), [(0.0, 0.4)]);
        assert_eq!(seen(CacheEnd::Hold, 1.25), [(0.5, 0.4), (0.0, 0.2)]);
        assert_eq!(seen(CacheEnd::Hold, 1.75), [(1.0, 0.2), (2.0, 0.4)]);
        assert_eq!(seen(CacheEnd::Hold, 50.0), [(4.0, 0.4)]);
        assert_eq!(seen(CacheEnd::Loop, 2.25), [(4.0, 0.4)]);
        for turn in [-3.0, 0.0, 3.0] {
            assert_eq!(seen(CacheEnd::Loop, 2.75 + turn), [(0.5, 0.4), (0.0, 0.2)]);
        }
    }

    #[test]
    fn missing_columns_come_from_the_settings_and_stay_with_the_id() {
        let cache = cache(&["id,x,y,z\n7,0,0,0\n8,0,0,0", "id,x,y,z\n8,0,0,0\n7,0,0,0"]);
        let source = CacheSource { default_radius: 0.5, fps: 1.0, flipbook_rate: 0.0, ..CacheSource::default() };
        let (first, second) = (at(&source, &cache, 0.0), at(&source, &cache, 1.0));
        assert_eq!(first, second);
        assert_eq!((first[0].radius, first[0].amount), (0.5, 0.3));
        let apart = [first[0].rotation - first[1].rotation, first[0].frame - first[1].frame];
        assert!(apart.iter().all(|apart| apart.abs() > 0.01) && first.iter().all(Particle::is_valid));
    }

    #[test]
    fn particle_files_stay_inside_the_presets_folder() {
        for inside in ["a.ply", "sim/smoke_####.PLY", "./1_#.csv"] {
            assert_eq!(cache_file(inside), Some(Path::new(inside)));
        }
        for outside in ["", "../a.ply", "/a.ply", "a.png", "a", "a_#_#.ply", "s#/a.ply"] {
            assert_eq!(cache_file(outside), None, "{outside}");
        }
    }
}
