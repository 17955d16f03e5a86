//! Outputs whose names lead to devices, pipes, folders or back to themselves: refused, and left as they are.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::{MOTIF, folder, refusal, stderr};

/// Every file that a command writes, with the command. `ramp watch` and the window have tests of their own.
const WRITERS: [(&str, &str); 29] = [
    ("a.png", "render -o a.png"),
    ("a_0001.png", "render --frames 0..1 -o a_%04d.png"),
    ("a.gif", "render --frames 0..1 -o a.gif"),
    ("a.png", "render --frames 0..1 --sheet 1x2 -o a.png"),
    ("a.png", "sheet --vary camera.exposure=0,1 -o a.png"),
    ("a.png", "debug-views -o a.png"),
    ("a.png", "techniques -o a.png"),
    ("a.png", "techniques -o b.png --curves a.png"),
    ("soft.png", "techniques -o b.png --cells ."),
    ("a.json", "bench limits --json a.json"),
    ("a.csv", "bench limits --csv a.csv"),
    ("a.html", "bench limits --html a.html"),
    ("a.html", "bench page report.json -o a.html"),
    ("a.json", "preset new a"),
    ("a.ramp.json", "ramp new -o a.ramp.json"),
    ("a.png", "ramp new --blank diffuse -o a.png"),
    ("ball.png", "ramp bake --overwrite ball.motif.json"),
    ("a.ramp.json", "ramp import in.png -o a.ramp.json"),
    ("a.png", "ramp fit -o a.ramp.json"),
    ("b.ramp.json", "ramp fit -o a.ramp.json --backlight b.ramp.json"),
    ("a.png", "ramp fit -o b.ramp.json --sheet a.png"),
    ("a.png", "ramp show in.png -o a.png"),
    ("a.png", "ramp sheet -o a.png"),
    ("a.detail.png", "sprite bake --overwrite a.sprite.json"),
    ("puff.six_way.png", "sprite bake --six-way ash puff"),
    ("a.png", "sprite import in.png -o a.png"),
    ("a.heat.png", "sprite read in.png -o a"),
    ("b.png", "sprite export in.png -o a.png b.png"),
    ("a.vol", "sprite light -o a.png --volume a.vol"),
];

/// Timeout. Every command is refused before any work; waiting for a pipe would never end.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Creates targets: a device, a pipe, a folder, and a link to itself.
fn make_targets(folder: &Path) -> [&'static str; 4] {
    let is_done = |program: &str, arguments: &[&str]| {
        Command::new(program).args(arguments).current_dir(folder).stderr(Stdio::null()).status().unwrap().success()
    };
    // Only root may create a device.
    if !is_done("mknod", &["device", "c", "1", "3"]) {
        std::os::unix::fs::symlink("/dev/null", folder.join("device")).unwrap();
    }
    assert!(is_done("mkfifo", &["pipe"]) && is_done("mkdir", &["folder"]) && is_done("ln", &["-s", "loop", "loop"]));
    ["device", "pipe", "folder", "loop"]
}

#[test]
fn every_command_refuses_to_replace_what_is_not_a_file() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let sprite = include_str!("../../../../../sprites/puff.sprite.json");
    for (name, text) in [("ball.motif.json", MOTIF), ("a.sprite.json", sprite)] {
        fs::write(path(name), text).unwrap();
    }
    image::RgbaImage::new(8, 8).save(path("in.png")).unwrap();
    for target in make_targets(folder.path()) {
        let before = fs::symlink_metadata(path(target)).unwrap();
        for (file, command) in WRITERS {
            std::os::unix::fs::symlink(target, path(file)).unwrap();
            let mut child = Command::new(env!("CARGO_BIN_EXE_haze"))
                .args(command.split(' '))
                .current_dir(folder.path())
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let started = Instant::now();
            while child.try_wait().unwrap().is_none() {
                assert!(started.elapsed() < TIMEOUT, "{command}: {target}: {:?}", child.kill());
                std::thread::sleep(Duration::from_millis(5));
            }
            let output = child.wait_with_output().unwrap();
            let text = stderr(&output);
            assert_eq!((output.status.code(), text.lines().count()), (Some(2), 1), "{command}: {target}: {text}");
            assert!(text.contains(file) && text.contains("; expected ") && !text.contains("os error"), "{text}");
            assert!(path(file).is_symlink(), "{command}: {target}");
            fs::remove_file(path(file)).unwrap();
        }
        let after = fs::symlink_metadata(path(target)).unwrap();
        assert_eq!((after.file_type(), after.modified().unwrap()), (before.file_type(), before.modified().unwrap()));
    }
}

#[test]
fn exports_refuse_a_folder_whose_name_something_else_has() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").unwrap();
    std::os::unix::fs::symlink("nothing", folder.path().join("astray")).unwrap();
    let [device, pipe, _, looped] = make_targets(folder.path());
    let flipbook = "export flipbook --engine unity --backend cpu --size 8x8 --frames 0..1 --sheet 1x2 -o";
    for command in ["export material --engine wgsl -o", flipbook] {
        for (output, problem) in [
            ("file", "--output: file is a file, not a folder; expected a folder, or a name that does not exist yet"),
            ("file/book", "file/book: a part of the path is a file, not a folder; expected"),
            ("astray", "--output: astray is a link, not a folder; expected"),
            (device, "--output: device is a device, not a folder; expected"),
            (pipe, "--output: pipe is a pipe, not a folder; expected"),
            (looped, "--output: loop is a link, not a folder; expected"),
        ] {
            let arguments: Vec<_> = command.split(' ').chain([output]).collect();
            let said = refusal(folder.path(), &arguments);
            assert!(said.starts_with(&format!("haze: {problem}")), "{command}: {said}");
        }
    }
}
