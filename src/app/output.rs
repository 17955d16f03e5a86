//! What the program writes: lines on standard output, and pictures.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::path::Path;

use haze::{Error, FieldError};

/// `println!` whose failure is an error, not a panic.
macro_rules! say {
    ($($argument:tt)*) => { $crate::app::output::write_line(format_args!($($argument)*)) };
}
pub(crate) use say;

pub fn write_line(line: Arguments<'_>) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        // Whoever reads has enough: `haze preset schema | head`.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| Error::Io { path: "standard output".into(), error }),
    }
}

/// Refuses a file that a picture cannot be written to, before any work is done and anything is replaced.
pub fn check_target(path: &Path) -> Result<(), Error> {
    let refuse = |expected: &str| Err(FieldError::new("output", path.display(), expected).into());
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return refuse("a name that ends in .png");
    }
    if !path.parent().is_none_or(is_folder) {
        return refuse("a file in a folder that exists");
    }
    match std::fs::metadata(path) {
        Ok(found) if !found.is_file() => refuse("a file, or a name that is free"),
        Ok(found) if found.permissions().readonly() => refuse("a file that may be written"),
        _ => Ok(()),
    }
}

/// Refuses a folder that is not there.
pub fn check_folder(folder: &Path) -> Result<(), Error> {
    if is_folder(folder) {
        return Ok(());
    }
    Err(FieldError::new("output", folder.display(), "a folder that exists").into())
}

fn is_folder(path: &Path) -> bool {
    path.as_os_str().is_empty() || path.is_dir()
}
