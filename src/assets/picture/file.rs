//! Files that are written whole, or left as they were.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::Error;

/// Writes a file beside its final place and moves it there, so that no reader sees half of it and a failed write leaves the old
/// one, whose permissions it keeps. A link stays one, and what it points to is written.
///
/// A file that has several names, or lies in a folder where nothing can be made, is written where it is; what was in it is
/// put back if that fails.
///
/// # Errors
/// [`Error::Io`] when it cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    put(&followed(path), bytes).map_err(|error| Error::Io { path: path.into(), error })
}

/// Whether [`write_file`] could begin now: for those who have long work to do before. Leaves everything as it is.
///
/// # Errors
/// What the system says where it could not.
pub fn check_file(path: &Path) -> io::Result<()> {
    let target = followed(path);
    match OpenOptions::new().write(true).open(&target) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            partial_beside(&target).and_then(|(partial, _)| fs::remove_file(partial))
        }
        opened => opened.map(drop),
    }
}

/// Tells files apart, by whatever names: equal for two paths that lead to one file, or to one place where a file may be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileIdentity(Identity);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Identity {
    #[cfg(unix)]
    Inode(u64, u64),
    Place(PathBuf),
}

impl FileIdentity {
    /// Looks at what is there now.
    pub fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(found) = fs::metadata(path) {
            use std::os::unix::fs::MetadataExt;
            return Self(Identity::Inode(found.dev(), found.ino()));
        }
        let target = followed(path);
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.into());
        Self(Identity::Place(folder.join(target.file_name().unwrap_or_default())))
    }
}

/// As many links as Linux follows.
const MOST_LINKS: u32 = 40;

/// Where links lead, also when nothing is there yet.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let Ok(target) = fs::read_link(&path) else { break };
        path = path.parent().unwrap_or(Path::new("")).join(target);
    }
    path
}

fn put(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let old = match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        found => Some(found?),
    };
    if old.as_ref().is_some_and(has_other_names) {
        return overwrite(path, bytes);
    }
    let (partial, mut file) = match partial_beside(path) {
        Err(_) if old.is_some() => return overwrite(path, bytes),
        made => made?,
    };
    let write = || {
        file.write_all(bytes)?;
        if let Some(old) = old {
            fs::set_permissions(&partial, old.permissions())?;
        }
        drop(file);
        fs::rename(&partial, path)
    };
    write().inspect_err(|_| {
        let _ = fs::remove_file(&partial);
    })
}

#[cfg(unix)]
fn has_other_names(file: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(file) > 1
}

#[cfg(not(unix))]
fn has_other_names(_: &Metadata) -> bool {
    false
}

/// A new file in the same folder. Its name has nothing of the other's, which may be as long as names can be.
fn partial_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    loop {
        let name = format!(".haze-{}-{}.partial", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let partial = path.with_file_name(name);
        match OpenOptions::new().write(true).create_new(true).open(&partial) {
            // Left by another process, long gone.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            made => return made.map(|file| (partial, file)),
        }
    }
}

fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fn write(file: &mut File, bytes: &[u8]) -> io::Result<()> {
        file.rewind()?;
        file.write_all(bytes)?;
        file.set_len(bytes.len() as u64)
    }
    let before = fs::read(path)?;
    let mut file = OpenOptions::new().write(true).open(path)?;
    write(&mut file, bytes).inspect_err(|_| {
        let _ = write(&mut file, &before);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_told_apart_by_where_they_are() {
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
    fn checking_leaves_everything_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        check_file(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(&path, "old").unwrap();
        check_file(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert!(check_file(&folder.path().join("missing/a.png")).is_err() && check_file(folder.path()).is_err());
    }

    #[test]
    fn names_as_long_as_they_can_be_are_written_again_and_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("{}.png", "n".repeat(251)));
        for text in ["first", "second"] {
            write_file(&path, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_modes_and_other_names_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let read = |name: &str| fs::read_to_string(path(name)).unwrap();
        // A link to a link to nothing yet: what it points to is made.
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
        assert!(write_file(&path("loop.png"), b"").is_err() && check_file(&path("loop.png")).is_err());
    }
}
