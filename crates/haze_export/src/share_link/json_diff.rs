//! Differences of JSON values, like a JSON merge patch (RFC 7386), but also inside arrays: the difference of two arrays is
//! an object with the changed items by their index, and the length under `#` if that differs.

use serde_json::{Map, Value};

/// Key of an array's length.
const LENGTH: &str = "#";

/// Returns the difference that [`apply`] needs to make `value` from `base`; `None` if they are equal. A key that only `base`
/// has becomes null.
pub fn difference(base: &Value, value: &Value) -> Option<Value> {
    if base == value {
        return None;
    }
    match (base, value) {
        (Value::Object(base), Value::Object(value)) => {
            let removed = base.keys().filter(|key| !value.contains_key(*key)).map(|key| (key.clone(), Value::Null));
            let changed = value.iter().filter_map(|(key, item)| {
                let changed = base.get(key).map_or_else(|| Some(item.clone()), |base| difference(base, item));
                Some((key.clone(), changed?))
            });
            Some(Value::Object(removed.chain(changed).collect()))
        }
        // Numbers and texts are shorter as a whole.
        (Value::Array(base), Value::Array(value)) if value.iter().chain(base).any(Value::is_object) => {
            let changed = value.iter().enumerate().filter_map(|(index, item)| {
                let changed = base.get(index).map_or_else(|| Some(item.clone()), |base| difference(base, item));
                Some((index.to_string(), changed?))
            });
            let mut changed: Map<_, _> = changed.collect();
            if base.len() != value.len() {
                changed.insert(LENGTH.into(), value.len().into());
            }
            Some(Value::Object(changed))
        }
        _ => Some(value.clone()),
    }
}

/// Applies a difference. Returns false if it does not fit: an item of an array that is neither there nor added.
pub fn apply(base: &mut Value, difference: Value) -> bool {
    let Value::Object(mut changed) = difference else {
        *base = difference;
        return true;
    };
    match base {
        Value::Object(base) => changed.into_iter().all(|(key, change)| {
            if change.is_null() {
                base.remove(&key);
                return true;
            }
            apply(base.entry(key).or_insert(Value::Null), change)
        }),
        Value::Array(items) => {
            let length = changed.remove(LENGTH).map_or(Some(items.len() as u64), |length| length.as_u64());
            let added = changed.len() as u64;
            let Some(length) = length.filter(|length| *length <= items.len() as u64 + added) else { return false };
            items.resize(length as usize, Value::Null);
            changed.into_iter().all(|(index, change)| {
                let item = index.parse().ok().and_then(|index: usize| items.get_mut(index));
                item.is_some_and(|item| apply(item, change))
            })
        }
        other => {
            *other = Value::Object(changed);
            true
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_difference_makes_the_value_from_its_base() {
        let base = json!({ "a": 1, "b": { "c": [1, 2], "d": "text" }, "e": [{ "f": 1 }, { "f": 2, "g": 3 }] });
        for value in [
            base.clone(),
            json!({}),
            json!({ "a": 2, "b": { "c": [1, 3], "d": "text" }, "e": [{ "f": 1 }, { "f": 4, "g": 3 }] }),
            json!({ "a": 1, "b": { "d": "other", "new": true }, "e": [] }),
            json!({ "a": 1, "b": { "c": [], "d": "text" }, "e": [{ "f": 1 }, { "f": 2 }, { "h": { "i": [] } }] }),
        ] {
            let mut made = base.clone();
            let is_applied = difference(&base, &value).is_none_or(|difference| apply(&mut made, difference));
            assert!(is_applied && made == value, "{made} {value}");
        }
        let small = difference(&base, &json!({ "a": 1, "b": base["b"], "e": [{ "f": 1 }, { "f": 9, "g": 3 }] }));
        assert_eq!(small, Some(json!({ "e": { "1": { "f": 9 } } })));
    }

    #[test]
    fn a_hostile_difference_allocates_nothing() {
        for wrong in [json!({ "#": 4_000_000_000_u64 }), json!({ "7": 1 }), json!({ "#": -1 }), json!({ "x": 1 })] {
            assert!(!apply(&mut json!([{ "f": 1 }]), wrong.clone()), "{wrong}");
        }
    }
}
