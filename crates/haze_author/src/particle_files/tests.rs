//! Tests of loading files and sequences, and of interpolation between frames.

use std::path::Path;

use super::*;

const LIMITS: Limits = Limits { particles: 1 << 20, bytes: 1 << 30 };

fn frame(text: &str) -> ParticleFrame {
    parse(Path::new("a.csv"), text.as_bytes(), 100).unwrap()
}

fn interpolate(first: &str, second: &str, fraction: f32) -> Vec<(i64, f32, f32)> {
    let mut found = Vec::new();
    frame(first).interpolate(Some(&frame(second)), fraction, |particle, weight| {
        found.push((particle.id, particle.position.x, weight));
    });
    found
}

#[test]
fn particles_in_both_frames_are_interpolated_and_others_fade() {
    let first = "id,x,y,z\n5,1,0,0\n2,0,0,0\n3,4,0,0";
    let second = "id,x,y,z\n3,8,0,0\n9,7,0,0\n5,2,0,0\n";
    assert_eq!(interpolate(first, second, 0.25), [(2, 0.0, 0.75), (3, 5.0, 1.0), (5, 1.25, 1.0), (9, 7.0, 0.25)]);
    assert_eq!(interpolate(first, second, 0.0), [(2, 0.0, 1.0), (3, 4.0, 1.0), (5, 1.0, 1.0)]);
    // If one frame has no ids, the result is the earlier frame.
    assert_eq!(interpolate("x,y,z\n1,0,0", second, 0.75), [(0, 1.0, 1.0)]);
    assert_eq!(interpolate("id,x,y,z\n4,1,0,0", "x,y,z\n2,0,0", 0.75), [(4, 1.0, 1.0)]);
}

#[test]
fn rotation_is_interpolated_by_the_smaller_angle() {
    let mut turned = Vec::new();
    let [first, second] = ["6.2", "0.1"].map(|angle| frame(&format!("id,x,y,z,rotation,age\n0,0,0,0,{angle},0.5")));
    first.interpolate(Some(&second), 0.5, |particle, _| turned.push(particle.rotation));
    let wanted = 6.2 + 0.5 * (0.1 + std::f32::consts::TAU - 6.2);
    assert!((turned[0] - wanted).abs() < 1e-5, "{turned:?}");
}

#[test]
fn frames_are_placed_in_time_by_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for (number, count) in [(7, 1), (8, 2), (12, 3)] {
        let text = "x,y,z\n".to_owned() + &"0,0,0\n".repeat(count);
        std::fs::write(folder.path().join(format!("s_{number:03}.csv")), text).unwrap();
    }
    let frames = ParticleFrames::load(&folder.path().join("s_###.csv"), LIMITS).unwrap();
    assert_eq!((frames.frame_count(), frames.max_particles(), frames.bytes()), (6, 3, 6 * 64));
    let at = |frame| {
        frames.frames_around(frame).map(|found| (found.before.particles().len(), found.after.is_some(), found.fraction))
    };
    assert_eq!(at(-0.1), None);
    assert_eq!(at(0.0), Some((1, true, 0.0)));
    assert_eq!(at(2.0), Some((2, true, 0.25)));
    assert_eq!(at(5.0), Some((3, false, 0.0)));
    assert_eq!(at(1e9), Some((3, false, 0.0)));
    assert!(frames.shares_memory(&frames.clone()));
    let few = |particles, bytes| {
        ParticleFrames::load(&folder.path().join("s_###.csv"), Limits { particles, bytes }).unwrap_err()
    };
    assert!(
        few(2, 1 << 30).to_string().ends_with("s_012.csv:4:1: more than 2 particles in a frame; expected at most 2")
    );
    assert!(
        few(9, 100).to_string().ends_with("s_008.csv: 1 MiB of particles up to this frame; expected at most 1 MiB")
    );
    std::fs::write(folder.path().join("s_009.csv"), "x,y\n").unwrap();
    let error = ParticleFrames::load(&folder.path().join("s_###.csv"), LIMITS).unwrap_err().to_string();
    assert!(error.contains("s_009.csv:1:1: no column for the z position"), "{error}");
}

#[test]
fn a_truncated_csv_is_refused_or_has_fewer_particles() {
    let text = "# of two\r\nid;\"P[x]\";P[y];P[z];pscale\r\n1;2;3;4;5\r\n-7;1e3;.5;6.;0\r\n";
    for length in 0..text.len() {
        for byte in [None, Some(0xff), Some(b'"'), Some(b';'), Some(b'\n')] {
            let mut bytes = text.as_bytes()[..length].to_vec();
            bytes.extend(byte);
            if let Ok(frame) = parse(Path::new("a.csv"), &bytes, 2) {
                assert!(frame.particles().len() <= 2);
            }
        }
    }
}
