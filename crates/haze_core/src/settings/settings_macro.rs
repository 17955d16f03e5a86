//! Settings structs as tables. A row has a field's type, default, kind, range and unit; the struct, its `Default`, its
//! JSON and its `Fields` are generated from it. A row cannot be incomplete.

/// Defines a settings struct. Rows are `name: Type = default, kind(range, unit);`, where kind is a method of
/// `FieldVisitor`. A range that depends on another field is written `|this| this.near..=10.0`. A string before a row is
/// the heading of the rows that follow.
#[macro_export]
macro_rules! settings {
    ($(#[$meta:meta])* pub struct $name:ident {
        $($($heading:literal:)? $(#[$field_meta:meta])* $field:ident: $type:ty = $default:expr, $kind:ident $(($($argument:tt)*))?;)+
    }) => {
        $(#[$meta])*
        #[derive(serde::Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[cfg_attr(feature = "schema", schemars(default, deny_unknown_fields))]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)+ }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::settings::deserialize::struct_by_name(deserializer)
            }
        }

        impl<'de> $crate::settings::deserialize::FieldsByName<'de> for $name {
            const NAME: &'static str = stringify!($name);
            const FIELDS: &'static [&'static str] = &[$(stringify!($field)),+];

            fn read_field<A: serde::de::MapAccess<'de>>(
                &mut self,
                name: &str,
                map: &mut A,
                _moved: &mut $crate::settings::deserialize::MovedFields,
            ) -> Result<(), A::Error> {
                match name {
                    $(stringify!($field) => self.$field = $crate::settings::settings_macro::read!(map, _moved, $kind)?,)+
                    _ => {}
                }
                Ok(())
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }

        impl $crate::settings::fields::Fields for $name {
            fn visit(&mut self, visitor: &mut dyn $crate::settings::fields::FieldVisitor) {
                $($crate::settings::settings_macro::visit!(self, visitor, $field, $kind $($($argument)*)?);)+
            }

            fn headings(&self) -> &'static [$crate::settings::fields::FieldHeading] {
                &[$((stringify!($field), $crate::settings::settings_macro::heading!($($heading)?))),+]
            }
        }
    };
}
pub use settings;

/// Value of one row from a file.
#[macro_export]
macro_rules! read {
    ($map:ident, $moved:ident, group) => {
        $crate::settings::deserialize::group($map, $moved)
    };
    ($map:ident, $moved:ident, $kind:ident) => {
        $crate::settings::deserialize::value($map)
    };
}
pub use read;

/// Heading before a row, or `None`.
#[macro_export]
macro_rules! heading {
    () => {
        None
    };
    ($heading:literal) => {
        Some($heading)
    };
}
pub use heading;

/// Call of the visitor for one row.
#[macro_export]
macro_rules! visit {
    ($self:ident, $visitor:ident, $field:ident, $kind:ident |$this:ident| $range:expr, $unit:expr) => {
        let range = {
            let $this = &*$self;
            $range
        };
        $visitor.$kind(stringify!($field), &mut $self.$field, range, $unit);
    };
    ($self:ident, $visitor:ident, $field:ident, $kind:ident $($argument:expr),*) => {
        $visitor.$kind(stringify!($field), &mut $self.$field $(, $argument)*);
    };
}
pub use visit;
