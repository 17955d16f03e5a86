//! Particle files of a large simulation.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use haze_author::particle_files;
use haze_preset::{AssetFolders, Preset, PresetSystem};

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

#[test]
fn a_hundred_frames_of_ten_thousand_particles_are_kept_in_memory_and_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..100 {
        std::fs::write(folder.path().join(format!("s{number}.ply")), binary(number, 10_000)).unwrap();
    }
    let mut system = PresetSystem::default();
    system.particle_files.path = "s#.ply".into();
    let preset = Preset { systems: vec![system], ..Preset::default() };
    let files =
        particle_files::load_particle_files(&preset, "my.json".as_ref(), &AssetFolders::new(folder.path())).unwrap();
    let frames = files[0].as_ref().unwrap();
    assert_eq!((frames.frames().len(), frames.max_particles()), (100, 10_000));
    // At most 64 bytes a particle, as the module's documentation states.
    assert!(frames.bytes() <= 100 * 10_000 * 64, "{} bytes", frames.bytes());
    let mut particles = Vec::new();
    // A time between two frames: x is the number of the frame.
    particle_files::particles(&preset.systems[0], Some(frames), 41.5 / 24.0, &mut particles);
    assert_eq!(particles.len(), 10_000);
    assert!((particles[7].position.x - 41.57).abs() < 1.0e-3, "{}", particles[7].position);
}
