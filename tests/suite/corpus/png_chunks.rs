//! PNGs with valid checksums and mutated chunks: palettes, transparencies and headers that do not fit together.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::sample::{Index, select};

use super::{check_line, corpus, read};

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// A chunk: type and content.
#[derive(Clone, Debug)]
struct Chunk([u8; 4], Vec<u8>);

/// Chunks of a PNG, without checksums.
fn chunks(png: &[u8]) -> Vec<Chunk> {
    let mut rest = png.strip_prefix(SIGNATURE).unwrap();
    let mut chunks = Vec::new();
    while let [a, b, c, d, kind @ ..] = rest {
        let (kind, content) = kind.split_at(4);
        let (content, after) = content.split_at(u32::from_be_bytes([*a, *b, *c, *d]) as usize);
        chunks.push(Chunk(kind.try_into().unwrap(), content.to_vec()));
        rest = &after[4..];
    }
    chunks
}

fn png(chunks: &[Chunk]) -> Vec<u8> {
    let mut png = SIGNATURE.to_vec();
    for Chunk(kind, content) in chunks {
        let body = [kind, &content[..]].concat();
        png.extend((content.len() as u32).to_be_bytes());
        png.extend(&body);
        png.extend(checksum(&body).to_be_bytes());
    }
    png
}

/// CRC-32 of PNG. (PNG specification, annex D)
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

#[derive(Clone, Debug)]
enum ChunkMutation {
    /// Sets a chunk's length: cut off, or filled with a byte.
    Resize(Index, usize, u8),
    /// Overwrites a byte of a chunk.
    Set(Index, Index, u8),
    Remove(Index),
    /// Moves a copy of a chunk before another.
    Copy(Index, Index),
    /// Inserts a chunk of any content.
    Insert(Index, [u8; 4], Vec<u8>),
    /// Sets bit depth and color type.
    Header(u8, u8),
}

fn mutations() -> impl Strategy<Value = Vec<ChunkMutation>> {
    let kinds: Vec<[u8; 4]> =
        [b"PLTE", b"tRNS", b"IDAT", b"IEND", b"gAMA", b"iCCP", b"acTL", b"fcTL", b"fdAT", b"bKGD"]
            .map(|kind| *kind)
            .into();
    let content = proptest::collection::vec(any::<u8>(), 0..40);
    let mutation = prop_oneof![
        4 => (any::<Index>(), 0_usize..800, any::<u8>()).prop_map(|(at, length, fill)| ChunkMutation::Resize(at, length, fill)),
        2 => (any::<Index>(), any::<Index>(), any::<u8>()).prop_map(|(at, byte, value)| ChunkMutation::Set(at, byte, value)),
        1 => any::<Index>().prop_map(ChunkMutation::Remove),
        1 => (any::<Index>(), any::<Index>()).prop_map(|(from, to)| ChunkMutation::Copy(from, to)),
        3 => (any::<Index>(), select(kinds), content).prop_map(|(at, kind, content)| ChunkMutation::Insert(at, kind, content)),
        2 => (select(vec![1_u8, 2, 4, 8, 16]), select(vec![0_u8, 2, 3, 4, 6])).prop_map(|(bits, color)| ChunkMutation::Header(bits, color)),
    ];
    proptest::collection::vec(mutation, 1..5)
}

fn mutate(chunks: &mut Vec<Chunk>, mutation: ChunkMutation) {
    if chunks.is_empty() {
        return;
    }
    let count = chunks.len();
    match mutation {
        ChunkMutation::Resize(at, length, fill) => chunks[at.index(count)].1.resize(length, fill),
        ChunkMutation::Set(at, byte, value) => {
            let content = &mut chunks[at.index(count)].1;
            let byte = byte.index(content.len() + 1);
            if let Some(byte) = content.get_mut(byte) {
                *byte = value;
            }
        }
        ChunkMutation::Remove(at) => drop(chunks.remove(at.index(count))),
        ChunkMutation::Copy(from, to) => chunks.insert(to.index(count), chunks[from.index(count)].clone()),
        ChunkMutation::Insert(at, kind, content) => chunks.insert(at.index(count), Chunk(kind, content)),
        ChunkMutation::Header(bits, color) => {
            if let Some(both) = chunks[0].1.get_mut(8..10) {
                both.copy_from_slice(&[bits, color]);
            }
        }
    }
}

#[test]
fn pngs_with_mutated_chunks_are_read_or_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mangled.png");
    let originals: Vec<_> = corpus()
        .into_iter()
        .filter(|sample| sample.kind == "png" && sample.name.starts_with("good"))
        .map(|sample| chunks(&sample.bytes))
        .collect();
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |(original in select(originals), mutations in mutations())| {
        let mut chunks = original;
        mutations.into_iter().for_each(|mutation| mutate(&mut chunks, mutation));
        std::fs::write(&path, png(&chunks)).unwrap();
        let started = Instant::now();
        if let Err(error) = read("png", &path) {
            check_line(&path, &error);
        }
        prop_assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
    });
}

#[test]
fn checksums_are_those_of_a_real_png() {
    let real = corpus().into_iter().find(|sample| sample.name == "good_palette").unwrap();
    assert_eq!(png(&chunks(&real.bytes)), real.bytes);
}
