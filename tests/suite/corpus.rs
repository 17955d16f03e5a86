//! Valid, invalid and mutated input files: nothing panics or exceeds its limits, and an error is one line that names
//! the file. `scripts/fuzz` does the same for longer.
//!
//! `tests/corpus/KIND/` holds the original files; `good_…` are read, `bad_…` are refused.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod png_chunks;
#[cfg(target_os = "linux")]
mod special_paths;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use haze_author::noise_recipe::NoiseRecipe;
use haze_author::particle_files;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::simulation::{VolumeOptions, VolumeSequence};
use haze_author::sprite::bake::{SheetLayout, SpriteRecipe};
use haze_core::assets::image::read_png;
use haze_core::assets::noise::NoiseVolume;
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::emitter;
use haze_core::error::AssetError;
use haze_preset::{AssetFolders, Preset};
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// Reads a file as the kind that its folder in the corpus names, and uses it as the program would.
fn read(kind: &str, path: &Path) -> Result<(), AssetError> {
    match kind {
        "preset" => {
            let preset = Preset::load(path.to_str().unwrap())?;
            let preset = preset.evaluate(preset.time);
            preset.load_materials(path)?;
            let caches = particle_files::load_particle_files(&preset, path, &AssetFolders::for_preset_file(path))?;
            let mut particles = Vec::new();
            let mut alive = 0;
            for (system, cache) in preset.systems.iter().zip(&caches) {
                // Birth times are jittered, so a few more particles than the limit may be alive.
                particle_files::particles(system, cache.as_ref(), preset.time, &mut particles);
                alive += particles.len();
            }
            assert!(alive <= emitter::MAX_PARTICLES as usize + 64, "{alive} particles");
        }
        "ramp" => {
            let recipe = RampRecipe::load(path)?;
            if recipe.width * recipe.height <= 1 << 12 {
                recipe.bake()?;
            }
        }
        "motif" => {
            let recipe = MotifRecipe::load(path)?;
            if recipe.size <= 64 {
                recipe.bake()?;
            }
        }
        "sprite" => {
            let recipe = SpriteRecipe::load(path)?;
            if recipe.size <= 16 {
                recipe.bake_frame(0.5);
            }
        }
        "noise" => {
            let recipe = NoiseRecipe::load(path)?;
            if recipe.size <= 16 {
                recipe.bake()?;
            }
        }
        "png" => {
            let image = read_png(path)?;
            assert!(image.as_bytes().len() <= 64 << 20, "{} bytes", image.as_bytes().len());
            assert!(image.width().max(image.height()) <= 4096);
            Ramp::from_image(&image);
            // An image that is not a sprite or noise is refused with one line too.
            let image = image.to_rgba8();
            for refused in [
                Sprite::from_image(path, &image, SpriteLayout::default()).err(),
                NoiseVolume::from_image(path, &image).err(),
            ] {
                refused.iter().for_each(|error| check_line(path, error));
            }
        }
        "csv" | "ply" => {
            let content = std::fs::read(path).unwrap();
            let frame = particle_files::parse(Path::new(&format!("a.{kind}")), &content, 1000);
            let frame = frame.map_err(|error| error.into_error(path))?;
            assert!(frame.particles().len() <= 1000, "{} particles", frame.particles().len());
            assert!(frame.particles().iter().all(|particle| particle.position.is_finite() && particle.radius >= 0.0));
        }
        "vdb" => {
            let sheet = SheetLayout { size: 8, columns: 1, rows: 1, tolerance: 0 };
            let options = VolumeOptions { resolution: 16, sheet, ..VolumeOptions::default() };
            VolumeSequence::find(path)?.record(&options, |_| Ok::<_, AssetError>(()))?.recording.bake();
        }
        other => panic!("tests/corpus/{other}: no reader for this kind of file"),
    }
    Ok(())
}

/// Checks that an error is one line of reasonable length that names the file and shows no Rust structs.
fn check_line(path: &Path, error: &AssetError) {
    let line = error.to_string();
    assert!(line.contains(path.to_str().unwrap()), "{line}");
    assert!(!line.chars().any(char::is_control), "{line:?}");
    assert!(line.len() < 2000, "{} bytes: {line}", line.len());
    assert!(!line.contains(" { ") && !line.contains("Error"), "{line}");
}

/// A file of the corpus.
#[derive(Clone, Debug)]
struct Sample {
    kind: String,
    name: String,
    bytes: Vec<u8>,
}

fn corpus() -> Vec<Sample> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let entries = |folder: &Path| -> Vec<PathBuf> {
        let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        entries.sort();
        entries
    };
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    let sample = |path: &PathBuf| Sample {
        kind: name(path.parent().unwrap()),
        name: name(path),
        bytes: std::fs::read(path).unwrap(),
    };
    entries(&root).iter().flat_map(|folder| entries(folder)).map(|path| sample(&path)).collect()
}

