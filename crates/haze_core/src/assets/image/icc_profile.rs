//! Comparison of an ICC profile with sRGB. (ICC.1:2022)
//!
//! Not by the crate `moxcms`, which `image` uses: a direct dependency, whose version must follow that of `image`, for
//! three tags and a curve.

use crate::formula::color::srgb_from_linear;

/// True if an RGB or gray profile has the primaries and the transfer curve of sRGB, within 1.5 steps of 255.
pub fn is_srgb(profile: &[u8]) -> bool {
    let curves_fit = |names: &[&[u8; 4]]| {
        names.iter().all(|name| {
            tag(profile, name).is_some_and(|curve| {
                (1..=64).all(|step| {
                    let code = step as f32 / 64.0;
                    let decoded = apply_curve(curve, code).unwrap_or(f32::NAN).max(0.0);
                    (srgb_from_linear(decoded) - code).abs() < 1.5 / 255.0
                })
            })
        })
    };
    match profile.get(16..20) {
        Some(b"RGB ") => {
            // XYZ of sRGB's red, green and blue, adapted to D50.
            let primaries = [
                (b"rXYZ", [0.436, 0.222_5, 0.013_9]),
                (b"gXYZ", [0.385_1, 0.716_9, 0.097_1]),
                (b"bXYZ", [0.143_1, 0.060_6, 0.714_1]),
            ];
            let fits = |(name, expected): &(&[u8; 4], [f32; 3])| {
                let found = tag(profile, name).and_then(|data| read_s15fixed16(data.get(8..)?));
                found.is_some_and(|found: [f32; 3]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.002))
            };
            primaries.iter().all(fits) && curves_fit(&[b"rTRC", b"gTRC", b"bTRC"])
        }
        Some(b"GRAY") => curves_fit(&[b"kTRC"]),
        _ => false,
    }
}

/// Returns the data of a tag.
fn tag<'a>(profile: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let count = read_u32(profile, 128)?;
    // Profiles have some tens of tags. Each entry has a name, an offset and a length.
    let mut entries = profile.get(132..)?.as_chunks::<12>().0.iter().take(count.min(1000));
    let entry = entries.find(|entry| entry.starts_with(name))?;
    let offset = read_u32(entry, 4)?;
    let length = read_u32(entry, 8)?;
    profile.get(offset..offset.checked_add(length)?)
}

fn read_u32(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..at + 4)?.try_into().ok().map(|word| u32::from_be_bytes(word) as usize)
}

/// Parses s15Fixed16 numbers: 16 bits before and 16 bits after the binary point.
fn read_s15fixed16<const N: usize>(bytes: &[u8]) -> Option<[f32; N]> {
    let words: [[u8; 4]; N] = bytes.get(..4 * N)?.as_chunks().0.try_into().ok()?;
    Some(words.map(|word| i32::from_be_bytes(word) as f32 / 65536.0))
}

/// Converts a code, 0..1, to light by a curve: a table, an exponent or a parametric formula.
fn apply_curve(curve: &[u8], code: f32) -> Option<f32> {
    let data = curve.get(12..)?;
    match (curve.get(..4)?, read_u32(curve, 8)?) {
        (b"curv", 0) => Some(code),
        (b"curv", 1) => Some(code.powf(f32::from(u16::from_be_bytes(*data.first_chunk()?)) / 256.0)),
        (b"curv", count) => {
            let entry = |index: usize| {
                let bytes = data.get(2 * index..2 * index + 2)?.try_into().ok()?;
                Some(f32::from(u16::from_be_bytes(bytes)) / 65535.0)
            };
            let position = code * (count - 1) as f32;
            let low = position as usize;
            let part = position.fract();
            Some(entry(low)? * (1.0 - part) + entry((low + 1).min(count - 1))? * part)
        }
        (b"para", 0) => read_s15fixed16(data).map(|[exponent]| code.powf(exponent)),
        // The form of sRGB's curve: linear near black.
        (b"para", kind) if kind >> 16 == 3 => read_s15fixed16(data)
            .map(|[exponent, a, b, c, d]| if code >= d { (a * code + b).powf(exponent) } else { c * code }),
        _ => None,
    }
}

#[cfg(test)]
pub(super) mod tests;
