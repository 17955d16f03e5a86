//! Place of the light of fire in a flipbook.

/// Light of fire in the color of a flipbook. It is in `emission.png` in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum Emission {
    /// Part of the color, which is complete.
    #[default]
    Contained,
    /// Not part of the color; to be added to it.
    Separate,
}
