//! Errors of the operating system in plain words.

use std::io::{self, ErrorKind};

/// Error code of links that lead back to themselves, which has no stable [`ErrorKind`].
pub const LINK_LOOP: i32 = if cfg!(any(target_os = "linux", target_os = "android")) {
    40
} else if cfg!(windows) {
    1921
} else {
    62
};

const LINKS: (&str, &str) = ("links that lead back to themselves", "a file, or a link to one");

/// Problem, and what would be right, by kind.
const REASONS: [(ErrorKind, &str, &str); 11] = [
    (ErrorKind::NotFound, "No such file or folder", "a path that exists"),
    (ErrorKind::PermissionDenied, "permission denied", "a file that this user may read or write"),
    (ErrorKind::AlreadyExists, "a file of this name exists", "a folder, or a free name"),
    (ErrorKind::IsADirectory, "a folder, not a file", "a file"),
    (ErrorKind::NotADirectory, "a part of the path is a file, not a folder", "folders before the last name"),
    (ErrorKind::InvalidFilename, "the name is too long", "at most 255 bytes for each name of the path"),
    (ErrorKind::WouldBlock, "it has no data to read now", "a file on a disk"),
    (ErrorKind::ReadOnlyFilesystem, "the disk is read-only", "a disk that can be written"),
    (ErrorKind::StorageFull, "the disk is full", "free space on it"),
    (ErrorKind::QuotaExceeded, "the user's share of the disk is full", "free space in it"),
    (ErrorKind::FileTooLarge, "the file would be larger than the system allows", "a higher limit of file sizes"),
];

/// True for links that lead back to themselves.
pub fn is_link_loop(error: &io::Error) -> bool {
    error.raw_os_error() == Some(LINK_LOOP)
}

fn find(error: &io::Error) -> Option<(&'static str, &'static str)> {
    // An error with a text of its own has its reason already.
    if error.get_ref().is_some() {
        return None;
    }
    if is_link_loop(error) {
        return Some(LINKS);
    }
    let found = REASONS.into_iter().find(|(kind, ..)| *kind == error.kind());
    found.map(|(_, problem, expected)| (problem, expected))
}

/// Problem in words, without what would be right and without the number of a system's error: `permission denied`.
pub fn io_problem(error: &io::Error) -> String {
    find(error).map_or_else(|| without_number(error), |(problem, _)| problem.into())
}

/// Valid input in words, if it is known: `a file that this user may read or write`.
pub fn io_expected(error: &io::Error) -> Option<&'static str> {
    find(error).map(|(_, expected)| expected)
}

/// Problem and, if it is known, what would be right: `permission denied; expected a file that this user may read`.
pub fn io_reason(error: &io::Error) -> String {
    find(error).map_or_else(|| without_number(error), |(problem, expected)| format!("{problem}; expected {expected}"))
}

/// Text of the system. The standard library appends ` (os error N)`.
fn without_number(error: &io::Error) -> String {
    let text = error.to_string();
    let number = error.raw_os_error().map(|code| format!(" (os error {code})")).unwrap_or_default();
    text.strip_suffix(&number).unwrap_or(&text).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn errors_of_the_system_are_words_without_numbers() {
        /// Largest error code of Linux.
        const LAST: i32 = 133;
        for code in 1..=LAST {
            let error = io::Error::from_raw_os_error(code);
            for text in [io_problem(&error), io_reason(&error)] {
                assert!(!text.is_empty() && !text.contains("os error"), "{code}: {text}");
            }
        }
        let looped = io::Error::from_raw_os_error(LINK_LOOP);
        assert_eq!(io_reason(&looped), "links that lead back to themselves; expected a file, or a link to one");
    }

    #[test]
    fn an_error_with_a_reason_of_its_own_keeps_it() {
        let own = io::Error::new(ErrorKind::NotFound, "no image; expected one");
        assert_eq!((io_problem(&own), io_reason(&own)), ("no image; expected one".into(), own.to_string()));
        let kind = io::Error::from(ErrorKind::NotFound);
        assert_eq!(io_reason(&kind), "No such file or folder; expected a path that exists");
    }
}
