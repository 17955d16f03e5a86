//! Output files: refused before any work, or replaced with their links and permissions kept.

use std::fs;
use std::path::Path;

use super::{MOTIF, folder, haze, refusal, render, size_of, stderr};

const SMALL: [&str; 6] = ["render", "--size", "8x8", "--backend", "cpu", "-o"];
const SHEET: [&str; 6] = ["techniques", "--size", "8x8", "--backend", "cpu", "-o"];

/// Returns the names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = entries.collect();
    names.sort();
    names
}

#[test]
fn unwritable_outputs_are_refused_before_rendering() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("cells/soft.png")).unwrap();
    let line = |command: &[&str], more: &[&str]| refusal(folder.path(), &[command, more].concat());
    assert!(line(&SMALL, &["a.png/"]).contains("a.png/ is not a file"));
    assert!(line(&SMALL, &["a.png/."]).contains("a.png/. is not a file"));
    assert!(line(&SMALL, &["cells/soft.png"]).contains("expected a file, or a name that does not exist yet"));
    assert!(
        line(&SMALL, &[&format!("{}.png", "n".repeat(300))])
            .contains("(the name is too long); expected at most 255 bytes")
    );
    let curves = line(&SHEET, &["a.png", "--curves", "missing/c.png"]);
    assert!(curves.contains("--curves: missing/c.png") && curves.contains("a folder that exists"), "{curves}");
    let cells = line(&SHEET, &["a.png", "--cells", "missing"]);
    assert!(cells.contains("--cells: missing") && cells.contains("a folder that exists"), "{cells}");
    let cells = line(&SHEET, &["a.png", "--cells", "cells"]);
    assert!(cells.contains("soft.png") && cells.contains("a name that does not exist yet"), "{cells}");
    assert_eq!(
        (names(folder.path()), names(&folder.path().join("cells"))),
        (vec!["cells".into()], vec!["soft.png".into()])
    );
}

#[cfg(target_os = "linux")]
#[test]
fn folders_that_allow_no_new_file_are_refused_before_rendering() {
    let folder = folder();
    for path in ["/proc/a.png", "link.png"] {
        std::os::unix::fs::symlink("missing/a.png", folder.path().join("link.png")).ok();
        let line = refusal(folder.path(), &[&SMALL[..], &[path]].concat());
        assert!(line.contains(path) && line.contains("cannot be written (No such file"), "{line}");
    }
}

#[test]
fn inputs_are_not_overwritten() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("shots")).unwrap();
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sprites/wisp.png"), path("shots/mine.png")).unwrap();
    let material = r#"{"sprite": "mine.png", "columns": 4, "rows": 2}"#;
    let text = format!(r#"{{"version": 1, "name": "x", "systems": [{{"name": "s", "material": {material}}}]}}"#);
    fs::write(path("shots/my.json"), &text).unwrap();
    fs::hard_link(path("shots/my.json"), path("preset.png")).unwrap();
    let line = |output: &str| refusal(folder.path(), &[&SMALL[..], &[output, "shots/my.json"]].concat());
    for output in ["shots/mine.png", "shots/../shots/mine.png", "preset.png"] {
        assert!(line(output).contains("is also an input; expected another file"));
    }
    assert_eq!(fs::read_to_string(path("shots/my.json")).unwrap(), text);

    let stops = r##"[{"at": 0, "color": "#000000"}, {"at": 1, "color": "#ff8000"}]"##;
    let ramp = format!(r#"{{"version": 1, "width": 32, "height": 1, "rows": [{{"stops": {stops}}}]}}"#);
    fs::write(path("fire.ramp.json"), &ramp).unwrap();
    fs::hard_link(path("fire.ramp.json"), path("fire.png")).unwrap();
    assert!(
        refusal(folder.path(), &["ramp", "bake", "fire.ramp.json"]).contains("is also an input; expected another file")
    );
    assert_eq!(fs::read_to_string(path("fire.ramp.json")).unwrap(), ramp);
}

#[test]
fn two_outputs_must_not_be_the_same_file() {
    let folder = folder();
    let sheet = |more: &[&str]| refusal(folder.path(), &[&SHEET[..], more].concat());
    assert!(
        sheet(&["a.png", "--curves", "./a.png"])
            .contains("--curves: ./a.png is named for two outputs; expected a different file for each output")
    );
    assert!(sheet(&["hard.png", "--cells", "."]).contains("expected a different file for each output"));
    assert!(
        sheet(&["a.png", "--cells", ".", "--curves", "soft.png"]).contains("expected a different file for each output")
    );

    fs::write(folder.path().join("a.motif.json"), MOTIF).unwrap();
    let twice = refusal(folder.path(), &["ramp", "bake", "a.motif.json", "./a.motif.json"]);
    assert!(twice.contains("a different file for each output"), "{twice}");
    assert_eq!(names(folder.path()), ["a.motif.json"]);
}

#[cfg(unix)]
#[test]
fn replacing_a_file_keeps_its_links_and_permissions() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    // A link to an image that does not exist yet.
    symlink("real.png", path("out.png")).unwrap();
    assert!(render(folder.path(), &[]).status.success());
    assert!(path("out.png").is_symlink() && !path("real.png").is_symlink());
    fs::set_permissions(path("real.png"), fs::Permissions::from_mode(0o604)).unwrap();
    assert!(render(folder.path(), &["--time", "3"]).status.success());
    assert_eq!(fs::metadata(path("real.png")).unwrap().permissions().mode() & 0o777, 0o604);
    fs::hard_link(path("real.png"), path("other.png")).unwrap();
    assert!(haze(folder.path(), &[&SMALL[..], &["out.png"]].concat()).status.success());
    assert_eq!((size_of(&path("real.png")), size_of(&path("other.png"))), ((8, 8), (8, 8)));

    let long = format!("{}.png", "n".repeat(240));
    let output = haze(folder.path(), &[&SMALL[..], &[&long]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(folder.path()).len(), 4);
}

#[cfg(target_os = "linux")]
#[test]
fn a_failed_write_keeps_the_old_file() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("out.png"), "old").unwrap();
    for other_name in [false, true] {
        if other_name {
            fs::hard_link(path("out.png"), path("other.png")).unwrap();
        }
        // A file may be one block long at most.
        let line = "ulimit -f 1; exec \"$0\" render --size 64x36 --backend cpu -o out.png";
        let mut command = std::process::Command::new("sh");
        let output =
            command.args(["-c", line, env!("CARGO_BIN_EXE_haze")]).current_dir(folder.path()).output().unwrap();
        assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(1), 1), "{}", stderr(&output));
        assert!(stderr(&output).starts_with("haze: out.png: "), "{}", stderr(&output));
        assert_eq!(fs::read_to_string(path("out.png")).unwrap(), "old");
        assert_eq!(names(folder.path()).len(), 1 + usize::from(other_name));
    }
}

