//! Input paths that cannot be read: links to themselves, overlong names, files of /proc. Every command says so in words.

#![cfg(target_os = "linux")]

use super::{folder, refusal};

/// Commands that read a file, with `{}` in its place.
const READERS: [(&str, &str); 26] = [
    ("{}.json", "preset check {}"),
    ("{}.json", "preset show {}"),
    ("{}.json", "preset new new.json --from {}"),
    ("{}.json", "render {} -o out.png"),
    ("{}.json", "sheet {} --vary camera.exposure=0,1 -o out.png"),
    ("{}.json", "debug-views {} -o out.png"),
    ("{}.json", "techniques {} -o out.png"),
    ("{}.json", "tweak {}"),
    ("{}.json", "{}"),
    ("{}.ramp.json", "ramp bake {}"),
    ("{}.motif.json", "ramp bake {}"),
    ("{}.ramp.json", "ramp check {}"),
    ("{}.png", "ramp check {}"),
    ("{}.ramp.json", "ramp show {}"),
    ("{}.png", "ramp import {} -o out.ramp.json"),
    ("{}.ggr", "ramp import {} -o out.ramp.json"),
    ("{}.grd", "ramp import {} -o out.ramp.json"),
    ("{}.sprite.json", "ramp fit --sprite {} -o out.ramp.json"),
    ("{}.sprite.json", "sprite bake {}"),
    ("{}.noise.json", "sprite bake {}"),
    ("{}.png", "sprite check {}"),
    ("{}.png", "sprite import {} -o out.png"),
    ("{}.png", "sprite read {} -o out.png"),
    ("{}.six_way.png", "sprite export {} -o out.png out2.png"),
    ("{}.json", "bench compare {} {}"),
    ("{}.json", "bench page {} -o out.html"),
];

#[test]
fn every_command_says_in_words_that_an_input_cannot_be_read() {
    let folder = folder();
    let long = "n".repeat(300);
    // /proc/self/mem is a file of no length to the system, but cannot be read.
    for (name, target) in [("loop", None), ("mem", Some("/proc/self/mem")), (&*long, None)] {
        for (pattern, command) in READERS {
            let file = pattern.replace("{}", name);
            let path = folder.path().join(&file);
            // An overlong name cannot be created.
            let _ = std::os::unix::fs::symlink(target.map_or(&*file, |target| target), &path);
            let arguments: Vec<_> = command.split(' ').map(|word| word.replace("{}", &file)).collect();
            let line = refusal(folder.path(), &arguments.iter().map(String::as_str).collect::<Vec<_>>());
            assert!(!line.contains("os error"), "{line}");
            assert!(line.contains(&file) && line.contains("; expected "), "{command}: {line}");
            let _ = std::fs::remove_file(path);
        }
    }
}

#[test]
fn folders_that_cannot_be_read_are_refused_in_words() {
    let folder = folder();
    std::os::unix::fs::symlink("loop", folder.path().join("loop")).unwrap();
    for name in ["loop", &"n".repeat(300)] {
        for command in [
            &["ramp", "watch", name][..],
            &["ramp", "sheet", "--ramps", name, "-o", "out.png"],
            &["render", "-o", "out.png", "--shaders", name],
            &["render", "-o", "out.png", "--assets", name],
        ] {
            let line = refusal(folder.path(), command);
            assert!(line.contains("; expected ") && !line.contains("os error"), "{line}");
        }
    }
}
