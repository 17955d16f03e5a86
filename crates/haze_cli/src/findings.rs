//! Reports the findings of checks, file by file.

use std::path::{Path, PathBuf};

use haze_author::finding::Finding;
use haze_core::error::Error;

use haze_export::output::{Failures, print_line};

/// Checks and reports every file, even if others fail. Findings other than warnings make it fail without an error, because
/// they are reported already.
pub fn report_findings(files: &[PathBuf], find: impl Fn(&Path) -> Result<Vec<Finding>, Error>) -> Result<(), Failures> {
    let (checked, failures) = Failures::of_each(files, |path| Ok((path, find(path)?)));
    let mut is_good = true;
    for (path, findings) in checked {
        if findings.is_empty() {
            print_line!("{}: good", path.display())?;
        }
        for Finding { name, description, is_warning } in findings {
            is_good &= is_warning;
            let kind = if is_warning { "warning: " } else { "" };
            print_line!("{}: {kind}{name}: {description}", path.display())?;
        }
    }
    failures.into_result()?;
    if is_good { Ok(()) } else { Err(Failures::default()) }
}
