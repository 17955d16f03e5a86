//! Shared code of the gradient importers.

/// A parse error: the 1-based line, and what is wrong and expected.
pub struct GradientParseError {
    pub line: usize,
    pub reason: String,
}

/// Parses finite numbers separated by commas or white space; `None` if one is malformed.
pub fn parse_numbers(text: &str) -> Option<Vec<f32>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok().filter(|number: &f32| number.is_finite())).collect()
}
