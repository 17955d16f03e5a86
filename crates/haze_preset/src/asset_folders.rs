//! Folders in which the images and particle files of a preset are searched for.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use haze_core::error::AssetError;

use super::sequence::exists;
use crate::{builtin, directory};

/// Folder of the preset's file, followed by those that presets share.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AssetFolders {
    own: PathBuf,
    shared: Vec<PathBuf>,
    /// Images in memory, by their names in the preset. They come first.
    images: BTreeMap<PathBuf, Vec<u8>>,
}

/// Images that come with the program. Their names have no extension.
const BUILT_IN: [&[builtin::Builtin]; 4] = [builtin::RAMPS, builtin::MOTIFS, builtin::SPRITES, builtin::NOISES];

/// Maximum number of names in a folder that are compared with a missing one.
const MAX_FOLDER_ENTRIES: usize = 10_000;

/// Minimum similarity of a name to a missing one, to be suggested.
pub(super) const MIN_SIMILARITY: f64 = 0.75;

impl AssetFolders {
    /// The folder of a preset's file alone.
    pub fn for_preset_file(preset: &Path) -> Self {
        Self::new(preset.parent().unwrap_or(Path::new("")))
    }

    /// One folder alone. The empty path is the working directory.
    pub fn new(folder: &Path) -> Self {
        Self { own: folder.into(), ..Self::default() }
    }

    /// Adds folders that presets share, to be searched last.
    pub fn with_shared(mut self, shared: impl IntoIterator<Item = PathBuf>) -> Self {
        self.shared.extend(shared);
        self
    }

    /// Adds PNG files in memory, by their names in the preset, which come before those of the folders.
    pub fn with_images(mut self, images: BTreeMap<PathBuf, Vec<u8>>) -> Self {
        self.images = images;
        self
    }

    /// Image in memory.
    pub(super) fn image(&self, file: &Path) -> Option<&[u8]> {
        self.images.get(file).map(Vec::as_slice)
    }

    /// All paths that a file may have. The first that exists is used.
    pub fn candidate_paths(&self, file: &Path) -> impl Iterator<Item = PathBuf> {
        self.all().map(move |folder| folder.join(file))
    }

    /// Path of a file, or of files that a name with `#` stands for. A file that exists but cannot be read is found;
    /// reading it gives the reason.
    ///
    /// # Errors
    /// [`AssetError::Image`] if no folder has it, with the folders and the most similar name.
    pub fn find(&self, file: &Path) -> Result<PathBuf, AssetError> {
        self.candidate_paths(file).find(|path| exists(path)).ok_or_else(|| self.missing(file))
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&self.own).chain(&self.shared).map(PathBuf::as_path)
    }

    fn missing(&self, file: &Path) -> AssetError {
        let folders: Vec<_> = self
            .all()
            .map(|folder| std::path::absolute(folder.join(".")).unwrap_or(folder.into()).display().to_string())
            .collect();
        let nearest = self.all().filter_map(|folder| nearest(&folder.join(file))).max_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = nearest.map(|(_, name)| format!("; the nearest name is {name:?}")).unwrap_or_default();
        let name = file.file_stem().and_then(OsStr::to_str).unwrap_or_default();
        let is_built_in = BUILT_IN.iter().any(|list| builtin::find(list, name).is_some());
        let nearest = if is_built_in { format!("; the built-in one is {name:?}") } else { nearest };
        let reason = format!("No such file in {}{nearest}", folders.join(", nor in "));
        AssetError::Image { path: self.own.join(file), reason }
    }
}

/// Most similar name of a file in the same folder with the same extension, and its similarity.
fn nearest(file: &Path) -> Option<(f64, String)> {
    let name = file.file_name()?.to_str()?;
    let folder = file.parent()?;
    let ending = file.extension()?;
    let is_kind = |name: &String| Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case(ending));
    let names = directory::names(folder).ok()?.take(MAX_FOLDER_ENTRIES);
    let alike = names.filter(is_kind).map(|other| (strsim::jaro_winkler(name, &other), other));
    // Among equally similar frames the first by name, in whatever order the folder lists them.
    alike.filter(|(alike, _)| *alike >= MIN_SIMILARITY).max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(&a.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_own_folder_comes_first_and_missing_files_suggest_a_similar_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for file in ["shots/both.png", "team/both.png", "team/theirs.png", "team/wispy_edge.png", "shots/a.txt"] {
            std::fs::create_dir_all(path(file).parent().unwrap()).unwrap();
            std::fs::write(path(file), "").unwrap();
        }
        let folders = AssetFolders::for_preset_file(&path("shots/my.json")).with_shared(Some(path("team")));
        let find = |name: &str| folders.find(Path::new(name));
        assert_eq!(find("both.png").unwrap(), path("shots/both.png"));
        assert_eq!(find("theirs.png").unwrap(), path("team/theirs.png"));
        let error = find("wispy_egde.png").unwrap_err().to_string();
        assert!(error.contains("No such file in ") && error.contains(", nor in "), "{error}");
        assert!(error.ends_with("; the nearest name is \"wispy_edge.png\""), "{error}");
        std::fs::write(path("shots/diffuse_sot.png"), "").unwrap();
        let error = find("diffuse_soot.png").unwrap_err().to_string();
        assert!(error.ends_with("; the built-in one is \"diffuse_soot\""), "{error}");
        let error = AssetFolders::new(&path("shots")).find(Path::new("xyz.png")).unwrap_err().to_string();
        assert!(error.ends_with("shots") && !error.contains("nor in"), "{error}");
    }
}
