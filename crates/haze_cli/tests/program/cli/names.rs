//! File names of arbitrary bytes, and commands with many files.

use super::{MOTIF, folder, haze, refusal, stderr};

#[test]
fn every_file_is_checked_and_every_error_reported() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("bad.json", "{");
    let output = haze(folder.path(), &["preset", "check", "bad.json", "column", "none.json"]);
    let text = stderr(&output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(2), 2), "{text}");
    assert!(text.contains("bad.json:1:1") && text.contains("none.json: "), "{text}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "column: good\n");

    write("good.motif.json", MOTIF);
    write("bad.ramp.json", "{");
    let output = haze(folder.path(), &["ramp", "bake", "bad.ramp.json", "good.motif.json", "bad.json"]);
    let text = stderr(&output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(2), 2), "{text}");
    assert!(text.contains("bad.ramp.json:1:1") && text.contains("expected a *.ramp.json"), "{text}");
    assert!(!folder.path().join("good.png").exists(), "one bad recipe stops all from being baked");
    assert!(haze(folder.path(), &["ramp", "bake", "good.motif.json"]).status.success());
}

#[test]
fn control_characters_in_names_are_escaped() {
    let folder = folder();
    let name = "a\u{1b}[31m\nb\u{9b}";
    let escaped = "a\\u{1b}[31m\\nb\\u{9b}";
    let file = format!("{name}.json");
    for arguments in [&["preset", "check", &file][..], &["render", "-o", "a.png", "--size", name], &[name]] {
        let line = refusal(folder.path(), arguments);
        assert!(line.contains(escaped) && !line.trim_end().contains(char::is_control), "{line:?}");
    }
    assert!(refusal(folder.path(), &["render", "-o", "a.png", "--size", name]).contains("1 to 8192"));
    let image = format!("{name}.png");
    let output = haze(folder.path(), &["render", "--size", "8x8", "--backend", "cpu", "-o", &image]);
    let line = String::from_utf8(output.stdout).unwrap();
    assert!(line.starts_with(escaped) && line.lines().count() == 1, "{line:?}");
    assert!(folder.path().join(image).exists());
}

#[test]
fn a_preset_alone_opens_the_tweaker() {
    let folder = folder();
    std::fs::write(folder.path().join("my"), r#"{"version": 1, "name": "x"}"#).unwrap();
    // The tweaker refuses the option before it opens a window.
    for preset in ["column", "my", "none.json"] {
        let line = refusal(folder.path(), &[preset, "--set", "camera.exposure=bright"]);
        let expected = if preset == "none.json" { "none.json: No such file" } else { "--set camera.exposure" };
        assert!(line.contains(expected), "{preset}: {line}");
    }
    let line = refusal(folder.path(), &["colum"]);
    assert!(line.contains("unrecognized subcommand 'colum'"), "{line}");
    // A subcommand takes precedence, and reports its own errors.
    std::fs::write(folder.path().join("render"), "").unwrap();
    assert!(refusal(folder.path(), &["render"]).contains("--output"));
}

#[cfg(target_os = "linux")]
#[test]
fn file_names_may_be_invalid_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::process::Command;
    let folder = folder();
    let run = |arguments: &[&[u8]]| {
        let arguments = arguments.iter().map(|argument| OsStr::from_bytes(argument));
        let output =
            Command::new(env!("CARGO_BIN_EXE_haze")).args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
    };
    let path = |name: &[u8]| folder.path().join(OsStr::from_bytes(name));
    std::fs::write(path(b"\xe9.json"), r#"{"version": 1, "name": "x"}"#).unwrap();
    std::fs::write(path(b"\xe9.motif.json"), MOTIF).unwrap();
    run(&[b"preset", b"check", b"\xe9.json"]);
    run(&[b"render", b"\xe9.json", b"--size", b"8x8", b"--backend", b"cpu", b"-o", b"\xff.png"]);
    run(&[b"ramp", b"bake", b"\xe9.motif.json"]);
    assert!(path(b"\xff.png").exists() && path(b"\xe9.png").exists());
}
