//! Checks the layers of the source tree: no circular imports between files or folders, no wgpu in crates without a
//! device, and system access of the tweaker only in `platform`. Also checks that documents name existing files.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Names of modules, each with the modules that it imports.
type ImportGraph = BTreeMap<String, BTreeSet<String>>;

/// Returns the code of a file without comments, quoted text and test modules.
fn code(text: &str) -> String {
    // The test module is the last item of a file; other test-only items may be anywhere.
    let text = text.split("\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.map(|line| line.split('"').step_by(2).collect::<String>()).collect::<Vec<_>>().join(" ")
}

/// Returns every path that begins with `crate::`, `super::` or `self::`. Groups in braces are expanded.
fn paths(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for root in ["crate::", "super::", "self::"] {
        for (start, _) in code.match_indices(root) {
            let before = code[..start].chars().next_back();
            if !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                expand_path("", &code[start..], &mut found);
            }
        }
    }
    found
}

/// Parses one path, adds it to `found` with groups in braces expanded, and returns the text that follows it.
fn expand_path<'a>(prefix: &str, text: &'a str, found: &mut Vec<String>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut group) = text.strip_prefix('{') {
        loop {
            group = expand_path(prefix, group, found).trim_start();
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
            expand_path(&format!("{path}::"), rest, found)
        }
        _ => {
            found.push(path);
            rest
        }
    }
}

/// Returns the module of a file: `a::b` for `src/a/b.rs` and `src/a/b/mod.rs`, "" for the roots of library and program.
fn module(file: &Path) -> String {
    let path = file.with_extension("");
    let mut parts: Vec<_> = path.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if parts.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        parts.pop();
    }
    parts.join("::")
}

/// Returns the imports between the files of a source tree, by module.
fn import_graph(files: &[(PathBuf, String)]) -> ImportGraph {
    let modules: BTreeSet<_> = files.iter().map(|(file, _)| module(file)).collect();
    let mut import_graph = ImportGraph::new();
    for (file, text) in files {
        let from = module(file);
        let parent = |path: &str| path.rsplit_once("::").map_or(String::new(), |(parent, _)| parent.to_owned());
        let text = code(text);
        let mut named = paths(&text);
        // `use child::…` in a mod.rs, or `child::…` in its code, names a child module.
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
                base = String::new();
                path = rest.trim_start_matches("::");
            } else {
                while let Some(rest) = path.strip_prefix("super") {
                    base = parent(&base);
                    path = rest.trim_start_matches("::");
                }
                path = path.strip_prefix("self").unwrap_or(path).trim_start_matches("::");
            }
            let mut to = if base.is_empty() { path.to_owned() } else { format!("{base}::{path}") };
            // Shortens the path to the longest prefix that is a module; the rest is an item in that module.
            while !to.is_empty() && !modules.contains(&to) {
                to = parent(&to);
            }
            if to != from && !to.is_empty() {
                import_graph.entry(from.clone()).or_default().insert(to);
            }
        }
    }
    import_graph
}

/// Returns the modules of one circular import, or `None` if there is none.
fn find_cycle(import_graph: &ImportGraph) -> Option<Vec<String>> {
    fn visit(
        at: &str,
        import_graph: &ImportGraph,
        path: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = path.iter().position(|step| step == at) {
            return Some([&path[start..], &[at.to_owned()]].concat());
        }
        if !done.insert(at.to_owned()) {
            return None;
        }
        path.push(at.to_owned());
        let found = import_graph.get(at).into_iter().flatten().find_map(|to| visit(to, import_graph, path, done));
        path.pop();
        found
    }
    let mut done = BTreeSet::new();
    import_graph.keys().find_map(|from| visit(from, import_graph, &mut Vec::new(), &mut done))
}

/// Returns the imports between the top-level folders and files of `src/`.
fn between_folders(import_graph: &ImportGraph) -> ImportGraph {
    let folder = |module: &str| module.split("::").next().unwrap_or_default().to_owned();
    let mut folders = ImportGraph::new();
    for (from, to) in import_graph.iter().flat_map(|(from, to)| to.iter().map(move |to| (folder(from), folder(to)))) {
        // The root is left out: the program imports the library as `haze::`, and the library's root only declares
        // modules.
        if from != to && !from.is_empty() {
            folders.entry(from).or_default().insert(to);
        }
    }
    folders
}

