//! Folders for what is kept between runs.

use std::ffi::OsString;
use std::path::PathBuf;

/// Environment variable that overrides the folder.
pub const VARIABLE: &str = "HAZE_STATE";

/// Returns the folder for state that is kept between runs. It may not exist yet. `None` on a machine without a home
/// folder. `variable` is [`std::env::var_os`], except in tests.
pub fn state(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let usual =
        || Some(usual(&variable, ["Library/Application Support", "XDG_STATE_HOME", ".local/state"])?.join("haze"));
    named(&variable).or_else(usual)
}

/// Returns the folder for files that can be made again, as [`state`]. Below the folder that overrides the state's, it is
/// `cache`.
pub fn cache(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let usual = || {
        let folder = usual(&variable, ["Library/Caches", "XDG_CACHE_HOME", ".cache"])?.join("haze");
        Some(if cfg!(windows) { folder.join("cache") } else { folder })
    };
    named(&variable).map(|folder| folder.join("cache")).or_else(usual)
}

fn named(variable: &impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    variable(VARIABLE).filter(|folder| !folder.is_empty()).map(PathBuf::from)
}

/// Returns the parent of the program's folder: on macOS a folder of the home folder, on Linux that of a variable, or a folder
/// of the home folder.
fn usual(variable: &impl Fn(&str) -> Option<OsString>, [mac, xdg, linux]: [&str; 3]) -> Option<PathBuf> {
    // XDG requires that relative paths are ignored.
    let folder = |name: &str| variable(name).map(PathBuf::from).filter(|folder| folder.is_absolute());
    if cfg!(windows) {
        return folder("LOCALAPPDATA");
    }
    let home = folder("HOME")?;
    if cfg!(target_os = "macos") {
        return Some(home.join(mac));
    }
    Some(folder(xdg).unwrap_or_else(|| home.join(linux)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn the_default_folders_and_their_overrides() {
        fn find(variables: &[(&str, &str)], name: &str) -> Option<OsString> {
            variables.iter().find(|(variable, _)| *variable == name).map(|(_, value)| (*value).into())
        }
        let by = |variables: &[(&str, &str)]| state(|name| find(variables, name));
        let cached = |variables: &[(&str, &str)]| cache(|name| find(variables, name));
        let home = ("HOME", "/home/a");
        assert_eq!(by(&[home]).unwrap(), PathBuf::from("/home/a/.local/state/haze"));
        assert_eq!(by(&[home, ("XDG_STATE_HOME", "/s")]).unwrap(), PathBuf::from("/s/haze"));
        assert_eq!(by(&[home, ("XDG_STATE_HOME", "s")]).unwrap(), PathBuf::from("/home/a/.local/state/haze"));
        assert_eq!(by(&[home, (VARIABLE, "t")]).unwrap(), PathBuf::from("t"));
        assert_eq!(by(&[home, (VARIABLE, "")]).unwrap(), PathBuf::from("/home/a/.local/state/haze"));
        assert_eq!((by(&[]), cached(&[])), (None, None));
        assert_eq!(cached(&[home]).unwrap(), PathBuf::from("/home/a/.cache/haze"));
        assert_eq!(cached(&[home, ("XDG_CACHE_HOME", "/c")]).unwrap(), PathBuf::from("/c/haze"));
        assert_eq!(cached(&[home, (VARIABLE, "t")]).unwrap(), PathBuf::from("t/cache"));
    }
}
