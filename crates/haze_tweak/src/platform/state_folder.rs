//! Folder for state that is kept between runs.

use std::ffi::OsString;
use std::path::PathBuf;

/// Environment variable that overrides the folder.
pub const VARIABLE: &str = "HAZE_STATE";

/// Returns the folder for state that is kept between runs. It may not exist yet. `None` on a machine without a home
/// folder. `variable` is [`std::env::var_os`], except in tests.
pub fn state(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    // XDG requires that relative paths are ignored.
    let folder = |name: &str| variable(name).map(PathBuf::from).filter(|folder| folder.is_absolute());
    let usual = || {
        if cfg!(windows) {
            return folder("LOCALAPPDATA");
        }
        let home = folder("HOME")?;
        if cfg!(target_os = "macos") {
            return Some(home.join("Library/Application Support"));
        }
        Some(folder("XDG_STATE_HOME").unwrap_or_else(|| home.join(".local/state")))
    };
    let named = variable(VARIABLE).filter(|folder| !folder.is_empty()).map(PathBuf::from);
    named.or_else(|| Some(usual()?.join("haze")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn the_default_state_folder_and_its_overrides() {
        let by = |variables: &[(&str, &str)]| {
            let find = |name: &str| variables.iter().find(|(variable, _)| *variable == name);
            state(|name| find(name).map(|(_, value)| (*value).into()))
        };
        let home = ("HOME", "/home/a");
        assert_eq!(by(&[home]).unwrap(), PathBuf::from("/home/a/.local/state/haze"));
        assert_eq!(by(&[home, ("XDG_STATE_HOME", "/s")]).unwrap(), PathBuf::from("/s/haze"));
        assert_eq!(by(&[home, ("XDG_STATE_HOME", "s")]).unwrap(), PathBuf::from("/home/a/.local/state/haze"));
        assert_eq!(by(&[home, (VARIABLE, "t")]).unwrap(), PathBuf::from("t"));
        assert_eq!(by(&[home, (VARIABLE, "")]).unwrap(), PathBuf::from("/home/a/.local/state/haze"));
        assert_eq!(by(&[]), None);
    }
}
