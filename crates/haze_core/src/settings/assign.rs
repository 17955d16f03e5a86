//! Assignment of fields by name, for the command line and user interfaces.

use std::collections::BTreeSet;

use super::fields::Fields;
use super::old_names::current_path;
use super::traversal::{FieldRef, PathStep, for_each_field};
use crate::error::{FieldError, one_line};

/// Sets the fields that `path` names to `value`. Returns their name without list indices.
///
/// `systems[1].settings.accumulate.downscale` is one field, `systems.settings.accumulate.downscale` is that field of every
/// system. So is `accumulate.downscale`, or any other ending that belongs to one field only. A value is written as in a
/// preset, without quotes; three numbers are written `1,2,3`. Ranges are not checked: validate the settings afterwards.
///
/// # Errors
/// Fails if no field has this name, if several have it, or if the value is of another kind. Nothing is changed then.
pub fn set_field<T: Fields + Clone>(settings: &mut T, path: &str, value: &str) -> Result<String, FieldError> {
    let current = current_path(path);
    let wanted = parse_path(&current)?;
    // Works on a copy, so that an error leaves nothing half changed.
    let mut changed = settings.clone();
    let mut names = Names::default();
    for_each_field(&mut changed, &mut |path, _| {
        let of_kind = if is_wanted(path, &wanted) { &mut names.wanted } else { &mut names.others };
        of_kind.insert(names_without_indices(path));
    });
    let name = names.resolve(path, &wanted)?;
    let mut error = None;
    for_each_field(&mut changed, &mut |path, leaf| {
        if is_wanted(path, &wanted) && names_without_indices(path) == name {
            error = error.take().or(assign(leaf, value).err());
        }
    });
    match error {
        Some(expected) => Err(FieldError::new(path, format!("{value:?}"), expected)),
        None => {
            *settings = changed;
            Ok(name)
        }
    }
}

/// True for the full path of a field that [`set_field`] sets, if `path` was given and `name` returned.
pub fn is_field_named(field: &str, path: &str, name: &str) -> bool {
    let path = current_path(path);
    let steps = (parse_path(field), parse_path(&path));
    matches!(steps, (Ok(field), Ok(path)) if is_wanted(&field, &path) && names_without_indices(&field) == name)
}

fn parse_path(path: &str) -> Result<Vec<PathStep<'_>>, FieldError> {
    let step = |text| match str::strip_suffix(text, ']') {
        None => Some((text, None)),
        Some(text) => text.split_once('[').and_then(|(name, index)| Some((name, Some(index.parse().ok()?)))),
    };
    let is_name = |(name, _): &PathStep<'_>| !name.is_empty() && !name.contains(['[', ']']);
    let steps: Option<Vec<_>> = path.split('.').map(|text| step(text).filter(is_name)).collect();
    let expected = "names separated by dots, such as systems[0].settings.boost";
    steps.ok_or_else(|| FieldError::new("field", format!("{path:?}"), expected))
}

/// True if the path of a field ends with the wanted steps.
fn is_wanted(path: &[PathStep<'_>], wanted: &[PathStep<'_>]) -> bool {
    let tail = path.len().checked_sub(wanted.len()).map(|start| &path[start..]);
    let fits =
        |(at, wanted): (&PathStep<'_>, &PathStep<'_>)| at.0 == wanted.0 && (wanted.1.is_none() || at.1 == wanted.1);
    tail.is_some_and(|tail| tail.iter().zip(wanted).all(fits))
}