/// Writes to `FILE`, in a process that a signal ends at the limit of file sizes: the program ignores that signal.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "started by a_program_killed_during_a_write_keeps_the_old_file"]
fn write_new_contents() {
    haze_preset::write_file(Path::new(&std::env::var_os("FILE").unwrap()), &[b'n'; 8192]).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_program_killed_during_a_write_keeps_the_old_file() {
    use std::os::unix::process::ExitStatusExt as _;
    let folder = folder();
    let path = folder.path().join("a.png");
    let write = |blocks: u64| {
        let line = format!("ulimit -c 0; ulimit -f {blocks}; exec \"$0\" --exact \"$1\" --ignored");
        let mut command = std::process::Command::new("sh");
        command.args(["-c", &line]).arg(std::env::current_exe().unwrap()).arg("cli::outputs::write_new_contents");
        command.env("FILE", &path).output().unwrap().status
    };
    fs::write(&path, "old").unwrap();
    for limit in 0..16 {
        assert_eq!(write(limit).signal(), Some(25), "SIGXFSZ at {limit} blocks");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old", "{limit}");
    }
    assert!(write(10_000).success());
    assert_eq!(fs::read_to_string(&path).unwrap(), "n".repeat(8192));
    // Partial files of the killed runs are gone.
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn a_bake_keeps_painted_images_unless_it_is_told_to_replace_them() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let puff = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sprites/puff.sprite.json")).unwrap();
    fs::write(path("a.sprite.json"), puff).unwrap();
    fs::write(path("ball.motif.json"), MOTIF).unwrap();
    for (image, command) in [
        ("ball.png", &["ramp", "bake", "ball.motif.json"][..]),
        ("a.detail.png", &["sprite", "bake", "a.sprite.json"]),
        ("a.six_way.png", &["sprite", "bake", "a.sprite.json", "--six-way"]),
        ("b.png", &["ramp", "fit", "-o", "b.ramp.json"]),
    ] {
        image::RgbImage::new(8, 8).save(path(image)).unwrap();
        let before = fs::read(path(image)).unwrap();
        let line = refusal(folder.path(), command);
        assert!(line.contains(&format!("{image} was painted, or changed after it was baked, and is kept")), "{line}");
        assert!(line.contains("`bake --overwrite`") && fs::read(path(image)).unwrap() == before, "{line}");
        fs::remove_file(path(image)).unwrap();
    }
    fs::write(path("ball.png"), "painted").unwrap();
    for more in [&["--overwrite"][..], &[]] {
        let output = haze(folder.path(), &[&["ramp", "bake", "ball.motif.json"], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(size_of(&path("ball.png")), (8, 8));
    }
}
