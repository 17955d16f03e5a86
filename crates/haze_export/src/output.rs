//! Output of the program: lines on standard output and error, and the files it writes.

use std::fmt::{Arguments, Display};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use haze::FieldError;
use haze_core::assets::file_type;
use haze_core::error::{AssetError, Error, alters_line, io_expected, io_problem};
use haze_preset::{FileIdentity, check_writable};

use super::recipe_files::has_extension;

/// `println!` of one line that returns an error instead of panicking.
#[macro_export]
macro_rules! print_line {
    ($($argument:tt)*) => { $crate::output::write_line(format_args!($($argument)*)) };
}
pub use print_line;

/// Writes one line to standard output; control characters are escaped.
///
/// # Errors
/// [`AssetError::Io`] if standard output cannot be written; a closed pipe is none.
pub fn write_line(line: Arguments<'_>) -> Result<(), Error> {
    write_text(one_line(line))
}

/// Writes text of the program's own, with any number of lines, to standard output.
pub fn write_text(text: impl Display) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        // The reader has closed the pipe, as in `haze preset schema | head`.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| Error::from(AssetError::Io { path: "standard output".into(), error })),
    }
}

/// Writes one line to standard error; a failure is ignored, because it cannot be reported.
pub fn print_error(line: impl Display) {
    let _ = writeln!(std::io::stderr().lock(), "haze: {}", one_line(line));
}

/// Escapes control characters, which may come from file names.
pub fn one_line(text: impl Display) -> String {
    let escape = |c: char| if alters_line(c) { c.escape_default().collect() } else { String::from(c) };
    text.to_string().chars().map(escape).collect()
}

/// Errors of the files that a command was given; empty if they have been reported already.
#[derive(Default)]
pub struct Failures(Vec<Error>);

impl From<Error> for Failures {
    fn from(error: Error) -> Self {
        Self(vec![error])
    }
}

impl Failures {
    /// Failures of several files.
    pub fn new(errors: Vec<Error>) -> Self {
        Self(errors)
    }

    /// Applies `work` to every item, even if others fail; returns the results and the errors.
    pub fn of_each<T, U>(
        items: impl IntoIterator<Item = T>,
        work: impl FnMut(T) -> Result<U, Error>,
    ) -> (Vec<U>, Self) {
        let mut done = Vec::new();
        let mut failures = Vec::new();
        for result in items.into_iter().map(work) {
            match result {
                Ok(value) => done.push(value),
                Err(error) => failures.push(error),
            }
        }
        (done, Self(failures))
    }

    /// `Ok` without failures.
    ///
    /// # Errors
    /// The failures.
    pub fn into_result(self) -> Result<(), Self> {
        if self.0.is_empty() { Ok(()) } else { Err(self) }
    }

    /// The errors that are still to be reported.
    pub fn errors(&self) -> &[Error] {
        &self.0
    }
}

/// Refuses a folder that cannot be made, because something else has its name.
///
/// # Errors
/// [`Error::Field`] with the option that names it.
pub fn check_folder(option: &str, path: &Path) -> Result<(), Error> {
    // `symlink_metadata`: a link to nothing is in the way too.
    let Ok(found) = std::fs::metadata(path).or_else(|_| path.symlink_metadata()) else { return Ok(()) };
    if found.is_dir() {
        return Ok(());
    }
    let problem = format!("{} is {}, not a folder", path.display(), file_type::name(&found));
    Err(FieldError::from_problem(option, problem, "a folder, or a name that does not exist yet").into())
}

/// Folder that a command writes into. Folders that were made for it are removed at the end if nothing is in them.
pub struct OutputFolder {
    /// From the innermost.
    made: Vec<PathBuf>,
}

impl OutputFolder {
    /// Makes a folder, and those above it, where they do not exist.
    ///
    /// # Errors
    /// As [`check_folder`]; [`AssetError::Io`] if it cannot be made.
    pub fn make(option: &str, folder: &Path) -> Result<Self, Error> {
        check_folder(option, folder)?;
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = folder.ancestors().take_while(is_missing).map(PathBuf::from).collect();
        // Dropped, and so removed, if only a part of it can be made.
        let made = Self { made };
        std::fs::create_dir_all(folder).map_err(|error| Error::from(AssetError::Io { path: folder.into(), error }))?;
        Ok(made)
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        for folder in &self.made {
            // Fails if something is in it.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Files that a command reads and writes.
pub struct FileChecks {
    inputs: Vec<FileIdentity>,
    outputs: Vec<FileIdentity>,
}

impl FileChecks {
    /// Starts with the files that a command reads; it refuses to write them.
    pub fn for_inputs<P: AsRef<Path>>(inputs: impl IntoIterator<Item = P>) -> Self {
        let inputs = inputs.into_iter().map(|path| FileIdentity::of(path.as_ref())).collect();
        Self { inputs, outputs: Vec::new() }
    }

    /// Refuses a file that cannot be written, before any work is done and any file is replaced. Its name must end in
    /// `extension`.
    pub fn check_output(&mut self, option: &str, path: &Path, extension: &str) -> Result<(), Error> {
        let refuse = |problem: &str, expected: &str| {
            let problem = format!("{} {problem}", path.display());
            Err(FieldError::from_problem(option, problem, expected).into())
        };
        if !has_extension(path, extension) {
            return refuse("is not valid", &format!("a name that ends in .{extension}"));
        }
        if !path.parent().is_none_or(|folder| folder.as_os_str().is_empty() || folder.is_dir()) {
            return refuse("is in a folder that does not exist", "a file in a folder that exists");
        }
        // `a.png/` and `a.png/.` have the file name `a.png`, but mean a folder.
        let name = path.file_name().unwrap_or_default().as_encoded_bytes();
        let found = std::fs::metadata(path);
        let expected = "a file, or a name that does not exist yet";
        if !path.as_os_str().as_encoded_bytes().ends_with(name) {
            return refuse("is not a file", expected);
        }
        if let Some(found) = found.as_ref().ok().filter(|found| !found.is_file()) {
            return refuse(&format!("is {}, not a file", file_type::name(found)), expected);
        }
        if found.is_ok_and(|found| found.permissions().readonly()) {
            return refuse("is read-only", "a file with write permission");
        }
        if let Err(error) = check_writable(path) {
            let problem = format!("cannot be written ({})", io_problem(&error));
            return refuse(&problem, io_expected(&error).unwrap_or("a file that can be written"));
        }
        let identity = FileIdentity::of(path);
        if self.inputs.contains(&identity) {
            return refuse("is also an input", "another file");
        }
        if self.outputs.contains(&identity) {
            return refuse("is named for two outputs", "a different file for each output");
        }
        self.outputs.push(identity);
        Ok(())
    }
}
