//! Bytes of a glTF file: the file itself, and buffers and images in it or beside it.

use std::path::{Component, Path, PathBuf};

use base64::engine::general_purpose::STANDARD;
use base64::{DecodeError, Engine as _};
use haze_core::assets::bounded_read;
use haze_core::error::{AssetError, one_line};

use super::file_limits::MAX_SCENE_FILE_BYTES;

/// Reads what a glTF file names. Files beside it must lie in its folder or below.
pub struct GltfFiles {
    folder: PathBuf,
    /// Files read so far.
    pub read: Vec<PathBuf>,
}

impl GltfFiles {
    pub fn new(path: &Path) -> Self {
        Self { folder: path.parent().unwrap_or(Path::new("")).into(), read: vec![path.into()] }
    }

    /// Bytes of a URI: of a data URI itself, or of a file. `kind` and `index` tell in errors what has it.
    pub fn bytes(&mut self, uri: &str, kind: &str, index: usize) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let refuse = |problem: &str| format!("{kind} {index}: its data URI {problem}; expected whole base64");
            let text = data.split_once(";base64,").map(|(_, text)| text).ok_or_else(|| refuse("has no base64"))?;
            return STANDARD.decode(text).map_err(|error| match error {
                DecodeError::InvalidByte(at, _) => refuse(&format!("is damaged at character {}", at + 1)),
                _ => refuse("ends too early"),
            });
        }
        let file = self.folder.join(relative(uri)?);
        self.read.push(file.clone());
        bounded_read::read(&file, "buffer or image of a glTF file", MAX_SCENE_FILE_BYTES)
            .map_err(|error| error.to_string())
    }
}

/// Files beside a glTF file that it names, whether they exist or not; empty if it cannot be read. For watching and copying.
pub fn companion_files(path: &Path) -> Vec<PathBuf> {
    let Ok(bytes) = read(path) else { return Vec::new() };
    let Ok(gltf::Gltf { document, .. }) = gltf::Gltf::from_slice_without_validation(&bytes) else { return Vec::new() };
    let json = document.as_json();
    let uris = json.buffers.iter().map(|buffer| &buffer.uri).chain(json.images.iter().map(|image| &image.uri));
    let folder = path.parent().unwrap_or(Path::new(""));
    uris.flatten()
        .filter(|uri| !uri.starts_with("data:"))
        .filter_map(|uri| Some(folder.join(relative(uri).ok()?)))
        .collect()
}

pub fn read(path: &Path) -> Result<Vec<u8>, AssetError> {
    bounded_read::read(path, "glTF file", MAX_SCENE_FILE_BYTES)
}

/// Path of a URI, with its escapes decoded.
fn relative(uri: &str) -> Result<PathBuf, String> {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| first == b'%').and_then(|code| std::str::from_utf8(code).ok());
        let decoded = code.and_then(|code| u8::from_str_radix(code, 16).ok());
        bytes.push(decoded.unwrap_or(first));
        rest = if decoded.is_some() { &after[2..] } else { after };
    }
    let path = PathBuf::from(String::from_utf8_lossy(&bytes).into_owned());
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if stays && !uri.contains(':') {
        return Ok(path);
    }
    Err(format!("{:?} is outside the scene's folder; expected a file beside it", one_line(uri)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_data_or_files_below_the_folder() {
        assert_eq!(relative("my%20textures/a%2.png").unwrap(), Path::new("my textures/a%2.png"));
        for outside in ["../a.bin", "/a.bin", "http://a/b.bin", "file:///a.bin", "%2e%2e/a.bin"] {
            assert!(relative(outside).unwrap_err().contains("expected a file beside it"), "{outside}");
        }
        let mut files = GltfFiles::new(Path::new("a/b.gltf"));
        let mut bytes = |uri: &str| files.bytes(uri, "image", 3);
        assert_eq!(bytes("data:application/octet-stream;base64,AAEC").unwrap(), [0, 1, 2]);
        for (uri, problem) in [
            ("data:,x", "has no base64"),
            ("data:;base64,AA?C", "is damaged at character 3"),
            ("data:;base64,AAE", "ends too early"),
            ("data:;base64,A", "ends too early"),
        ] {
            let expected = format!("image 3: its data URI {problem}; expected whole base64");
            assert_eq!(bytes(uri).unwrap_err(), expected, "{uri}");
        }
        assert!(bytes("gone.bin").unwrap_err().contains("gone.bin"));
        assert_eq!(files.read, [Path::new("a/b.gltf"), Path::new("a/gone.bin")]);
    }
}
