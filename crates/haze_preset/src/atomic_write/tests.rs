use super::*;

#[test]
fn missing_files_are_identified_by_their_location() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("in")).unwrap();
    let same = |a: &str, b: &str| FileIdentity::of(&path(a)) == FileIdentity::of(&path(b));
    assert!(same("a.png", "in/../a.png") && same("a.png", "./a.png"));
    assert!(!same("a.png", "b.png") && !same("a.png", "in/a.png"));
    fs::write(path("a.png"), "").unwrap();
    assert!(same("a.png", "in/../a.png") && !same("a.png", "b.png"));
}

#[test]
fn checking_a_file_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    check_writable(&path).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    fs::write(&path, "old").unwrap();
    check_writable(&path).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert!(check_writable(&folder.path().join("missing/a.png")).is_err() && check_writable(folder.path()).is_err());
}

#[test]
fn a_file_name_of_the_maximum_length_can_be_written_repeatedly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{}.png", "n".repeat(251)));
    for text in ["first", "second"] {
        write_file(&path, text.as_bytes()).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn stale_temporary_files_are_removed_and_locked_ones_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in [".haze-1-0.partial", ".haze-1-1.partial", ".haze-1.png", "haze-1-2.partial"] {
        fs::write(path(name), "half").unwrap();
    }
    let written = OpenOptions::new().write(true).open(path(".haze-1-1.partial")).unwrap();
    written.lock().unwrap();
    write_file(&path("a.png"), b"new").unwrap();
    let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, [".haze-1-1.partial", ".haze-1.png", "a.png", "haze-1-2.partial"]);
}

#[cfg(unix)]
#[test]
fn symbolic_links_permissions_and_hard_links_are_preserved() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let read = |name: &str| fs::read_to_string(path(name)).unwrap();
    // A link to a link to a missing file: the missing file is created.
    fs::create_dir(path("in")).unwrap();
    symlink("in/b.png", path("a.png")).unwrap();
    symlink("../c.png", path("in/b.png")).unwrap();
    write_file(&path("a.png"), b"made").unwrap();
    assert!(path("a.png").is_symlink() && path("in/b.png").is_symlink() && !path("c.png").is_symlink());
    assert_eq!(read("c.png"), "made");

    fs::set_permissions(path("c.png"), fs::Permissions::from_mode(0o640)).unwrap();
    write_file(&path("c.png"), b"again").unwrap();
    assert_eq!(fs::metadata(path("c.png")).unwrap().permissions().mode() & 0o777, 0o640);

    fs::hard_link(path("c.png"), path("d.png")).unwrap();
    assert_eq!(FileIdentity::of(&path("a.png")), FileIdentity::of(&path("d.png")));
    write_file(&path("d.png"), b"both").unwrap();
    assert_eq!((read("c.png"), read("d.png")), ("both".into(), "both".into()));

    symlink("loop.png", path("loop.png")).unwrap();
    let error = write_file(&path("loop.png"), b"").unwrap_err().to_string();
    assert!(error.ends_with("links that lead back to themselves; expected a file, or a link to one"), "{error}");
    assert!(check_writable(&path("loop.png")).is_err());
}
/// Creates one thing of each type that is no file, and returns their names.
#[cfg(target_os = "linux")]
fn make_special(folder: &Path) -> [&'static str; 4] {
    let is_done = |program: &str, arguments: &[&str]| {
        std::process::Command::new(program).args(arguments).current_dir(folder).output().unwrap().status.success()
    };
    // Only root may create a device; others cannot replace the one of the system.
    if !is_done("mknod", &["device", "c", "1", "3"]) {
        std::os::unix::fs::symlink("/dev/null", folder.join("device")).unwrap();
    }
    assert!(is_done("mkfifo", &["pipe"]) && is_done("mkdir", &["folder"]));
    std::os::unix::net::UnixListener::bind(folder.join("socket")).unwrap();
    ["device", "pipe", "socket", "folder"]
}

#[cfg(target_os = "linux")]
#[test]
fn only_files_are_replaced() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let names = make_special(folder.path());
    for (index, target) in names.map(path).into_iter().enumerate() {
        let link = path(&format!("link_{index}"));
        symlink(&target, &link).unwrap();
        let before = fs::symlink_metadata(&target).unwrap().file_type();
        for path in [&target, &link] {
            let error = write_file(path, b"new").unwrap_err().to_string();
            assert!(error.contains(", not a file; expected a file, or a name"), "{error}");
            assert_eq!(error.contains("a link to "), path.is_symlink(), "{error}");
            assert!(check_writable(path).is_err() && write_state_file(path, b"new").is_err());
        }
        assert_eq!(fs::symlink_metadata(&target).unwrap().file_type(), before);
    }
    let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(names.filter(|name| name.to_string_lossy().ends_with(PARTIAL.1)).count(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_with_the_name_of_a_temporary_file_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join(".haze-1-0.partial");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    write_file(&folder.path().join("a.png"), b"new").unwrap();
    assert!(pipe.exists());
}

#[cfg(unix)]
#[test]
fn state_files_are_not_written_through_links() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let read = |name: &str| fs::read_to_string(path(name)).unwrap();
    fs::write(path("other"), "other").unwrap();
    std::os::unix::fs::symlink("other", path("soft")).unwrap();
    let error = write_state_file(&path("soft"), b"new").unwrap_err().to_string();
    assert!(error.contains("soft: a link, not a file; expected a file"), "{error}");
    fs::hard_link(path("other"), path("hard")).unwrap();
    write_state_file(&path("hard"), b"new").unwrap();
    assert_eq!((read("other"), read("hard"), read("soft")), ("other".into(), "new".into(), "other".into()));
}

/// Runs only as root, who alone can give files away.
#[cfg(target_os = "linux")]
#[test]
fn a_replaced_file_keeps_its_owner() {
    use std::os::unix::fs::{MetadataExt, chown};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::write(&path, "old").unwrap();
    if chown(&path, Some(65534), Some(65534)).is_err() {
        return;
    }
    write_file(&path, b"new").unwrap();
    let found = fs::metadata(&path).unwrap();
    assert_eq!((found.uid(), found.gid(), fs::read(&path).unwrap()), (65534, 65534, b"new".to_vec()));
}
