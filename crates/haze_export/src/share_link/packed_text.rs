//! Text in the characters of an address: raw deflate over a dictionary that never changes, then base64url without padding.

use miniz_oxide::deflate::core::{CompressorOxide, create_comp_flags_from_zip_params};
use miniz_oxide::deflate::stream::deflate;
use miniz_oxide::inflate::TINFLStatus;
use miniz_oxide::inflate::core::inflate_flags::TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
use miniz_oxide::inflate::core::{DecompressorOxide, decompress};
use miniz_oxide::{MZError, MZFlush, MZStatus};

/// Words that are likely in a preset. Changing a byte would break every link of version 1.
const DICTIONARY: &[u8] = include_bytes!("dictionary_1.txt");

/// Longest text.
pub const MAX_TEXT: usize = 1 << 18;

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// Packs a text; `None` if it is longer than [`MAX_TEXT`].
pub fn pack(text: &str) -> Option<String> {
    if text.len() > MAX_TEXT {
        return None;
    }
    // Level 10, raw deflate, default strategy.
    let mut compressor = CompressorOxide::new(create_comp_flags_from_zip_params(10, -15, 0));
    // The dictionary is compressed first. After a full byte, the rest refers back to it.
    run(&mut compressor, DICTIONARY, MZFlush::Sync)?;
    Some(to_base64url(&run(&mut compressor, text.as_bytes(), MZFlush::Finish)?))
}

fn run(compressor: &mut CompressorOxide, mut input: &[u8], flush: MZFlush) -> Option<Vec<u8>> {
    let mut all = Vec::new();
    loop {
        let mut part = [0; 4096];
        let done = deflate(compressor, input, &mut part, flush);
        input = &input[done.bytes_consumed..];
        all.extend_from_slice(&part[..done.bytes_written]);
        match done.status {
            // The error: nothing is left to write.
            Ok(MZStatus::StreamEnd) | Err(MZError::Buf) => return Some(all),
            Ok(_) if done.bytes_written < part.len() && input.is_empty() && flush != MZFlush::Finish => {
                return Some(all);
            }
            Ok(_) => {}
            Err(_) => return None,
        }
    }
}

/// Unpacks a text of at most [`MAX_TEXT`] bytes; `None` if the characters are not those of a packed text.
pub fn unpack(packed: &str) -> Option<String> {
    let bytes = from_base64url(packed)?;
    let start = DICTIONARY.len();
    let mut out = vec![0; start + MAX_TEXT];
    out[..start].copy_from_slice(DICTIONARY);
    let flags = TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
    let (status, read, written) = decompress(&mut DecompressorOxide::new(), &bytes, &mut out, start, flags);
    // A shortened link ends too early, and nothing follows a whole one.
    if status != TINFLStatus::Done || read != bytes.len() {
        return None;
    }
    String::from_utf8(out[start..start + written].to_vec()).ok()
}

fn to_base64url(bytes: &[u8]) -> String {
    let digits = bytes.chunks(3).flat_map(|three| {
        let bits = three.iter().chain(&[0; 2]).take(3).fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte));
        (0..=three.len()).map(move |digit| char::from(DIGITS[(bits >> (18 - 6 * digit) & 63) as usize]))
    });
    digits.collect()
}

fn from_base64url(text: &str) -> Option<Vec<u8>> {
    let values = text.bytes().map(|byte| DIGITS.iter().position(|digit| *digit == byte));
    let values: Vec<_> = values.collect::<Option<_>>()?;
    let bytes = values.chunks(4).flat_map(|four| {
        let bits = four.iter().chain(&[0; 3]).take(4).fold(0, |bits, value| bits << 6 | *value as u32);
        let [_, bytes @ ..] = bits.to_be_bytes();
        bytes.into_iter().take(four.len() - 1)
    });
    Some(bytes.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64url_is_that_of_rfc_4648() {
        for (bytes, text) in
            [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foob", "Zm9vYg"), ("~~~??", "fn5-Pz8")]
        {
            assert_eq!(to_base64url(bytes.as_bytes()), text);
            assert_eq!(from_base64url(text).unwrap(), bytes.as_bytes());
        }
        assert_eq!((from_base64url("a b"), from_base64url("Zm9=")), (None, None));
    }

    #[test]
    fn texts_are_restored_and_words_of_the_dictionary_cost_little() {
        let long: String =
            (0..20_000_u32).map(|i| char::from(b'a' + (i.wrapping_mul(2_654_435_761) >> 28) as u8)).collect();
        for text in ["", "a", "intensity", "\u{1f525} is not in the dictionary", &long] {
            assert_eq!(unpack(&pack(text).unwrap()).as_deref(), Some(text));
        }
        assert!(pack("soft_scatter_ramp").unwrap().len() < 10);
        assert_eq!(pack(&"a".repeat(MAX_TEXT + 1)), None);
    }

    #[test]
    fn what_was_not_packed_is_refused() {
        let whole = pack("a text that is long enough to be cut").unwrap();
        for wrong in ["", "A", "not packed at all", &whole[..whole.len() - 4], &format!("{whole}AAAA")] {
            assert_eq!(unpack(wrong), None, "{wrong}");
        }
        // A megabyte of zeros: more than the longest text.
        let mut compressor = CompressorOxide::new(create_comp_flags_from_zip_params(10, -15, 0));
        let bomb = run(&mut compressor, &[b'0'; 1 << 20], MZFlush::Finish).unwrap();
        assert!(bomb.len() < 2000);
        assert_eq!(unpack(&to_base64url(&bomb)), None);
    }
}