/// Path without list indices.
fn names_without_indices(path: &[PathStep<'_>]) -> String {
    path.iter().map(|step| step.0).collect::<Vec<_>>().join(".")
}

/// Names of the fields that match, and of the others.
#[derive(Default)]
struct Names {
    wanted: BTreeSet<String>,
    others: BTreeSet<String>,
}

impl Names {
    /// The name that matches: in full, or as the only one.
    fn resolve(mut self, path: &str, wanted: &[PathStep<'_>]) -> Result<String, FieldError> {
        if let Some(name) = self.wanted.take(&names_without_indices(wanted)) {
            return Ok(name);
        }
        match (self.wanted.len(), self.wanted.pop_first()) {
            (1, Some(name)) => Ok(name),
            (_, None) => {
                let last = wanted.last().map_or("", |step| step.0);
                let alike = self.others.iter().filter(|name| {
                    let end = name.rsplit('.').next().unwrap_or_default();
                    end.contains(last) || last.contains(end)
                });
                let alike: Vec<_> = alike.take(8).map(String::as_str).collect();
                let expected = match alike.as_slice() {
                    [] => "the name of a field, such as systems.settings.boost".into(),
                    alike => format!("the name of a field, such as {}", alike.join(", ")),
                };
                Err(FieldError::new("field", format!("{path:?}"), expected))
            }
            (_, Some(first)) => {
                let all: Vec<_> = std::iter::once(first).chain(self.wanted).collect();
                let problem = format!("{:?} names several fields", one_line(path));
                Err(FieldError::from_problem("field", problem, format!("one of {}", all.join(", "))))
            }
        }
    }
}

/// Parses and assigns a value. The error says which value is expected.
fn assign(leaf: FieldRef<'_>, text: &str) -> Result<(), String> {
    fn parse<T: std::str::FromStr>(text: &str, expected: &str) -> Result<T, String> {
        text.trim().parse().map_err(|_| expected.into())
    }
    match leaf {
        FieldRef::Number(value) => *value = parse(text, "a number")?,
        FieldRef::Whole(value) => *value = parse(text, "a whole number, 0 or more")?,
        FieldRef::Flag(value) => *value = parse(text, "true or false")?,
        FieldRef::Text(value) => text.clone_into(value),
        FieldRef::Curve(value) => {
            *value = parse(text, "1 to 8 points x:value, with x from 0 to 1, increasing, such as 0:0.2,0.3:1,1:0")?;
        }
        FieldRef::Choice(value) => {
            let index = value.names().iter().position(|name| *name == text);
            value.set_index(index.ok_or_else(|| format!("one of {}", value.names().join(", ")))?);
        }
        FieldRef::Vector(value) => {
            let expected = "three numbers, such as 0.5,1,2";
            let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| parse(number, expected)).collect();
            let numbers: [f32; 3] = numbers?.try_into().map_err(|_| String::from(expected))?;
            *value = numbers.into();
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::settings::FieldVisitor;
    use crate::settings::choice;
    use crate::settings::settings_macro::settings;

    choice! {
        /// Metals.
        Metal {
            /// Soft.
            #[default]
            Tin = "tin",
            /// Heavy.
            Lead = "lead",
        }
    }

    settings! {
        #[derive(Clone, Debug, PartialEq)]
        pub struct Inner {
            scale: f32 = 2.0, number(0.1..=16.0, "");
            metal: Metal = Metal::Tin, choice;
            is_hollow: bool = false, flag;
            #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
            place: Vec3 = Vec3::ZERO, vector(-1.0..=1.0, "m");
        }
    }

    #[derive(Clone, Debug, PartialEq)]
    struct Outer {
        name: String,
        scale: u32,
        layers: Vec<Inner>,
        core: Inner,
    }

    impl Fields for Outer {
        fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
            visitor.text("name", &mut self.name);
            visitor.integer("scale", &mut self.scale, 1..=16, "pixels");
            for (index, layer) in self.layers.iter_mut().enumerate() {
                visitor.item("layers", index, layer);
            }
            visitor.group("core", &mut self.core);
        }
    }

    fn outer() -> Outer {
        Outer { name: "a".into(), scale: 1, layers: vec![Inner::default(); 3], core: Inner::default() }
    }

    #[test]
    fn path_sets_one_field_or_that_field_of_every_item() {
        let mut settings = outer();
        assert_eq!(set_field(&mut settings, "layers[1].place", "1, 2,3").unwrap(), "layers.place");
        assert_eq!(settings.layers.iter().map(|layer| layer.place.z).collect::<Vec<_>>(), [0.0, 3.0, 0.0]);
        set_field(&mut settings, "layers.metal", "lead").unwrap();
        assert!(settings.layers.iter().all(|layer| layer.metal == Metal::Lead));
        assert_eq!(settings.core, Inner::default());
        // A full name has precedence over the ending of another.
        set_field(&mut settings, "scale", "7").unwrap();
        assert_eq!((settings.scale, settings.core.scale), (7, 2.0));
        set_field(&mut settings, "core.is_hollow", "true").unwrap();
        set_field(&mut settings, "name", "b.c = d").unwrap();
        assert!(settings.core.is_hollow && settings.name == "b.c = d");
    }

    #[test]
    fn errors_name_the_expected_value_and_change_nothing() {
        let mut settings = outer();
        for (path, value, message) in [
            ("metal", "tin", "field: \"metal\" names several fields; expected one of core.metal, layers.metal"),
            (
                "core.metals",
                "tin",
                "field: \"core.metals\" is not valid; expected the name of a field, such as core.metal, layers.metal",
            ),
            ("xyz", "1", "field: \"xyz\" is not valid; expected the name of a field, such as systems.settings.boost"),
            (
                "layers[3].scale",
                "1",
                "field: \"layers[3].scale\" is not valid; expected the name of a field, such as core.scale, layers.scale, scale",
            ),
            (
                "layers[.scale",
                "1",
                "field: \"layers[.scale\" is not valid; expected names separated by dots, such as systems[0].settings.boost",
            ),
            ("core.metal", "gold", "core.metal: \"gold\" is not valid; expected one of tin, lead"),
            ("core.scale", "1,5", "core.scale: \"1,5\" is not valid; expected a number"),
            ("core.place", "1,2", "core.place: \"1,2\" is not valid; expected three numbers, such as 0.5,1,2"),
            ("scale", "-1", "scale: \"-1\" is not valid; expected a whole number, 0 or more"),
            ("core.is_hollow", "yes", "core.is_hollow: \"yes\" is not valid; expected true or false"),
        ] {
            assert_eq!(set_field(&mut settings, path, value).unwrap_err().to_string(), message);
            assert_eq!(settings, outer());
        }
    }
}
