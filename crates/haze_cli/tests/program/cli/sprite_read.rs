//! `haze sprite read`: sheets of other tools.

use std::fs;
use std::path::Path;

use image::{Rgba, RgbaImage};
use tempfile::TempDir;

use super::{folder, haze, refusal, stderr};

/// Side of a frame. The sheet has 4x2 frames.
const SIDE: u32 = 32;

/// A ball that rolls to the right; its normal and amount at a texel.
fn ball(x: u32, y: u32) -> ([f32; 3], f32) {
    let frame = (y / SIDE * 4 + x / SIDE) as f32;
    let [x, y] = [(x % SIDE) as f32 - 12.0 - frame, (y % SIDE) as f32 - 15.5].map(|offset| offset / 9.0);
    let square = x * x + y * y;
    ([x, -y, (1.0 - square).max(0.0).sqrt()], (1.0 - square).clamp(0.0, 0.9))
}

fn sheet(texel: impl Fn([f32; 3], f32) -> [f32; 4]) -> RgbaImage {
    RgbaImage::from_fn(4 * SIDE, 2 * SIDE, |x, y| {
        let (normal, amount) = ball(x, y);
        Rgba(texel(normal, amount).map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
    })
}

/// Light from a side, white where the sheet is clear.
fn light(normal: [f32; 3], amount: f32, axis: usize, sign: f32) -> f32 {
    if amount > 0.0 { 0.3 + 0.28 * sign * normal[axis] } else { 1.0 }
}

/// Writes a set as some tools do: two maps without alpha, and the opacity, motion and fire as files of their own.
fn separate_files() -> TempDir {
    let folder = folder();
    let save = |name: &str, image: RgbaImage| image.save(folder.path().join(name)).unwrap();
    save("smoke_tlr.png", sheet(|n, a| [light(n, a, 1, 1.0), light(n, a, 0, -1.0), light(n, a, 0, 1.0), 1.0]));
    save("smoke_bbf.png", sheet(|n, a| [light(n, a, 1, -1.0), light(n, a, 2, -1.0), light(n, a, 2, 1.0), 1.0]));
    save("smoke_opacity.png", sheet(|_, a| [a, a, a, 1.0]));
    // A texel to the right in each frame, of full red to the left.
    let way = 0.5 - 0.5 * (1.0 / SIDE as f32) / 0.0625;
    save("smoke_motion.png", sheet(|_, a| if a > 0.0 { [way, 0.5, 0.0, 1.0] } else { [0.5, 0.5, 0.0, 1.0] }));
    save(
        "smoke_emission.png",
        sheet(|n, a| if n[2] > 0.5 { [a, 0.5 * a, 0.1 * a, 1.0] } else { [0.0, 0.0, 0.0, 1.0] }),
    );
    folder
}

const FILES: [&str; 5] =
    ["smoke_tlr.png", "smoke_bbf.png", "smoke_opacity.png", "smoke_motion.png", "smoke_emission.png"];

fn stdout_of(folder: &Path, arguments: &[&str]) -> String {
    let output = haze(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn separate_files_become_a_sprite_with_motion_and_heat() {
    let folder = separate_files();
    let text = stdout_of(folder.path(), &[&["sprite", "read", "-o", "smoke"], &FILES[..]].concat());
    for expected in [
        "smoke.png: 128x64\nsmoke.detail.png: 32x16\nsmoke.six_way.png: 128x128\nsmoke.heat.png: 128x64\n",
        "  8 frames of 32x32, 4 columns and 2 rows\n",
        "  smoke_opacity.png: opacity, 90 % sure; --role overrides it\n",
        "  grid: 4x2, ",
        "  sides: top, left, right, bottom, back, front, ",
        "  light: straight, ",
        "  motion, full red and green: left, ",
        "  mended: normals from the light maps\n",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let read = |name: &str| image::open(folder.path().join(name)).unwrap().to_rgba8();
    // The middle of the first frame: opaque, facing the viewer, moving to the right, hot.
    let [r, g, b, a] = read("smoke.png").get_pixel(12, 16).0;
    assert!(r.abs_diff(128) < 12 && g.abs_diff(128) < 12 && b > 240 && a > 220, "{:?}", [r, g, b, a]);
    let [_, right, down, _] = read("smoke.detail.png").get_pixel(3, 4).0;
    // A thirty-second of a side of an eighth, in 127 steps.
    assert!(right.abs_diff(128 + 32) < 6 && down.abs_diff(128) < 3, "{right} {down}");
    assert!(read("smoke.heat.png").get_pixel(12, 16).0[0] > 60);
    let checked = haze(folder.path(), &["sprite", "check", "--columns", "4", "--rows", "2", "smoke.png"]);
    let findings = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(!findings.contains("opaque") && !findings.contains("border"), "{findings}");
    // Files that were written are replaced; a painted one is kept.
    let again =
        [&["sprite", "read", "-o", "smoke.png", "--sides", "top,right,left,bottom,back,front"], &FILES[..]].concat();
    let text = stdout_of(folder.path(), &again);
    assert!(text.contains("  sides: top, right, left, bottom, back, front, as --sides says\n"), "{text}");
    RgbaImage::new(4, 4).save(folder.path().join("smoke.heat.png")).unwrap();
    let before = fs::read(folder.path().join("smoke.png")).unwrap();
    let text = refusal(folder.path(), &[&["sprite", "read", "-o", "smoke"], &FILES[..]].concat());
    assert!(text.contains("smoke.heat.png was painted, or changed after it was baked, and is kept"), "{text}");
    assert_eq!(fs::read(folder.path().join("smoke.png")).unwrap(), before);
}

#[test]
fn what_is_not_read_is_said() {
    let folder = separate_files();
    let save = |name: &str, image: RgbaImage| image.save(folder.path().join(name)).unwrap();
    save("smoke_color.png", sheet(|n, a| [0.9, 0.3 + 0.2 * n[0], 0.1, a]));
    save("smoke_heat.png", sheet(|n, a| [0.5 * n[2] * a, 0.5 * n[2] * a, 0.5 * n[2] * a, 1.0]));
    let read = |files: &[&str]| {
        let text = stdout_of(folder.path(), &[&["sprite", "read", "-o", "out"], files].concat());
        text.lines().filter_map(|line| line.strip_prefix("  not read: ").map(str::to_owned)).collect::<Vec<_>>()
    };
    assert_eq!(read(&["smoke_opacity.png", "smoke_color.png"]), ["smoke_color.png"]);
    assert_eq!(read(&["smoke_color.png"]), ["smoke_color.png, red, green and blue"]);
    assert_eq!(read(&["smoke_opacity.png", "smoke_heat.png", "smoke_emission.png"]), ["smoke_emission.png"]);
    assert!(read(&FILES).is_empty());
}

#[test]
fn sheets_that_make_no_sprite_are_refused_and_nothing_is_written() {
    let folder = separate_files();
    let motion = image::open(folder.path().join("smoke_motion.png")).unwrap();
    motion.crop_imm(0, 0, 96, 64).save(folder.path().join("narrow_motion.png")).unwrap();
    RgbaImage::from_pixel(64, 64, Rgba([0, 0, 0, 255])).save(folder.path().join("clear_alpha.png")).unwrap();
    for (arguments, expected) in [
        (
            &["smoke_tlr.png", "smoke_bbf.png"][..],
            "smoke_tlr.png: no opacity: alpha is the same everywhere, and no file is",
        ),
        (
            &["smoke_tlr.png", "smoke_opacity.png"],
            "smoke_tlr.png: 1 light maps; expected two light maps of three sides each",
        ),
        (
            &["smoke_opacity.png", "narrow_motion.png"],
            "narrow_motion.png: 96x64 pixels; expected the shape of smoke_opacity",
        ),
        (
            &["smoke_opacity.png", "--grid", "5x2"],
            "do not divide into 5x2 frames, as --grid says; expected files of one grid",
        ),
        (&["smoke_opacity.png", "--grid", "0x2"], "\"0x2\" is no grid; expected CxR"),
        (&["smoke_opacity.png", "--frames", "9", "--grid", "4x2"], "9 frames, as --frames says; expected 1 to 8"),
        (
            &["smoke_opacity.png", "--sides", "right,left"],
            "\"right,left\" is no order; expected each of right,left,top",
        ),
        (&["smoke_opacity.png", "--motion", "up,down"], "\"up,down\" are no directions; expected those of full red"),
        (
            &["smoke_opacity.png", "--y-down"],
            "--y-down: has no effect: no file has normals; expected such files, or no",
        ),
        (&["smoke_opacity.png", "--role", "smoke=a.png"], "\"smoke=a.png\" is no role of a file; expected ROLE=FILE"),
        (&["clear_alpha.png"], "clear_alpha.png: clear everywhere; expected smoke"),
        (&["missing.png"], "missing.png: "),
    ] {
        let text = refusal(folder.path(), &[&["sprite", "read", "-o", "out"], arguments].concat());
        assert!(text.contains(expected), "{expected}: {text}");
        for name in ["out.png", "out.detail.png", "out.six_way.png", "out.heat.png"] {
            assert!(!folder.path().join(name).exists(), "{name}");
        }
    }
}
