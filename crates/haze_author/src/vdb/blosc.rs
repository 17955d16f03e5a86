//! Blosc containers, as OpenVDB writes them: blocks of shuffled bytes, compressed by LZ4.
//!
//! Source: <https://github.com/Blosc/c-blosc>, `README_HEADER.rst` and `blosc/blosc.c`.

use crate::bytes::{Bytes, inflate};

/// Bits of the flags.
const SHUFFLED: u8 = 1;
const COPIED: u8 = 2;
const SHUFFLED_BITS: u8 = 4;
const UNSPLIT: u8 = 16;
/// Bytes of the header.
const HEADER: usize = 16;
/// Blocks of larger types, or of fewer elements, are one stream; others are one for each byte of the type.
const MAX_STREAMS: usize = 16;
const MIN_ELEMENTS: usize = 128;
/// Compressors by their number.
const COMPRESSORS: [&str; 5] = ["BloscLZ", "LZ4", "Snappy", "Zlib", "Zstandard"];

/// Decompresses a container of `size` bytes. `size` bounds the memory.
pub fn decompress(container: &[u8], size: usize) -> Result<Vec<u8>, String> {
    let mut bytes = Bytes::starting_at(container, 0)?;
    bytes.take(2)?;
    let flags = bytes.u8()?;
    let element = usize::from(bytes.u8()?).max(1);
    let found = bytes.u32()? as usize;
    let block = bytes.u32()? as usize;
    if found != size {
        return Err(format!("{found} bytes in Blosc; expected {size}"));
    }
    if flags & COPIED != 0 {
        bytes.take(HEADER - bytes.position())?;
        return Ok(bytes.take(size)?.to_vec());
    }
    if flags & SHUFFLED_BITS != 0 {
        return Err("Blosc with shuffled bits; expected shuffled bytes, as OpenVDB writes".into());
    }
    if block == 0 {
        return Err("Blosc with blocks of 0 bytes; expected more".into());
    }
    let compressor = flags >> 5;
    let mut whole = vec![0; size];
    let mut shuffled = Vec::new();
    for (index, output) in whole.chunks_mut(block).enumerate() {
        let mut starts = Bytes::starting_at(container, (HEADER + 4 * index) as i64)?;
        let mut input = Bytes::starting_at(container, starts.i32()?.into())?;
        let is_split =
            flags & UNSPLIT == 0 && element <= MAX_STREAMS && block / element >= MIN_ELEMENTS && output.len() == block;
        let streams = if is_split { element } else { 1 };
        shuffled.clear();
        for _ in 0..streams {
            let length = output.len() / streams;
            let stream = input.sized()?;
            // A stream that cannot be made smaller is copied.
            if stream.len() == length {
                shuffled.extend_from_slice(stream);
            } else {
                shuffled.extend_from_slice(&decompress_stream(compressor, stream, length)?);
            }
        }
        if shuffled.len() != output.len() {
            return Err(format!("a block of {} bytes in Blosc; expected {}", shuffled.len(), output.len()));
        }
        if flags & SHUFFLED != 0 && element > 1 {
            unshuffle(&shuffled, element, output);
        } else {
            output.copy_from_slice(&shuffled);
        }
    }
    Ok(whole)
}

fn decompress_stream(compressor: u8, stream: &[u8], length: usize) -> Result<Vec<u8>, String> {
    match compressor {
        1 => {
            let mut output = vec![0; length];
            let found = lz4_flex::block::decompress_into(stream, &mut output);
            let found = found.map_err(|_| "LZ4 in Blosc is damaged; expected a whole file")?;
            output.truncate(found);
            Ok(output)
        }
        3 => inflate(stream, length),
        _ => {
            let name = COMPRESSORS.get(usize::from(compressor)).unwrap_or(&"an unknown compressor");
            Err(format!("{name} in Blosc; expected LZ4 or Zlib, as OpenVDB writes"))
        }
    }
}

/// Puts the bytes of each element together: all first bytes come first, then all second ones.
fn unshuffle(shuffled: &[u8], element: usize, output: &mut [u8]) {
    let count = output.len() / element;
    let (whole, rest) = output.split_at_mut(count * element);
    for (index, bytes) in whole.chunks_mut(element).enumerate() {
        for (byte, value) in bytes.iter_mut().enumerate() {
            *value = shuffled[byte * count + index];
        }
    }
    rest.copy_from_slice(&shuffled[count * element..]);
}