#[derive(Clone, Debug)]
enum Mutation {
    /// Flips some bits of a byte.
    Flip(Index, u8),
    /// Cuts off the end.
    Truncate(Index),
    /// Overwrites bytes with a part of another file.
    Splice(Index, Vec<u8>),
    /// Repeats a part.
    Repeat(Index, usize),
    /// Inserts bytes that are likely to break a parser.
    Insert(Index, &'static [u8]),
}

const HOSTILE_BYTES: &[&[u8]] = &[
    b"-1",
    b"0",
    b"1e39",
    b"1e-46",
    b"4294967296",
    b"99999999999999999999",
    b"null",
    b"true",
    b"\"\"",
    b"[]",
    b"{}",
    b"[[[[",
    b",",
    b"\n",
    b"\0",
    b"\x1b[2J",
    b"\\u0000",
    b"\\ud800",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\xe2\x80\xae",
    b"\xff\xff\xff\xff",
    b"\x7f\xff\xff\xff",
    b"\0\0\x10\0",
];

fn mutations(corpus: &[Sample]) -> impl Strategy<Value = Vec<Mutation>> + use<> {
    let others: Vec<_> = corpus.iter().map(|sample| sample.bytes.clone()).filter(|bytes| !bytes.is_empty()).collect();
    let part = (select(others), any::<Index>(), 1_usize..64).prop_map(|(bytes, at, length)| {
        let at = at.index(bytes.len());
        bytes[at..bytes.len().min(at + length)].to_vec()
    });
    let mutation = prop_oneof![
        4 => (any::<Index>(), 1_u8..).prop_map(|(at, bits)| Mutation::Flip(at, bits)),
        1 => any::<Index>().prop_map(Mutation::Truncate),
        2 => (any::<Index>(), part).prop_map(|(at, part)| Mutation::Splice(at, part)),
        1 => (any::<Index>(), 1_usize..64).prop_map(|(at, length)| Mutation::Repeat(at, length)),
        4 => (any::<Index>(), select(HOSTILE_BYTES)).prop_map(|(at, bytes)| Mutation::Insert(at, bytes)),
    ];
    proptest::collection::vec(mutation, 1..6)
}

fn mutate(bytes: &mut Vec<u8>, mutation: &Mutation) {
    let position = |at: &Index, bytes: &Vec<u8>| at.index(bytes.len() + 1);
    match mutation {
        Mutation::Flip(at, bits) => {
            let at = position(at, bytes);
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= bits;
            }
        }
        Mutation::Truncate(at) => bytes.truncate(position(at, bytes)),
        Mutation::Splice(at, part) => {
            let at = position(at, bytes);
            bytes.splice(at..bytes.len().min(at + part.len()), part.iter().copied());
        }
        Mutation::Repeat(at, length) => {
            let at = position(at, bytes);
            let part = bytes[at..bytes.len().min(at + length)].to_vec();
            bytes.splice(at..at, part);
        }
        Mutation::Insert(at, part) => {
            let at = position(at, bytes);
            bytes.splice(at..at, part.iter().copied());
        }
    }
}

#[test]
fn the_corpus_is_read_or_refused_as_file_names_say() {
    let folder = tempfile::tempdir().unwrap();
    let corpus = corpus();
    assert!(corpus.len() > 30);
    for Sample { kind, name, bytes } in corpus {
        let path = folder.path().join(format!("{kind}_{name}"));
        std::fs::write(&path, bytes).unwrap();
        match read(&kind, &path) {
            Ok(()) => assert!(name.starts_with("good"), "{kind}/{name} was read; it should be refused"),
            Err(error) => {
                println!("{kind}/{name}: {}", error.to_string().replace(path.to_str().unwrap(), "FILE"));
                check_line(&path, &error);
                assert!(name.starts_with("bad"), "{kind}/{name}: {error}");
            }
        }
    }
}

#[test]
fn mutated_files_are_read_or_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mangled");
    let corpus = corpus();
    let strategy = (select(corpus.clone()), mutations(&corpus));
    // A failure is printed whole, so that it can be added to the corpus.
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |((sample, mutations) in strategy)| {
        let mut bytes = sample.bytes.clone();
        mutations.iter().for_each(|mutation| mutate(&mut bytes, mutation));
        std::fs::write(&path, &bytes).unwrap();
        let started = Instant::now();
        if let Err(error) = read(&sample.kind, &path) {
            check_line(&path, &error);
        }
        // Milliseconds on an idle machine.
        prop_assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
    });
}
