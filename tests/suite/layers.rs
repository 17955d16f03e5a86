//! Every import looks down: no files, and no folders, import each other in a circle.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Who imports whom.
type Arrows = BTreeMap<String, BTreeSet<String>>;

/// The code of a file without comments, text in quotes and test modules.
fn code(text: &str) -> String {
    // Tests stand at the end of a file; other things that only they use may stand anywhere.
    let text = text.split("\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.map(|line| line.split('"').step_by(2).collect::<String>()).collect::<Vec<_>>().join(" ")
}

/// Every path that begins with `crate::`, `super::` or `self::`, groups in braces spelled out.
fn paths(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for root in ["crate::", "super::", "self::"] {
        for (start, _) in code.match_indices(root) {
            let before = code[..start].chars().next_back();
            if !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                spell_out("", &code[start..], &mut found);
            }
        }
    }
    found
}

/// Reads one path, and gives back what follows it.
fn spell_out<'a>(prefix: &str, text: &'a str, found: &mut Vec<String>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut group) = text.strip_prefix('{') {
        loop {
            group = spell_out(prefix, group, found).trim_start();
            match group.chars().next() {
                Some(',') => group = &group[1..],
                Some('}') => return &group[1..],
                _ => return group,
            }
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (name, rest) = text.split_at(end);
    let path = format!("{prefix}{name}");
    match rest.strip_prefix("::") {
        Some(rest) if rest.starts_with(|c: char| c.is_alphabetic() || c == '_' || c == '{') => {
            spell_out(&format!("{path}::"), rest, found)
        }
        _ => {
            found.push(path);
            rest
        }
    }
}

/// `src/a/b.rs` and `src/a/b/mod.rs` are the module `a::b`; the library's and the program's root are "".
fn module(file: &Path) -> String {
    let path = file.with_extension("");
    let mut parts: Vec<_> = path.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if parts.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        parts.pop();
    }
    parts.join("::")
}

/// The arrows between the files of a tree, by module.
fn arrows(files: &[(PathBuf, String)]) -> Arrows {
    let modules: BTreeSet<_> = files.iter().map(|(file, _)| module(file)).collect();
    let mut arrows = Arrows::new();
    for (file, text) in files {
        let from = module(file);
        let parent = |path: &str| path.rsplit_once("::").map_or(String::new(), |(parent, _)| parent.to_owned());
        let text = code(text);
        let mut named = paths(&text);
        // `use child::…` in a mod.rs, or a bare `child::…`, names a module below it.
        let below = |module: &&String| !module.is_empty() && parent(module) == from && **module != from;
        for child in modules.iter().filter(below) {
            let name = child.rsplit("::").next().unwrap();
            let is_named = text
                .match_indices(&format!("{name}::"))
                .any(|(at, _)| !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':'));
            if is_named {
                named.push(format!("crate::{child}"));
            }
        }
        for path in named {
            let mut path = path.as_str();
            let mut base = from.clone();
            if let Some(rest) = path.strip_prefix("crate") {
                (base, path) = (String::new(), rest.trim_start_matches("::"));
            } else {
                while let Some(rest) = path.strip_prefix("super") {
                    (base, path) = (parent(&base), rest.trim_start_matches("::"));
                }
                path = path.strip_prefix("self").unwrap_or(path).trim_start_matches("::");
            }
            let mut to = if base.is_empty() { path.to_owned() } else { format!("{base}::{path}") };
            // The longest beginning that is a module; the rest is an item in it.
            while !to.is_empty() && !modules.contains(&to) {
                to = parent(&to);
            }
            if to != from && !to.is_empty() {
                arrows.entry(from.clone()).or_default().insert(to);
            }
        }
    }
    arrows
}

/// One circle, if there is any.
fn circle(arrows: &Arrows) -> Option<Vec<String>> {
    fn visit(at: &str, arrows: &Arrows, path: &mut Vec<String>, done: &mut BTreeSet<String>) -> Option<Vec<String>> {
        if let Some(start) = path.iter().position(|step| step == at) {
            return Some([&path[start..], &[at.to_owned()]].concat());
        }
        if !done.insert(at.to_owned()) {
            return None;
        }
        path.push(at.to_owned());
        let found = arrows.get(at).into_iter().flatten().find_map(|to| visit(to, arrows, path, done));
        path.pop();
        found
    }
    let mut done = BTreeSet::new();
    arrows.keys().find_map(|from| visit(from, arrows, &mut Vec::new(), &mut done))
}

/// The same between the folders and files of `src/`.
fn between_folders(arrows: &Arrows) -> Arrows {
    let folder = |module: &str| module.split("::").next().unwrap_or_default().to_owned();
    let mut folders = Arrows::new();
    for (from, to) in arrows.iter().flat_map(|(from, to)| to.iter().map(move |to| (folder(from), folder(to)))) {
        // The program stands on the library by its name, `haze::`; the library's root only lists.
        if from != to && !from.is_empty() {
            folders.entry(from).or_default().insert(to);
        }
    }
    folders
}

fn sources() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut folders, mut files) = (vec![root.clone()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push((path.strip_prefix(&root).unwrap().to_owned(), std::fs::read_to_string(&path).unwrap()));
            }
        }
    }
    files
}

#[test]
fn every_import_looks_down() {
    let arrows = arrows(&sources());
    assert!(arrows.len() > 50, "imports are not found");
    assert_eq!(circle(&arrows), None, "files import each other in a circle");
    assert_eq!(circle(&between_folders(&arrows)), None, "folders import each other in a circle");
}

