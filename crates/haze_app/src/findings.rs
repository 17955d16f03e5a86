//! What checks found, file by file.

use std::path::{Path, PathBuf};

use haze::Error;
use haze_author::finding::Finding;

use super::output::{Failures, say};

/// Says what there is about every file, whatever becomes of the others. Findings are failures that have been told.
pub fn tell(files: &[PathBuf], find: impl Fn(&Path) -> Result<Vec<Finding>, Error>) -> Result<(), Failures> {
    let (checked, failures) = Failures::of_each(files, |path| Ok((path, find(path)?)));
    let mut is_good = true;
    for (path, findings) in checked {
        if findings.is_empty() {
            say!("{}: good", path.display())?;
        }
        for Finding { name, what } in findings {
            is_good = false;
            say!("{}: {name}: {what}", path.display())?;
        }
    }
    failures.into_result()?;
    if is_good { Ok(()) } else { Err(Failures::default()) }
}
