//! Limits of the process: file sizes, address space, threads. Each run has a time limit.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

use super::{folder, stderr};

const RENDER: [&str; 5] = ["render", "--size", "64x36", "-o", "a.png"];

/// Runs `haze` behind `limits`, a command that starts another one; for a minute at most.
fn limited(folder: &Path, limits: &[&str], arguments: &[&str]) -> Output {
    let mut command = Command::new("timeout");
    command.args(["--signal=KILL", "60"]).args(limits).arg(env!("CARGO_BIN_EXE_haze")).args(arguments);
    command.current_dir(folder).env("XDG_RUNTIME_DIR", folder).output().unwrap()
}

fn assert_one_line(output: &Output, code: i32, part: &str) {
    let text = stderr(output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(code), 1), "{text}");
    assert!(text.contains(part), "{text}");
}

#[test]
fn a_file_longer_than_the_limit_is_an_error_and_leaves_nothing() {
    let folder = folder();
    let gif = ["render", "--size", "64x36", "--backend", "cpu", "--frames", "0..3", "-o", "a.gif"];
    for arguments in [&[&RENDER[..], &["--backend", "cpu"]].concat(), &gif[..]] {
        let output = limited(folder.path(), &["prlimit", "--core=0", "--fsize=100"], arguments);
        assert_one_line(&output, 1, "the file would be larger than the system allows");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn too_little_address_space_for_a_driver_is_refused_or_left_to_the_cpu() {
    let folder = folder();
    for mebibytes in [300, 600, 900, 1200] {
        let limit = format!("--as={}", mebibytes << 20);
        let run = |backend| {
            let arguments = [&RENDER[..], &["--backend", backend]].concat();
            limited(folder.path(), &["prlimit", "--core=0", &limit], &arguments)
        };
        let expected = format!("the address space is limited to {mebibytes} MiB (`ulimit -v`), too little");
        assert_one_line(&run("gpu"), 2, &expected);
        assert_one_line(&run("auto"), 0, &format!("haze: rendering on the CPU: {expected}"));
    }
}

#[test]
fn an_adapter_that_cannot_start_its_threads_is_left_after_a_time() {
    let folder = folder();
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o777)).unwrap();
    // The limit counts all threads of a user: it needs one without others, which only root can choose.
    let user = ["setpriv", "--reuid=64321", "--clear-groups", "prlimit", "--nproc=2"];
    if !limited(folder.path(), &user, &["--version"]).status.success() {
        eprintln!("skipped: this process cannot become another user that reads the program");
        return;
    }
    let run = |backend| limited(folder.path(), &user, &[&RENDER[..], &["--backend", backend]].concat());
    let expected = "has not finished its work after 20 s; a software adapter needs a thread for each processor";
    assert_one_line(&run("gpu"), 1, expected);
    assert_one_line(&run("auto"), 0, expected);
}