#[test]
fn the_two_renderers_do_not_know_each_other() {
    for (from, to) in arrows(&sources()) {
        for (one, other) in [("renderer", "reference"), ("reference", "renderer")] {
            let crosses = |to: &&String| to.starts_with(other);
            assert_eq!(to.iter().find(crosses).filter(|_| from.starts_with(one)), None, "{from}");
        }
    }
}

#[test]
fn nothing_on_the_ground_knows_a_device() {
    for (file, text) in sources() {
        let ground = ["settings", "assets", "formula", "in_view", "reference", "preset", "emitter.rs"];
        if ground.iter().any(|part| file.starts_with(part)) {
            assert!(!code(&text).contains("wgpu"), "{}", file.display());
        }
    }
}

/// What touches disk, clock or threads: in the program's own words, or by what the library and the command line have for it.
const OF_THE_SYSTEM: &[&str] = &[
    "std::fs",
    "std::thread",
    "std::time",
    "std::process",
    "fs::",
    "thread::",
    "path::absolute",
    ".exists()",
    ".is_file()",
    ".is_dir()",
    ".metadata()",
    ".canonicalize()",
    ".read_dir()",
    "rfd::",
    "pollster::",
    "haze::assets::file",
    "haze::picture::read_",
    "haze::picture::write_",
    "haze::picture::FileIdentity",
    "json::read(",
    "Preset::read(",
    "::load(",
    ".load(folder",
    "preset.load_materials",
    "preset.load_caches",
    "check_files",
    "from_folder",
    "folders.find(",
    "crate::app::export",
    "crate::app::watch",
    "crate::app::inputs::caches_of",
];

/// Which of these words a file says, imports spelled out.
fn of_the_system(text: &str) -> Option<&'static str> {
    let code = code(text);
    let mut said = vec![code.clone()];
    for root in ["crate::", "std::", "haze::"] {
        for (start, _) in code.match_indices(root) {
            spell_out("", &code[start..], &mut said);
        }
    }
    OF_THE_SYSTEM.iter().find(|word| said.iter().any(|said| says(said, word))).copied()
}

/// A word that begins there: `puffs::` is no `fs::`.
fn says(text: &str, word: &str) -> bool {
    let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
    text.match_indices(word).any(|(start, _)| !word.starts_with(is_name) || !text[..start].ends_with(is_name))
}

#[test]
fn the_window_touches_disk_clock_and_threads_in_one_place() {
    let (mut count, mut behind) = (0, 0);
    for (file, text) in sources() {
        let is_test = file.iter().any(|part| part.to_string_lossy().contains("test"));
        if !file.starts_with("app/tweak") || is_test {
            continue;
        }
        let found = of_the_system(&text);
        if file.starts_with("app/tweak/platform") {
            behind += usize::from(found.is_some());
        } else {
            assert_eq!(found, None, "{}: belongs behind `platform`", file.display());
            count += 1;
        }
    }
    assert!(count > 80 && behind > 5, "{count} {behind}");
    assert_eq!(of_the_system("use std::{env, fs};"), Some("std::fs"));
    assert_eq!(of_the_system("use haze::picture::{Picture, write_png};"), Some("haze::picture::write_"));
    assert_eq!(of_the_system("let sprite = Sprite::load(path); // std::fs"), Some("::load("));
    assert_eq!(of_the_system("use crate::app::puffs::pairs;"), None);
    assert_eq!(of_the_system("use super::platform::clock::Instant;\nflag.load(Ordering::Relaxed);"), None);
}

#[test]
fn documents_name_files_that_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents: Vec<_> =
        ["ARCHITECTURE.md", "README.md", "shaders/README.md", "ramps/README.md"].map(PathBuf::from).into();
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        let name = Path::new("docs").join(entry.unwrap().file_name());
        documents.extend(name.extension().is_some_and(|extension| extension == "md").then_some(name));
    }
    let mut named = 0;
    for document in &documents {
        let (text, document) = (std::fs::read_to_string(root.join(document)).unwrap(), document.display());
        for word in text.split(|c: char| c.is_whitespace() || "`()[]<>,:".contains(c)) {
            let is_path =
                ["src/", "shaders/", "tests/", "docs/", "examples/"].iter().any(|start| word.starts_with(start));
            if is_path && !word.contains('*') && !word.contains("foo.") {
                assert!(root.join(word.trim_end_matches(['.', ';'])).exists(), "{document} names {word}");
                named += 1;
            }
        }
    }
    assert!(named > 50, "{named}");
}

#[test]
fn circles_are_seen() {
    let file = |name: &str, text: &str| (PathBuf::from(name), text.to_owned());
    let three = |last: &str| {
        let files = [
            file("a/mod.rs", "mod one;\npub use one::One;"),
            file(
                "a/one.rs",
                "use crate::b::{\n    self, Two, // not crate::a\n};\n#[cfg(test)]\nmod tests { use crate::c; }",
            ),
            file("b.rs", last),
            file("c.rs", "use super::a::One;"),
        ];
        let arrows = arrows(&files);
        (circle(&arrows).is_some(), circle(&between_folders(&arrows)).is_some())
    };
    assert_eq!(three("/// [`crate::c`]\nuse std::fmt;"), (false, false));
    assert_eq!(three("fn f() { crate::a::one::g() }"), (true, true));
    assert_eq!(three("use crate::{d, c::Three};"), (true, true));
    // Folders may be in a circle where no files are.
    let files = [file("a/x.rs", "use crate::b::Y;"), file("b.rs", "use crate::a::z;"), file("a/z.rs", "")];
    assert_eq!(circle(&arrows(&files)), None);
    assert!(circle(&between_folders(&arrows(&files))).is_some());
}
