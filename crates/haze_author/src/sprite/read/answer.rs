//! Answers to questions about sheets, with their confidence.

/// Minimum confidence of an answer that is not called unsure.
pub const SURE: f32 = 0.3;

/// Answer to one question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer<T> {
    /// The answer.
    pub value: T,
    /// Confidence, 0 to 1. Below [`SURE`] the answer is a guess; 1 if it was given.
    pub confidence: f32,
    /// True if the caller gave the answer.
    pub is_given: bool,
}

impl<T> Answer<T> {
    /// Answer of the caller.
    pub fn given(value: T) -> Self {
        Self { value, confidence: 1.0, is_given: true }
    }

    /// Answer that a search has found. Confidence is clamped to 0 to 1; what is not a number is 0.
    pub fn found(value: T, confidence: f32) -> Self {
        let confidence = if confidence.is_nan() { 0.0 } else { confidence.clamp(0.0, 1.0) };
        Self { value, confidence, is_given: false }
    }

    /// The given answer, or else the result of a search.
    pub fn given_or(given: Option<T>, search: impl FnOnce() -> Self) -> Self {
        given.map_or_else(search, Self::given)
    }

    /// An answer that holds only if another does, and is no surer.
    pub fn within<U>(self, other: &Answer<U>) -> Self {
        Self { confidence: self.confidence.min(other.confidence), ..self }
    }

    /// False for a guess.
    pub fn is_sure(&self) -> bool {
        self.confidence >= SURE
    }
}

/// Line of a report: one question, its answer, and the option that overrides it.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Question and answer: `grid 8x8`.
    pub text: String,
    /// Confidence, 0 to 1; `None` if the answer was given.
    pub confidence: Option<f32>,
    /// Option that gives another answer: `--grid`.
    pub option: &'static str,
}

impl Observation {
    pub(super) fn new<T>(text: String, answer: &Answer<T>, option: &'static str) -> Self {
        Self { text, confidence: (!answer.is_given).then_some(answer.confidence), option }
    }

    /// False for a guess.
    pub fn is_sure(&self) -> bool {
        self.confidence.is_none_or(|confidence| confidence >= SURE)
    }
}
