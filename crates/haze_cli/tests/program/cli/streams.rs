//! Closed and full output streams, and lack of threads and memory: the program never panics.

#![cfg(target_os = "linux")]

use std::fs::{File, read};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use super::{MOTIF, folder, haze, refusal, render, stderr};

const PROGRAM: &str = env!("CARGO_BIN_EXE_haze");

/// A pipe without a reader.
fn closed() -> Stdio {
    std::io::pipe().unwrap().1.into()
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

/// Runs a line of shell, in which `$0` is the program.
fn shell(folder: &Path, line: &str) -> Output {
    Command::new("sh").args(["-c", line, PROGRAM]).current_dir(folder).env("XDG_RUNTIME_DIR", folder).output().unwrap()
}

#[test]
fn a_closed_or_full_stderr_does_not_stop_rendering() {
    let folder = folder();
    for sink in [full, closed] {
        let status = |arguments: &[&str]| {
            let mut command = Command::new(PROGRAM);
            // Without an adapter, the program prints a message and renders on the CPU.
            command.args(arguments).current_dir(folder.path()).env("WGPU_BACKEND", "dx12").stdout(Stdio::null());
            command.stderr(sink()).status().unwrap().code()
        };
        assert_eq!(status(&["render", "--size", "64x36", "-o", "a.png"]), Some(0));
        std::fs::remove_file(folder.path().join("a.png")).unwrap();
        assert_eq!(status(&["render", "--size", "64x36", "-o", "a.jpg"]), Some(2));
        assert_eq!(status(&["render", "--size", "0x0", "-o", "a.png"]), Some(2));
        assert_eq!(status(&["tweak"]), Some(2));
    }
}

#[test]
fn a_full_stdout_gives_one_error_line_and_a_closed_one_none() {
    let folder = folder();
    let run = |sink: Stdio, arguments: &[&str]| {
        Command::new(PROGRAM).args(arguments).current_dir(folder.path()).stdout(sink).stderr(Stdio::piped()).output()
    };
    for name in ["a.motif.json", "b.motif.json"] {
        std::fs::write(folder.path().join(name), MOTIF).unwrap();
    }
    let bake = ["ramp", "bake", "a.motif.json", "b.motif.json"];
    for arguments in [&["--help"][..], &["preset", "list"], &["preset", "check", "column", "fence"], &bake] {
        let output = run(full(), arguments).unwrap();
        assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(1), 1), "{}", stderr(&output));
        let output = run(closed(), arguments).unwrap();
        assert_eq!((output.status.code(), stderr(&output)), (Some(0), String::new()));
    }
}

#[test]
fn without_threads_the_image_is_the_same() {
    let folder = folder();
    assert!(render(folder.path(), &[]).status.success());
    let expected = read(folder.path().join("out.png")).unwrap();
    // No machine has memory for a stack of this size.
    let line = "RUST_MIN_STACK=1000000000000000 exec \"$0\" render --size 64x36 --backend cpu -o out.png";
    let output = shell(folder.path(), line);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(expected, read(folder.path().join("out.png")).unwrap());
}

#[test]
fn an_image_that_does_not_fit_into_memory_is_refused() {
    let folder = folder();
    for backend in ["cpu", "gpu"] {
        let line = format!("ulimit -v 2000000; exec \"$0\" render --size 8192x8192 --backend {backend} -o out.png");
        let output = shell(folder.path(), &line);
        assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(1), 1), "{}", stderr(&output));
        assert!(stderr(&output).starts_with("haze: --size 8192x8192: out of memory"), "{}", stderr(&output));
    }
    assert!(refusal(folder.path(), &["render", "--size", "65536x65536", "-o", "a.png"]).contains("--size"));
}

#[test]
fn without_xdg_runtime_dir_stderr_is_empty() {
    let folder = folder();
    for runtime in [None, Some("here")] {
        let mut command = Command::new(PROGRAM);
        command.args(["render", "--size", "64x36", "-o", "a.png"]).current_dir(folder.path());
        command.env_remove("XDG_RUNTIME_DIR").envs(runtime.map(|folder| ("XDG_RUNTIME_DIR", folder)));
        let output = command.output().unwrap();
        assert!(output.status.success());
        assert_eq!(stderr(&output), "");
    }
    assert_eq!(stderr(&haze(folder.path(), &["info"])), "");
}
