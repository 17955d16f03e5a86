//! Settings with a fixed set of named choices, which a user interface can list.

use crate::error::one_line;

/// Setting enum, for code that lists its choices.
pub trait Choice {
    /// Names of all choices, as in presets, on the command line and in user interfaces.
    fn names(&self) -> &'static [&'static str];

    /// Index of the current choice in the names.
    fn index(&self) -> usize;

    /// Selects a choice. An index beyond the names changes nothing.
    fn set_index(&mut self, index: usize);
}

/// Text that names no choice of a setting. The caller knows which field or option it was given for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} is not valid; expected one of {}", one_line(format!("{text:?}")), names.join(", "))]
pub struct ParseChoiceError {
    /// Text that was given.
    pub text: String,
    /// Names of all choices.
    pub names: &'static [&'static str],
}

/// Defines a setting enum: variants, names, `FromStr` and serde.
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        pub enum $name { $($(#[$variant_meta])* #[serde(rename = $text)] $variant,)+ }

        impl $name {
            /// All choices, in the order of the documentation.
            pub const ALL: &[Self] = &[$(Self::$variant,)+];
            /// Names of all choices, in the same order.
            pub const NAMES: &[&str] = &[$($text,)+];

            /// Name used in presets, on the command line and in user interfaces.
            pub const fn name(self) -> &'static str {
                Self::NAMES[self as usize]
            }
        }

        impl $crate::settings::choice::Choice for $name {
            fn names(&self) -> &'static [&'static str] {
                Self::NAMES
            }

            fn index(&self) -> usize {
                *self as usize
            }

            fn set_index(&mut self, index: usize) {
                *self = Self::ALL.get(index).copied().unwrap_or(*self);
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::settings::choice::ParseChoiceError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                let choice = Self::ALL.iter().copied().find(|choice| choice.name() == text);
                choice.ok_or_else(|| Self::Err { text: text.into(), names: Self::NAMES })
            }
        }
    };
}
pub use choice;
