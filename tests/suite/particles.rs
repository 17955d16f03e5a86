//! Time to load large particle files.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::time::{Duration, Instant};

use haze::preset::{AssetFolders, Preset, PresetSystem};
use haze_author::particle_files;

/// Returns a binary PLY file of moving particles, with columns that are not read.
fn binary(frame: u32, count: u32) -> Vec<u8> {
    let names = ["x", "y", "z", "nx", "ny", "nz", "pscale", "age"].map(|name| format!("property float {name}\n"));
    let names = names.concat() + "property uchar alpha\nproperty int id\n";
    let head = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{names}end_header\n");
    let mut file = head.into_bytes();
    for id in 0..count {
        let x = id as f32 * 0.01 + frame as f32;
        [x, 1.0, 2.0, 0.0, 0.0, 1.0, 0.25, 0.5].iter().for_each(|value: &f32| file.extend(value.to_le_bytes()));
        file.push(128);
        file.extend(id.to_le_bytes());
    }
    file
}

/// A release build on an idle machine takes at most a second and a millisecond. Tests are optimized too, but share the
/// machine with others, so the limits are four times that.
#[test]
fn a_hundred_frames_of_ten_thousand_particles_load_in_a_second_and_evaluate_in_a_millisecond() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..100 {
        std::fs::write(folder.path().join(format!("s{number}.ply")), binary(number, 10_000)).unwrap();
    }
    let mut system = PresetSystem::default();
    system.cache.path = "s#.ply".into();
    let preset = Preset { systems: vec![system], ..Preset::default() };
    let start = Instant::now();
    let caches =
        particle_files::load_particle_files(&preset, "my.json".as_ref(), &AssetFolders::at(folder.path())).unwrap();
    let read = start.elapsed();
    let (mut particles, mut seen) = (Vec::new(), Duration::MAX);
    for _ in 0..10 {
        let start = Instant::now();
        // A time between two frames.
        particle_files::particles(&preset.systems[0], caches[0].as_ref(), 41.5 / 24.0, &mut particles);
        seen = seen.min(start.elapsed());
        assert_eq!(particles.len(), 10_000);
    }
    println!("read in {read:?}, seen in {seen:?}");
    assert!(read < Duration::from_secs(4) && seen < Duration::from_millis(4), "{read:?} {seen:?}");
}
