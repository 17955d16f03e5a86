//! The pictures that go with a preset into another folder.

use std::path::Path;

use haze::Error;
use haze::preset::Preset;

use crate::app::inputs::picture_files;
use crate::app::tweak::platform::files;

/// Copies the pictures that a preset names from its folder into another, to where the preset looks for them there. Nothing is
/// replaced: before anything is written, another picture in the place of one is refused. A picture that is missing stays so.
pub fn copy_beside(preset: &Preset, from: &Path, to: &Path) -> Result<(), Error> {
    let mut copies = Vec::new();
    for file in picture_files(preset) {
        let (source, target) = (from.join(&file), to.join(&file));
        if !files::exists(&source) || files::is_same(&source, &target) {
            continue;
        }
        let bytes = files::read_picture(&source)?;
        if !files::exists(&target) {
            copies.push((target, bytes));
        } else if files::read_picture(&target)? != bytes {
            let reason = format!(
                "not the picture that goes with the preset, {}; expected a folder without it",
                source.display()
            );
            return Err(Error::Image { path: target, reason });
        }
    }
    for (target, bytes) in copies {
        target.parent().map_or(Ok(()), files::make_folder)?;
        files::write(&target, &bytes)?;
    }
    Ok(())
}
