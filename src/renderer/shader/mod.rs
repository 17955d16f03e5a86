//! The WGSL sources, and their composition from `#import "FILE"` lines.
//!
//! An import is replaced by the file, once. That is all: names stay what they are in the source, so a driver's message,
//! a capture and a search show the same function. (naga_oil renames what it imports.)

/// Looks up an embedded shader file by its path under `shaders/`.
pub fn source(file: &str) -> Option<&'static str> {
    SOURCES.iter().find(|(name, _)| *name == file).map(|(_, text)| *text)
}

/// Every embedded shader file: path under `shaders/`, text.
pub fn sources() -> &'static [(&'static str, &'static str)] {
    SOURCES
}

macro_rules! embed {
    ($($file:literal,)+) => { &[$(($file, include_str!(concat!("../../../shaders/", $file))),)+] };
}

const SOURCES: &[(&str, &str)] = embed![
    "accumulate.wgsl",
    "depth_downsample.wgsl",
    "diffuse_bake.wgsl",
    "forward.wgsl",
    "specular_scatter.wgsl",
    "transfer.wgsl",
    "lib/accumulated.wgsl",
    "lib/bindings.wgsl",
    "lib/blending.wgsl",
    "lib/colour.wgsl",
    "lib/depth.wgsl",
    "lib/diffuse.wgsl",
    "lib/diffuse_bake.wgsl",
    "lib/hash.wgsl",
    "lib/lighting.wgsl",
    "lib/noise_volume.wgsl",
    "lib/normal.wgsl",
    "lib/order.wgsl",
    "lib/ramp.wgsl",
    "lib/soft_fade.wgsl",
    "lib/sprite.wgsl",
    "lib/sprite_fragment.wgsl",
    "lib/sprite_vertex.wgsl",
    "lib/system.wgsl",
    "lib/technique.wgsl",
    "lib/tonemap.wgsl",
    "lib/upsample.wgsl",
    "lib/view.wgsl",
];

/// Replaces every `#import "lib/X.wgsl"` line of `text` by that file, and the imports in it, each file once.
/// A host may use it to call haze's functions from shaders of its own.
///
/// # Errors
/// Names the line of an import that is not an embedded file.
pub fn compose(text: &str) -> Result<String, String> {
    let mut composed = String::new();
    append(text, &mut composed, &mut Vec::new())?;
    Ok(composed)
}

fn append(text: &str, composed: &mut String, done: &mut Vec<String>) -> Result<(), String> {
    for (index, line) in text.lines().enumerate() {
        let Some(import) = line.strip_prefix("#import ") else {
            composed.push_str(line);
            composed.push('\n');
            continue;
        };
        let file = import.trim().trim_matches('"');
        if done.iter().any(|name| name == file) {
            continue;
        }
        done.push(file.to_owned());
        let imported =
            source(file).ok_or_else(|| format!("line {}: there is no shader file {file:?} to import", index + 1))?;
        append(imported, composed, done)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_imported_once() {
        let composed = compose("#import \"lib/sprite_vertex.wgsl\"\n#import \"lib/view.wgsl\"\n").unwrap();
        assert_eq!(composed.matches("struct View {").count(), 1);
        assert!(!composed.contains("#import"));
    }

    #[test]
    fn an_unknown_import_is_named_with_its_line() {
        let error = compose("fn f() {}\n#import \"lib/nothing.wgsl\"\n").unwrap_err();
        assert_eq!(error, "line 2: there is no shader file \"lib/nothing.wgsl\" to import");
    }

    #[test]
    fn every_shader_file_is_embedded() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let mut files = Vec::new();
        for folder in ["", "lib"] {
            for entry in std::fs::read_dir(root.join(folder)).unwrap() {
                let name = entry.unwrap().file_name().into_string().unwrap();
                if name.ends_with(".wgsl") {
                    files.push(if folder.is_empty() { name } else { format!("{folder}/{name}") });
                }
            }
        }
        files.sort();
        let mut embedded: Vec<_> = SOURCES.iter().map(|(name, _)| (*name).to_owned()).collect();
        embedded.sort();
        assert_eq!(files, embedded);
    }
}
