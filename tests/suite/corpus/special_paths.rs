//! Paths that lead to no regular file: links, loops, pipes, devices, folders, long names and files of the kernel.

use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::sample::select;

use super::read;

/// Part of a path. Several parts are joined or linked to each other.
#[derive(Clone, Debug)]
enum Target {
    Absolute(&'static str),
    /// File, pipe, folder or loop that the test made.
    Made(&'static str),
    /// Name of this many bytes.
    Long(usize),
    /// A name that a terminal or a message must not take literally.
    Odd(&'static str),
}

const ABSOLUTE: &[&str] = &[
    "/",
    "/dev/null",
    "/dev/zero",
    "/dev/full",
    "/dev/random",
    "/dev/tty",
    "/dev/stdin",
    "/proc/self/mem",
    "/proc/self/maps",
    "/proc/self/environ",
    "/proc/self/fd/0",
    "/proc/self/exe",
    "/proc/kmsg",
    "/proc/cpuinfo",
    "/sys/kernel/notes",
    "/nowhere/file",
];

fn target() -> impl Strategy<Value = Target> {
    prop_oneof![
        4 => select(ABSOLUTE).prop_map(Target::Absolute),
        4 => select(vec!["file", "pipe", "folder", "loop", "loop_of_two", "unreadable"]).prop_map(Target::Made),
        1 => select(vec![1, 255, 256, 4095, 4096, 70_000]).prop_map(Target::Long),
        2 => select(vec!["a\nb", "\x1b[2J", "\u{202e}gnp", "\u{2028}", " ", "..", "~", "-", "--help"]).prop_map(Target::Odd),
    ]
}

/// Makes the files that [`Target::Made`] names.
fn make(folder: &Path) {
    std::fs::write(folder.join("file"), "{}").unwrap();
    std::fs::create_dir(folder.join("folder")).unwrap();
    assert!(Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap().success());
    symlink("loop", folder.join("loop")).unwrap();
    symlink("loop_of_two_back", folder.join("loop_of_two")).unwrap();
    symlink("loop_of_two", folder.join("loop_of_two_back")).unwrap();
    std::fs::write(folder.join("unreadable"), "{}").unwrap();
    std::fs::set_permissions(folder.join("unreadable"), std::os::unix::fs::PermissionsExt::from_mode(0o000)).unwrap();
}

#[test]
fn paths_to_special_files_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    make(folder.path());
    let link = folder.path().join("link");
    let kinds = select(vec!["preset", "ramp", "motif", "sprite", "noise", "png"]);
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |(kind in kinds, target in target(), links in 0_usize..50, inside in any::<bool>())| {
        let mut path = match target {
            Target::Absolute(path) => PathBuf::from(path),
            Target::Made(name) | Target::Odd(name) => folder.path().join(name),
            Target::Long(bytes) => folder.path().join("n".repeat(bytes)),
        };
        // Below a file, as if it were a folder.
        if inside {
            path = path.join("file");
        }
        // Linux follows 40 links.
        for number in 0..links {
            let next = link.with_extension(number.to_string());
            std::fs::remove_file(&next).ok();
            path = if symlink(&path, &next).is_ok() { next } else { path };
        }
        let started = Instant::now();
        if let Err(error) = read(kind, &path) {
            let line = error.to_string();
            prop_assert!(!line.chars().any(char::is_control) && !line.contains('\u{2028}'), "{:?}", line);
            prop_assert!(!line.contains("os error") && !line.contains(" { "), "{}", line);
        }
        prop_assert!(started.elapsed() < Duration::from_secs(5), "{:?}: {:?}", path, started.elapsed());
    });
}
