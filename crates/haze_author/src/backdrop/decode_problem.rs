//! Errors of image decoders in plain words. Their own messages assume knowledge of their code.

use std::error::Error as _;
use std::io::ErrorKind;

use haze_core::error::{io_problem, one_line};
use image::ImageError;
use image::error::{ImageFormatHint, UnsupportedErrorKind};

const ENDS: &str = "the file ends too early";
const DAMAGED: &str = "damaged";
const SIZE: &str = "its header gives no size that is read; expected -Y HEIGHT +X WIDTH";

/// Parts of messages about Radiance and OpenEXR files, and what to say: the problem alone, or with what is expected.
const KNOWN: [(&str, &str); 11] = [
    ("reference to missing bytes", ENDS),
    ("EOF in ", ENDS),
    ("EXPOSURE value", "EXPOSURE of its header is not a number; expected one above 0"),
    ("PIXASPECT value", "PIXASPECT of its header is not a number; expected one above 0"),
    ("COLORCORR value", "COLORCORR of its header is not three numbers; expected three above 0"),
    ("numbers in COLORCORR", "COLORCORR of its header is not three numbers; expected three above 0"),
    ("height dimension", SIZE),
    ("width dimension", SIZE),
    ("Dimensions line", SIZE),
    ("Image dimensions", SIZE),
    ("Orientation", SIZE),
];

/// Reason why a decoder refuses an image. `expected`: what would be right, if the decoder does not tell.
pub fn decode_problem(error: &ImageError, expected: &str) -> String {
    let problem = match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => ENDS.into(),
        ImageError::IoError(error) => io_problem(error),
        ImageError::Limits(_) => "it takes too much memory to decode".into(),
        ImageError::Decoding(error) => known(&error.source().map(ToString::to_string).unwrap_or_default()).into(),
        ImageError::Unsupported(error) => match error.kind() {
            UnsupportedErrorKind::Format(ImageFormatHint::Name(name)) => {
                format!("its format is {}; expected 32-bit_rle_rgbe", one_line(name))
            }
            UnsupportedErrorKind::GenericFeature(feature) => known(&feature).into(),
            _ => "its form is not read".into(),
        },
        _ => DAMAGED.into(),
    };
    if problem.contains("; expected ") { problem } else { format!("{problem}; expected {expected}") }
}

fn known(message: &str) -> &'static str {
    KNOWN.iter().find(|(part, _)| message.contains(part)).map_or(DAMAGED, |(_, words)| words)
}
