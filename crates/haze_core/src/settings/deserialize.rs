//! Reading of settings structs, one field at a time. The function that serde derives holds every field in an option; for
//! structs of some forty fields, compilers take many minutes to optimize it.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, Visitor};

/// Struct whose fields are read by name.
pub trait FieldsByName<'de>: Default {
    /// Reads the field `name` from the value that comes next.
    fn read_field<A: MapAccess<'de>>(&mut self, name: &str, map: &mut A) -> Result<(), A::Error>;
}

/// Reads a struct. Fields that are left out keep their defaults; unknown and repeated ones are refused.
pub fn struct_by_name<'de, T: FieldsByName<'de>, D: Deserializer<'de>>(
    deserializer: D,
    name: &'static str,
    fields: &'static [&'static str],
) -> Result<T, D::Error> {
    deserializer.deserialize_struct(name, fields, FieldsVisitor { name, fields, marker: PhantomData })
}

/// Reads the value of a field. Not inlined, because each field would have a copy.
#[inline(never)]
pub fn value<'de, T: Deserialize<'de>, A: MapAccess<'de>>(map: &mut A) -> Result<T, A::Error> {
    map.next_value()
}

struct FieldsVisitor<T> {
    name: &'static str,
    fields: &'static [&'static str],
    marker: PhantomData<T>,
}

impl<'de, T: FieldsByName<'de>> Visitor<'de> for FieldsVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "struct {}", self.name)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
        let mut read = T::default();
        let mut seen = Vec::with_capacity(self.fields.len());
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            let Some(&field) = self.fields.iter().find(|field| **field == key) else {
                return Err(A::Error::unknown_field(&key, self.fields));
            };
            if seen.contains(&field) {
                return Err(A::Error::duplicate_field(field));
            }
            seen.push(field);
            read.read_field(field, &mut map)?;
        }
        Ok(read)
    }
}
