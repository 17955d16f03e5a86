//! Values stored between runs, such as the window layout. Each is a JSON file in the state folder.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use haze_core::assets::json;
use haze_core::error::{AssetError, Error};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::file_io;

fn field_path(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).with_extension("json")
}

/// Returns the value stored under a name, or the default; with the error if the file is not valid.
pub fn read<T: DeserializeOwned + Default>(folder: &Path, name: &str) -> (T, Option<Error>) {
    let path = field_path(folder, name);
    match file_io::read_text(&path).and_then(|text| Ok(json::parse(&path, &text)?)) {
        Ok(value) => (value, None),
        Err(Error::Asset(AssetError::Io { error, .. })) if error.kind() == ErrorKind::NotFound => (T::default(), None),
        Err(error) => (T::default(), Some(error)),
    }
}

/// Stores a value under a name.
pub fn write<T: Serialize>(folder: &Path, name: &str, value: &T) -> Result<(), Error> {
    let path = field_path(folder, name);
    file_io::make_folder(folder)?;
    match serde_json::to_string_pretty(value) {
        Ok(text) => Ok(file_io::write_state_file(&path, (text + "\n").as_bytes())?),
        Err(error) => Err(Error::from(AssetError::Io { path, error: error.into() })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
    #[serde(default)]
    struct Layout {
        width: f32,
        open: Vec<String>,
    }

    #[test]
    fn a_stored_layout_is_restored_and_a_broken_one_is_reported_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let state = folder.path().join("not/yet");
        let found = || read::<Layout>(&state, "layout");
        assert!(matches!(found(), (layout, None) if layout == Layout::default()));
        let layout = Layout { width: 0.1, open: vec!["lights".into()] };
        write(&state, "layout", &layout).unwrap();
        assert!(matches!(found(), (found, None) if found == layout));
        std::fs::write(state.join("layout.json"), "{\"width\": wide}").unwrap();
        let (found, error) = found();
        let error = error.unwrap().to_string();
        assert!(found == Layout::default() && error.contains("layout.json:1:11: width: not a value"), "{error}");
    }
}
