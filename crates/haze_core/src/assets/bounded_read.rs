//! Bounded reading of user files: type and length are checked before the contents are read.

use std::fs::Metadata;
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;

use crate::assets::file_type::{self, nonblocking};
use crate::error::{AssetError, io_problem, one_line};

/// Reads a file of at most `max_bytes` bytes. Pipes, devices and folders are refused. `kind` names the expected file
/// type in errors.
///
/// # Errors
/// [`AssetError::Io`], which names what was found and what is expected.
pub fn read(path: &Path, kind: &str, max_bytes: u64) -> Result<Vec<u8>, AssetError> {
    let io = |error| AssetError::Io { path: path.into(), error };
    let refuse = |found: String| {
        let reason = format!("{found}; expected a {kind} of at most {max_bytes} bytes ({} MiB)", max_bytes >> 20);
        io(io::Error::new(ErrorKind::InvalidData, reason))
    };
    let check = |found: &Metadata| match found {
        found if !found.is_file() => Err(refuse(format!("{}, not a file", file_type::name(found)))),
        found if found.len() > max_bytes => Err(refuse(format!("{} bytes", found.len()))),
        _ => Ok(()),
    };
    // Checked by path first, and again on the open file in case the path was replaced in between.
    let found = std::fs::metadata(path).map_err(|error| match std::fs::read_link(path) {
        Ok(target) if error.kind() == ErrorKind::NotFound => {
            let reason = format!("a link to {}, which is not there; expected a {kind}", one_line(target.display()));
            io(io::Error::new(ErrorKind::NotFound, reason))
        }
        _ => io(error),
    });
    check(&found?)?;
    let file = nonblocking().read(true).open(path).map_err(io)?;
    check(&file.metadata().map_err(io)?)?;
    let mut bytes = Vec::new();
    // Some files of /proc are files to the system, but cannot be read like one.
    let read = file.take(max_bytes + 1).read_to_end(&mut bytes);
    read.map_err(|error| refuse(format!("cannot be read: {}", io_problem(&error))))?;
    // The file may have grown since the check, or report no length.
    if bytes.len() as u64 > max_bytes {
        return Err(refuse(format!("more than {max_bytes} bytes")));
    }
    Ok(bytes)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn opening_a_pipe_in_place_of_a_file_does_not_block() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let (opened, wait) = std::sync::mpsc::channel();
        let pipe = path.clone();
        std::thread::spawn(move || {
            let file = nonblocking().read(true).open(&pipe);
            opened.send(file.map(|file| file.metadata().unwrap().is_file()))
        });
        let is_file = wait.recv_timeout(std::time::Duration::from_secs(10)).unwrap();
        assert!(!is_file.unwrap());
        assert!(read(&path, "PNG image", 1).unwrap_err().to_string().contains("a pipe, not a file"));
    }
}
