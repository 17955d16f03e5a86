//! Keeps the page's files in the browser, so that a reload finds them again.

use std::path::Path;

use haze_core::assets::{bounded_read, memory_files};
use web_sys::Storage;

/// Prefix of the keys.
const PREFIX: &str = "haze/";

/// Larger files are not kept: a browser grants 5 MiB in all.
const MAX_BYTES: u64 = 1 << 20;

fn local_storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok()?
}

/// Restores the files of earlier visits.
pub fn load() {
    let Some(storage) = local_storage() else { return };
    let count = storage.length().unwrap_or(0);
    let keys: Vec<_> = (0..count).filter_map(|index| storage.key(index).ok()?).collect();
    for key in keys {
        if let Some(path) = key.strip_prefix(PREFIX)
            && let Ok(Some(text)) = storage.get_item(&key)
        {
            // One character for each byte.
            let bytes: Vec<_> = text.chars().filter_map(|c| u8::try_from(u32::from(c)).ok()).collect();
            let _ = memory_files::write_file(Path::new(path), &bytes);
        }
    }
    memory_files::take_changed();
}

/// Keeps the files that have changed since the last call. Returns false if one could not be kept.
pub fn save_changed() -> bool {
    let changed = memory_files::take_changed();
    // The usual case, in every frame.
    if changed.is_empty() {
        return true;
    }
    let Some(storage) = local_storage() else { return false };
    let keep = |path: &Path| {
        let key = format!("{PREFIX}{}", path.display());
        if !memory_files::is_taken(path) {
            return storage.remove_item(&key).is_ok();
        }
        let Ok(bytes) = bounded_read::read(path, "file", MAX_BYTES) else { return false };
        let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
        storage.set_item(&key, &text).is_ok()
    };
    changed.iter().filter(|path| !keep(path)).count() == 0
}
