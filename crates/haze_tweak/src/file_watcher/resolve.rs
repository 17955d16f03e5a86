//! Resolves a path link by link.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// As many links as Linux follows.
const MAX_LINKS: u32 = 40;

/// Returns every location that decides where a path leads, from the root on: the folders and links on the way and the file
/// itself, each named without links before it. The list ends at the first location that does not exist, which is the one
/// to wait for.
pub fn locations(path: &Path) -> Vec<PathBuf> {
    let steps =
        |path: &Path| path.components().rev().map(|part| part.as_os_str().to_owned()).collect::<Vec<OsString>>();
    let mut locations = Vec::new();
    let mut links = 0;
    let mut at = PathBuf::new();
    let mut to_go = std::path::absolute(path).map(|path| steps(&path)).unwrap_or_default();
    while let Some(step) = to_go.pop() {
        if step == ".." {
            at.pop();
            continue;
        }
        // A root replaces everything before it.
        let location = at.join(&step);
        if location.parent().is_none() || step == "." {
            at = location;
            continue;
        }
        locations.push(location.clone());
        match fs::read_link(&location) {
            Ok(target) if links < MAX_LINKS => {
                links += 1;
                to_go.extend(steps(&target));
            }
            Err(_) if fs::symlink_metadata(&location).is_ok() => at = location,
            _ => break,
        }
    }
    locations
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn places_include_links_and_end_at_the_first_missing_one() {
        let folder = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(folder.path()).unwrap();
        let ways = |name: &str| -> Vec<String> {
            let locations = locations(&root.join(name)).into_iter();
            locations.filter_map(|location| Some(location.strip_prefix(&root).ok()?.to_str()?.to_owned())).collect()
        };
        fs::create_dir_all(root.join("v1/in")).unwrap();
        fs::write(root.join("v1/in/a"), "").unwrap();
        assert_eq!(ways("v1/in/a"), ["", "v1", "v1/in", "v1/in/a"]);
        assert_eq!(ways("v1/none/a"), ["", "v1", "v1/none"]);
        symlink("v1", root.join("now")).unwrap();
        symlink("now/in/a", root.join("a")).unwrap();
        symlink(root.join("v1/in/../in/a"), root.join("whole")).unwrap();
        assert_eq!(ways("a"), ["", "a", "now", "v1", "v1/in", "v1/in/a"]);
        let whole = ways("whole");
        assert_eq!((&whole[..2], whole.last().unwrap().as_str()), (&["".into(), "whole".into()][..], "v1/in/a"));
        symlink("loop", root.join("loop")).unwrap();
        assert!(ways("loop").len() < 50);
    }
}
