//! Chunks of a PNG: checks that the file is complete, extracts its color tags, and builds further chunks.
//!
//! Not by `png::Info`, which lacks the name of the color profile, and whose reader must decode all pixels to find a
//! truncated end.

/// Color tags of a PNG. (PNG 3, 4.3 "Color spaces")
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ColorTags {
    /// cICP: code points of primaries, transfer function and matrix, and the full-range flag.
    pub cicp: Option<[u8; 4]>,
    /// Name of the embedded ICC profile.
    pub profile: Option<String>,
    /// True if the file has an sRGB chunk.
    pub srgb: bool,
    /// gAMA: the encoding exponent, times 100000.
    pub gamma: Option<u32>,
    /// PLTE: bytes of the palette.
    pub palette_bytes: Option<usize>,
    /// cHRM: x and y of white, red, green and blue, times 100000.
    pub primaries: Option<[[u32; 2]; 4]>,
}

/// Reads the tags without decoding pixels. `None` if the file ends before its last chunk does.
pub fn color_tags(bytes: &[u8]) -> Option<ColorTags> {
    let mut rest = bytes.get(8..)?;
    let mut tags = ColorTags::default();
    let mut has_pixels = false;
    loop {
        let (length, after) = rest.split_first_chunk()?;
        let (kind, after) = after.split_first_chunk::<4>()?;
        let length = u32::from_be_bytes(*length) as usize;
        let data = after.get(..length)?;
        // A 4-byte checksum follows the data.
        rest = after.get(length.checked_add(4)?..)?;
        match kind {
            b"IEND" => return Some(tags),
            b"IDAT" => has_pixels = true,
            // Color chunks are only valid before the pixels.
            _ if has_pixels => {}
            b"PLTE" => tags.palette_bytes = Some(data.len()),
            b"cICP" => tags.cicp = tags.cicp.or(data.try_into().ok()),
            b"sRGB" => tags.srgb = true,
            b"gAMA" => tags.gamma = tags.gamma.or(numbers(data).map(|[gamma]| gamma)),
            b"cHRM" => {
                let pairs = |[a, b, c, d, e, f, g, h]: [u32; 8]| [[a, b], [c, d], [e, f], [g, h]];
                tags.primaries = tags.primaries.or(numbers(data).map(pairs));
            }
            b"iCCP" => {
                let name = data.split(|&byte| byte == 0).next().unwrap_or_default();
                tags.profile.get_or_insert_with(|| name.iter().take(79).map(|&byte| char::from(byte)).collect());
            }
            _ => {}
        }
    }
}

/// Returns a chunk with its length and its checksum.
pub fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [&kind[..], data].concat();
    [&(data.len() as u32).to_be_bytes()[..], &body, &checksum(&body).to_be_bytes()].concat()
}

/// Checksum of a chunk's kind and data. (PNG 3, annex D)
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    })
}

fn numbers<const N: usize>(data: &[u8]) -> Option<[u32; N]> {
    let (numbers, rest) = data.as_chunks::<4>();
    let numbers: [[u8; 4]; N] = numbers.try_into().ok()?;
    rest.is_empty().then(|| numbers.map(u32::from_be_bytes))
}
