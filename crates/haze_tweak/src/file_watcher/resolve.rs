//! Resolves a path link by link.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// As many links as Linux follows.
const MAX_LINKS: u32 = 40;

/// Returns every place that decides where a path leads, from the root on: the folders and links on the way and the file
/// itself, each named without links before it. The list ends at the first place that does not exist, which is the one
/// to wait for.
pub fn places(path: &Path) -> Vec<PathBuf> {
    let steps =
        |path: &Path| path.components().rev().map(|part| part.as_os_str().to_owned()).collect::<Vec<OsString>>();
    let mut places = Vec::new();
    let mut links = 0;
    let mut at = PathBuf::new();
    let mut to_go = std::path::absolute(path).map(|path| steps(&path)).unwrap_or_default();
    while let Some(step) = to_go.pop() {
        if step == ".." {
            at.pop();
            continue;
        }
        // A root replaces everything before it.
        let place = at.join(&step);
        if place.parent().is_none() || step == "." {
            at = place;
            continue;
        }
        places.push(place.clone());
        match fs::read_link(&place) {
            Ok(target) if links < MAX_LINKS => {
                links += 1;
                to_go.extend(steps(&target));
            }
            Err(_) if fs::symlink_metadata(&place).is_ok() => at = place,
            _ => break,
        }
    }
    places
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
            let places = places(&root.join(name)).into_iter();
            places.filter_map(|place| Some(place.strip_prefix(&root).ok()?.to_str()?.to_owned())).collect()
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
