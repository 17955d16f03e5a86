//! Reading of settings structs, one field at a time. The function that serde derives holds every field in an option; for
//! structs of some forty fields, compilers take many minutes to optimize it.

use std::borrow::Cow;
use std::fmt;
use std::iter;
use std::marker::PhantomData;

use serde::de::value::MapDeserializer;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, Visitor};
use serde_json::{Error, Value};

use super::old_names::{current_name, find_moved_field};

/// Struct whose fields are read by name.
pub trait FieldsByName<'de>: Default {
    /// Name of the struct.
    const NAME: &'static str;
    /// Names of its fields.
    const FIELDS: &'static [&'static str];

    /// Reads the field `name` from the value that comes next. Fields inside it that are in another group today are added
    /// to `moved`.
    fn read_field<A: MapAccess<'de>>(
        &mut self,
        name: &str,
        map: &mut A,
        moved: &mut MovedFields,
    ) -> Result<(), A::Error>;
}

/// Fields that an old file has in a group which they have left: group of today, and its fields.
#[derive(Default)]
pub struct MovedFields(serde_json::Map<String, Value>);

impl MovedFields {
    /// Adds a field. Returns false if it is there already.
    pub(super) fn insert(&mut self, group: &str, name: &str, value: Value) -> bool {
        let group = self.0.entry(group).or_insert_with(|| Value::Object(serde_json::Map::new()));
        group.as_object_mut().is_some_and(|fields| fields.insert(name.into(), value).is_none())
    }
}

/// Reads a struct. Fields that are left out keep their defaults; unknown and repeated ones are refused.
pub fn struct_by_name<'de, T: FieldsByName<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    let mut moved = MovedFields::default();
    let read = GroupSeed { moved: &mut moved, marker: PhantomData }.deserialize(deserializer)?;
    // A group that is read alone has no other group for them.
    match moved.0.values().filter_map(Value::as_object).flat_map(serde_json::Map::keys).next() {
        None => Ok(read),
        Some(name) => Err(D::Error::unknown_field(name, T::FIELDS)),
    }
}

/// Reads the value of a field. Not inlined, because each field would have a copy.
#[inline(never)]
pub fn value<'de, T: Deserialize<'de>, A: MapAccess<'de>>(map: &mut A) -> Result<T, A::Error> {
    map.next_value()
}

/// Reads a group of fields.
#[inline(never)]
pub fn group<'de, T: FieldsByName<'de>, A: MapAccess<'de>>(
    map: &mut A,
    moved: &mut MovedFields,
) -> Result<T, A::Error> {
    map.next_value_seed(GroupSeed { moved, marker: PhantomData })
}

struct GroupSeed<'a, T> {
    moved: &'a mut MovedFields,
    marker: PhantomData<T>,
}

impl<'de, T: FieldsByName<'de>> DeserializeSeed<'de> for GroupSeed<'_, T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<T, D::Error> {
        deserializer.deserialize_struct(T::NAME, T::FIELDS, self)
    }
}

impl<'de, T: FieldsByName<'de>> Visitor<'de> for GroupSeed<'_, T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "struct {}", T::NAME)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
        let mut read = T::default();
        let mut seen = Vec::with_capacity(T::FIELDS.len());
        let mut moved = MovedFields::default();
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            if let Some(field) = find_moved_field(T::NAME, &key) {
                if !self.moved.insert(field.group, field.new, map.next_value()?) {
                    return Err(A::Error::duplicate_field(field.old));
                }
                continue;
            }
            let name = current_name(T::NAME, &key);
            let Some(&field) = T::FIELDS.iter().find(|field| **field == name) else {
                return Err(A::Error::unknown_field(&key, T::FIELDS));
            };
            if seen.contains(&field) {
                return Err(A::Error::duplicate_field(field));
            }
            seen.push(field);
            read.read_field(field, &mut map, &mut moved)?;
        }
        read_moved_groups(&mut read, moved, &seen)?;
        Ok(read)
    }
}

/// Reads the groups whose fields a file has in other groups. It must not have the groups too.
fn read_moved_groups<'de, T: FieldsByName<'de>, E: serde::de::Error>(
    read: &mut T,
    moved: MovedFields,
    seen: &[&'static str],
) -> Result<(), E> {
    for (group, fields) in moved.0 {
        if let Some(field) = seen.iter().find(|field| **field == group) {
            return Err(E::duplicate_field(field));
        }
        let mut map = MapDeserializer::<_, Error>::new(iter::once((group.as_str(), fields)));
        let result = map.next_key::<IgnoredAny>();
        let result = result.and_then(|_| read.read_field(&group, &mut map, &mut MovedFields::default()));
        result.map_err(|error| E::custom(format!("{group}: {error}")))?;
    }
    Ok(())
}