/// Source files of one crate, with paths relative to its `src/`.
fn sources(crate_folder: &Path) -> Vec<(PathBuf, String)> {
    let root = crate_folder.join("src");
    let mut folders = vec![root.clone()];
    let mut files = Vec::new();
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

/// True for files of tests.
fn is_test(file: &Path) -> bool {
    let parts = file.with_extension("");
    parts.iter().any(|part| ["tests", "testing", "special_targets"].iter().any(|name| part == *name))
}

/// Folders of the workspace's crates: the library at the top, the others in `crates/`.
fn crates() -> Vec<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR"));
    let others = std::fs::read_dir(top.join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let crates: Vec<_> = others.filter(|folder| folder.join("Cargo.toml").is_file()).chain([top.to_owned()]).collect();
    assert!(crates.len() > 5, "{crates:?}");
    crates
}

#[test]
fn files_and_folders_have_no_circular_imports() {
    let mut files = 0;
    for folder in crates() {
        let import_graph = import_graph(&sources(&folder));
        files += import_graph.len();
        assert_eq!(find_cycle(&import_graph), None, "circular imports between files of {}", folder.display());
        // Tests of a folder may drive the whole window.
        let without_tests: Vec<_> = sources(&folder).into_iter().filter(|(file, _)| !is_test(file)).collect();
        let folders = between_folders(&self::import_graph(&without_tests));
        assert_eq!(find_cycle(&folders), None, "circular imports between folders of {}", folder.display());
    }
    assert!(files > 200, "imports were found in only {files} files");
}

#[test]
fn crates_without_a_device_depend_on_neither_wgpu_nor_the_renderer() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["haze_core", "haze_preset", "haze_reference", "haze_author"] {
        let manifest = std::fs::read_to_string(top.join("crates").join(name).join("Cargo.toml")).unwrap();
        let dependency = |line: &&str| ["wgpu", "haze.", "haze "].iter().any(|start| line.starts_with(start));
        assert_eq!(manifest.lines().find(dependency), None, "{name}");
    }
}

#[test]
fn files_are_written_by_one_function() {
    /// Calls that create, change or replace a file.
    const CALLS: [&str; 9] = [
        "fs::write(",
        "fs::rename(",
        "fs::copy(",
        "fs::hard_link(",
        "File::create",
        "File::options",
        "OpenOptions::new",
        "save_with_format(",
        ".save(",
    ];
    /// Files with such calls: `write_file`, options that do not block, and the lock, which keeps its file open.
    const WRITERS: [&str; 3] = ["assets/file_type.rs", "atomic_write.rs", "platform/lock_file.rs"];
    let mut found = BTreeSet::new();
    for (file, text) in crates().iter().flat_map(|folder| sources(folder)).filter(|(file, _)| !is_test(file)) {
        // Methods of the tweaker, which do not take a path.
        let code = code(&text).replace(".save()", "").replace(".save(session)", "");
        if CALLS.iter().any(|call| code.contains(call)) {
            found.insert(file.display().to_string());
        }
    }
    assert_eq!(found, WRITERS.map(String::from).into(), "files go through haze_preset::write_file");
}

#[test]
fn paths_named_in_documents_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents: Vec<_> =
        ["ARCHITECTURE.md", "README.md", "shaders/README.md", "ramps/README.md"].map(PathBuf::from).into();
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        let name = Path::new("docs").join(entry.unwrap().file_name());
        documents.extend(name.extension().is_some_and(|extension| extension == "md").then_some(name));
    }
    let mut named = 0;
    for document in &documents {
        let text = std::fs::read_to_string(root.join(document)).unwrap();
        let document = document.display();
        for word in text.split(|c: char| c.is_whitespace() || "`()[]<>,:".contains(c)) {
            let is_path = ["src/", "crates/", "shaders/", "tests/", "docs/", "examples/"]
                .iter()
                .any(|start| word.starts_with(start));
            if is_path && !word.contains('*') && !word.contains("foo.") {
                // A link may lead to a heading.
                let path = word.split('#').next().unwrap_or(word).trim_end_matches(['.', ';']);
                assert!(root.join(path).exists(), "{document}: there is no file {word}");
                named += 1;
            }
        }
    }
    assert!(named > 50, "{named}");
}

#[test]
fn circular_imports_are_detected() {
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
        let import_graph = import_graph(&files);
        (find_cycle(&import_graph).is_some(), find_cycle(&between_folders(&import_graph)).is_some())
    };
    assert_eq!(three("/// [`crate::c`]\nuse std::fmt;"), (false, false));
    assert_eq!(three("fn f() { crate::a::one::g() }"), (true, true));
    assert_eq!(three("use crate::{d, c::Three};"), (true, true));
    // Folders may import each other circularly although no files do.
    let files = [file("a/x.rs", "use crate::b::Y;"), file("b.rs", "use crate::a::z;"), file("a/z.rs", "")];
    assert_eq!(find_cycle(&import_graph(&files)), None);
    assert!(find_cycle(&between_folders(&import_graph(&files))).is_some());
}
