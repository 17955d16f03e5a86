//! Where the pictures and particle files of a preset are looked for.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::sequence::is_there;
use crate::assets::builtin;
use crate::error::Error;

/// The folder of the preset's file, and after it one that presets share.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PictureFolders {
    own: PathBuf,
    shared: Option<PathBuf>,
}

/// Pictures that come with the program: their names have no ending.
const BUILT_IN: [&[builtin::Builtin]; 4] = [builtin::RAMPS, builtin::MOTIFS, builtin::SPRITES, builtin::NOISES];

/// Most names of a folder that are compared with one that is missing.
const MOST_NAMES: usize = 10_000;

/// Least likeness of a name to one that is missing, to be spoken of.
pub(super) const ALIKE: f64 = 0.75;

impl PictureFolders {
    /// The folder of a preset's file alone.
    pub fn beside(preset: &Path) -> Self {
        Self::at(preset.parent().unwrap_or(Path::new("")))
    }

    /// One folder alone; the empty path is the one that the program was started in.
    pub fn at(folder: &Path) -> Self {
        Self { own: folder.into(), shared: None }
    }

    /// These, and then a folder that presets share.
    pub fn and_shared(self, shared: Option<PathBuf>) -> Self {
        Self { shared, ..self }
    }

    /// Every place where a file may lie, the first wins.
    pub fn places(&self, file: &Path) -> impl Iterator<Item = PathBuf> {
        self.all().map(move |folder| folder.join(file))
    }

    /// Where a file lies, or files that a name with `#` stands for. What is there and cannot be read is found: reading it says
    /// why.
    ///
    /// # Errors
    /// [`Error::Image`] where it is in no folder, with the folders, and the name that is most like it.
    pub fn find(&self, file: &Path) -> Result<PathBuf, Error> {
        self.places(file).find(|place| is_there(place)).ok_or_else(|| self.missing(file))
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.own.as_path()).chain(self.shared.as_deref())
    }

    fn missing(&self, file: &Path) -> Error {
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
        Error::Image { path: self.own.join(file), reason }
    }
}

/// The file of the same folder and kind whose name is most like that of a file, and how much.
fn nearest(file: &Path) -> Option<(f64, String)> {
    let (name, folder) = (file.file_name()?.to_str()?, file.parent()?);
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let ending = file.extension()?;
    let is_kind = |name: &String| Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case(ending));
    let names =
        std::fs::read_dir(folder).ok()?.take(MOST_NAMES).filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let alike = names.filter(is_kind).map(|other| (strsim::jaro_winkler(name, &other), other));
    // Of frames that are as much alike the first, whichever way the folder lists them.
    alike.filter(|(alike, _)| *alike >= ALIKE).max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(&a.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_own_folder_comes_first_and_what_is_nowhere_is_told_with_what_is_like_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for file in ["shots/both.png", "team/both.png", "team/theirs.png", "team/wispy_edge.png", "shots/a.txt"] {
            std::fs::create_dir_all(path(file).parent().unwrap()).unwrap();
            std::fs::write(path(file), "").unwrap();
        }
        let folders = PictureFolders::beside(&path("shots/my.json")).and_shared(Some(path("team")));
        let find = |name: &str| folders.find(Path::new(name));
        assert_eq!(find("both.png").unwrap(), path("shots/both.png"));
        assert_eq!(find("theirs.png").unwrap(), path("team/theirs.png"));
        let error = find("wispy_egde.png").unwrap_err().to_string();
        assert!(error.contains("No such file in ") && error.contains(", nor in "), "{error}");
        assert!(error.ends_with("; the nearest name is \"wispy_edge.png\""), "{error}");
        std::fs::write(path("shots/diffuse_sot.png"), "").unwrap();
        let error = find("diffuse_soot.png").unwrap_err().to_string();
        assert!(error.ends_with("; the built-in one is \"diffuse_soot\""), "{error}");
        let error = PictureFolders::at(&path("shots")).find(Path::new("xyz.png")).unwrap_err().to_string();
        assert!(error.ends_with("shots") && !error.contains("nor in"), "{error}");
    }
}
