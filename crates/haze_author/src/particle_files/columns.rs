//! Columns of a particle file: roles by name, and the valid range of each.

use glam::Vec3;
use haze_core::error::one_line;
use haze_core::formula::color::linear_from_srgb;

use super::column_role::{Attribute, ColumnNames, ColumnRole, ROLE_COUNT, attributes, plain_name};
use super::particle_frame::{FileParticle, ProvidedAttributes};

/// Maximum number of columns in a file.
pub const MAX_COLUMNS: usize = 1024;

/// Largest magnitude that is accepted for positions, lengths and times.
const MAX_MAGNITUDE: f64 = 1.0e9;

/// 2^53: a double represents every whole number up to this one.
const MAX_ID: f64 = 9_007_199_254_740_992.0;

/// Tolerance beyond 0 and 1 for a fraction of the lifetime: simulations may overshoot the end of a life slightly.
const LIFETIME_TOLERANCE: f64 = 0.001;

/// A column as the file declares it.
pub struct DeclaredColumn<'a> {
    pub name: &'a str,
    pub kind: ColumnKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColumnKind {
    /// A number of a float type, or as text.
    Number,
    Integer,
    /// An integer of 8 or 16 bits without sign. Of an amount, a color or heat, this value means 1.
    Code(f64),
    /// Several values in a cell. Never read.
    List,
}

/// The columns of a file.
pub struct ColumnMap {
    columns: Vec<Column>,
    /// Attributes that are read, each with its columns.
    read: Vec<(Attribute, Vec<usize>)>,
    /// Columns that are not read because others of the same attribute are.
    replaced: Vec<(Attribute, Vec<usize>)>,
    /// True if both age and life have a column: age / life is then the fraction of the lifetime.
    has_lives: bool,
    /// True if the file has a radius column; otherwise the radius is half the width.
    has_radius: bool,
    pub provided: ProvidedAttributes,
}

struct Column {
    name: String,
    kind: ColumnKind,
    role: Option<ColumnRole>,
}

/// Values of a row, indexed by role.
#[derive(Clone, Copy, Default)]
pub struct RowValues([f64; ROLE_COUNT]);

/// Columns for an attribute.
struct Candidate {
    columns: Vec<usize>,
    roles: &'static [ColumnRole],
    has_integers: bool,
}

impl ColumnMap {
    /// Assigns roles to columns of numbers by name, as [`ColumnMap::new`] does.
    pub fn from_names(names: &[&str]) -> Result<Self, String> {
        let column = |name| DeclaredColumn { name, kind: ColumnKind::Number };
        Self::new(&names.iter().copied().map(column).collect::<Vec<_>>())
    }

    /// Assigns roles to columns by name. If an attribute has columns of several names, those of a float type are read;
    /// of these, the name that [`attributes`] lists first. The error names the missing column, or two columns of one
    /// name and type.
    pub fn new(declared: &[DeclaredColumn]) -> Result<Self, String> {
        let names: Vec<_> = declared.iter().map(|column| plain_name(column.name)).collect();
        let column = |(index, column): (usize, &DeclaredColumn)| {
            let name = column.name.trim();
            let name = if name.is_empty() { format!("column {}", index + 1) } else { one_line(name) };
            Column { name, kind: column.kind, role: None }
        };
        let mut map = Self {
            columns: declared.iter().enumerate().map(column).collect(),
            read: Vec::new(),
            replaced: Vec::new(),
            has_lives: false,
            has_radius: false,
            provided: ProvidedAttributes::default(),
        };
        for (attribute, choices) in attributes() {
            // Floats hold finer values than integers, but not every id.
            let prefers_integers = attribute == Attribute::Id;
            let mut candidates = Vec::new();
            for choice in &choices {
                candidates.extend(map.candidate(&names, choice, prefers_integers)?);
            }
            let is_worse = |candidate: &Candidate| candidate.has_integers != prefers_integers;
            let best = (0..candidates.len()).min_by_key(|index| is_worse(&candidates[*index]));
            let Some(best) = best.map(|index| candidates.remove(index)) else {
                if attribute == Attribute::Position {
                    return Err(map.missing_position(&names, &choices));
                }
                continue;
            };
            for (column, role) in best.columns.iter().zip(best.roles) {
                map.columns[*column].role = Some(*role);
            }
            map.read.push((attribute, best.columns));
            map.replaced.extend(candidates.into_iter().map(|other| (attribute, other.columns)));
        }
        let has = |role: ColumnRole| map.columns.iter().any(|column| column.role == Some(role));
        map.provided = ProvidedAttributes {
            id: has(ColumnRole::Id),
            radius: has(ColumnRole::Radius) || has(ColumnRole::Width),
            rotation: has(ColumnRole::Rotation),
            amount: has(ColumnRole::Amount),
            color: has(ColumnRole::Red),
            heat: has(ColumnRole::Heat),
        };
        map.has_lives = has(ColumnRole::Age) && has(ColumnRole::Life);
        map.has_radius = has(ColumnRole::Radius);
        Ok(map)
    }

    /// Returns the columns that have the names of an attribute; `None` if one is missing.
    fn candidate(
        &self,
        names: &[String],
        choice: &ColumnNames,
        prefers_integers: bool,
    ) -> Result<Option<Candidate>, String> {
        // `r` beside `g` or `b` is a color without its third channel.
        if choice.names == ["r"] && names.iter().any(|name| name == "g" || name == "b") {
            return Ok(None);
        }
        let mut columns = Vec::new();
        for name in &choice.names {
            let has_name = |at: &usize| names[*at] == *name && self.columns[*at].kind != ColumnKind::List;
            let found: Vec<_> = (0..names.len()).filter(has_name).collect();
            let is_best = |column: &usize| self.is_integer(*column) == prefers_integers;
            let best: Vec<_> = found.iter().copied().filter(is_best).collect();
            match (&found[..], &best[..]) {
                ([], _) => return Ok(None),
                ([one], _) | (_, [one]) => columns.push(*one),
                ([one, other, ..], _) => {
                    let [one, other] = [one, other].map(|at| &self.columns[*at].name);
                    return Err(format!("columns \"{one}\" and \"{other}\" have one name; expected one of them"));
                }
            }
        }
        let kind = self.columns[columns[0]].kind;
        let is_color = choice.roles[0] == ColumnRole::Red;
        if is_color && columns.iter().any(|column| self.columns[*column].kind != kind) {
            return Ok(None);
        }
        let has_integers = columns.iter().any(|column| self.is_integer(*column));
        Ok(Some(Candidate { columns, roles: choice.roles, has_integers }))
    }

    fn is_integer(&self, column: usize) -> bool {
        matches!(self.columns[column].kind, ColumnKind::Integer | ColumnKind::Code(_))
    }

    /// Returns the error for a file without positions: the first component that the most complete vector lacks.
    fn missing_position(&self, names: &[String], vectors: &[ColumnNames]) -> String {
        let lacks = |vector: &ColumnNames| -> Vec<usize> {
            (0..vector.names.len()).filter(|index| !names.contains(&vector.names[*index])).collect()
        };
        let fewest = vectors.iter().map(lacks).min_by_key(Vec::len).unwrap_or_default();
        let axis = ["x", "y", "z"][fewest.first().map_or(0, |index| *index)];
        let columns = self.names_of(0..self.columns.len());
        let expected = format!("{axis}, P.{axis}, P[{axis}] or position_{axis}");
        format!("no column for the {axis} position among the columns \"{columns}\"; expected {expected}")
    }

    fn names_of(&self, columns: impl IntoIterator<Item = usize>) -> String {
        let names: Vec<_> = columns.into_iter().map(|column| self.columns[column].name.as_str()).collect();
        one_line(names.join(", "))
    }

    /// Returns the attributes that are read, each with the names of its columns.
    pub fn read_names(&self) -> impl Iterator<Item = (Attribute, String)> {
        self.read.iter().map(|(attribute, columns)| (*attribute, self.names_of(columns.iter().copied())))
    }

    /// Returns the names of columns that are not read because others of the same attribute are.
    pub fn replaced_names(&self) -> impl Iterator<Item = (Attribute, String)> {
        self.replaced.iter().map(|(attribute, columns)| (*attribute, self.names_of(columns.iter().copied())))
    }

    /// Returns the names of the other columns, which are no attribute.
    pub fn unknown_names(&self) -> String {
        let is_unknown = |column: &usize| {
            let is_replaced = self.replaced.iter().any(|(_, columns)| columns.contains(column));
            self.columns[*column].role.is_none() && !is_replaced
        };
        self.names_of((0..self.columns.len()).filter(is_unknown))
    }

    /// Returns the names of the columns of an attribute; empty if it is not read.
    pub fn names(&self, attribute: Attribute) -> String {
        let names = self.read_names().find(|(known, _)| *known == attribute);
        names.map(|(_, names)| names).unwrap_or_default()
    }

    /// True if an attribute is read from integers of 8 or 16 bits.
    pub fn is_code(&self, attribute: Attribute) -> bool {
        let is_code = |column: &usize| matches!(self.columns[*column].kind, ColumnKind::Code(_));
        self.read.iter().any(|(known, columns)| *known == attribute && columns.iter().any(is_code))
    }

    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// True if the column has a role and its values are read.
    pub fn is_read(&self, column: usize) -> bool {
        self.columns.get(column).is_some_and(|column| column.role.is_some())
    }

    /// Parses a number and stores it as [`ColumnMap::set`] does.
    pub fn parse_and_set(&self, column: usize, text: &str, values: &mut RowValues) -> Result<(), String> {
        match text.trim().parse() {
            Ok(value) => self.set(column, value, values),
            Err(_) => Err(self.refuse(column, format!("{:?}", one_line(text)), "a number")),
        }
    }

    /// Checks the range of a value and stores it under the column's role. Does nothing for a column without a role. The
    /// error says what is expected.
    pub fn set(&self, column: usize, value: f64, values: &mut RowValues) -> Result<(), String> {
        let Some(Column { role: Some(role), kind, .. }) = self.columns.get(column) else { return Ok(()) };
        let fraction = -LIFETIME_TOLERANCE..=1.0 + LIFETIME_TOLERANCE;
        // NaN fails every range check.
        let (is_good, expected) = match role {
            ColumnRole::X
            | ColumnRole::Y
            | ColumnRole::Z
            | ColumnRole::VelocityX
            | ColumnRole::VelocityY
            | ColumnRole::VelocityZ
            | ColumnRole::Rotation
            | ColumnRole::Amount => (value.abs() <= MAX_MAGNITUDE, "a number up to 1e9"),
            ColumnRole::Radius
            | ColumnRole::Width
            | ColumnRole::Red
            | ColumnRole::Green
            | ColumnRole::Blue
            | ColumnRole::Heat => ((0.0..=MAX_MAGNITUDE).contains(&value), "0 or more, up to 1e9"),
            ColumnRole::Age if self.has_lives => (value.abs() <= MAX_MAGNITUDE, "a number up to 1e9"),
            ColumnRole::Life if self.has_lives => ((0.0..=MAX_MAGNITUDE).contains(&value), "0 or more, up to 1e9"),
            ColumnRole::Age => {
                (fraction.contains(&value), "a fraction of the lifetime, 0 to 1, or a life column as well")
            }
            ColumnRole::Life => {
                (fraction.contains(&value), "a fraction of the lifetime, 0 to 1, or an age column as well")
            }
            ColumnRole::Id => (value.abs() <= MAX_ID && value.fract() == 0.0, "a whole number"),
        };
        if !is_good {
            return Err(self.refuse(column, value, expected));
        }
        let value = match (role, kind) {
            (ColumnRole::Red | ColumnRole::Green | ColumnRole::Blue, ColumnKind::Code(full)) => {
                f64::from(linear_from_srgb((value / full) as f32))
            }
            (ColumnRole::Amount | ColumnRole::Heat, ColumnKind::Code(full)) => value / full,
            _ => value,
        };
        values.0[*role as usize] = value;
        Ok(())
    }

    /// Builds the particle of a row from its stored values.
    pub fn particle(&self, row: usize, values: &RowValues) -> FileParticle {
        let of = |role: ColumnRole| values.0[role as usize];
        let vector = |roles: [ColumnRole; 3]| Vec3::from(roles.map(|role| of(role) as f32));
        let age = match self.has_lives {
            true => of(ColumnRole::Age) / of(ColumnRole::Life).max(f64::MIN_POSITIVE),
            // At most one of the two has a column; the other is 0.
            false => of(ColumnRole::Age) + of(ColumnRole::Life),
        };
        FileParticle {
            id: if self.provided.id { of(ColumnRole::Id) as i64 } else { row as i64 },
            position: vector([ColumnRole::X, ColumnRole::Y, ColumnRole::Z]),
            radius: if self.has_radius { of(ColumnRole::Radius) } else { 0.5 * of(ColumnRole::Width) } as f32,
            rotation: of(ColumnRole::Rotation) as f32,
            amount: of(ColumnRole::Amount) as f32,
            age: age.clamp(0.0, 1.0) as f32,
            velocity: vector([ColumnRole::VelocityX, ColumnRole::VelocityY, ColumnRole::VelocityZ]),
            color: vector([ColumnRole::Red, ColumnRole::Green, ColumnRole::Blue]),
            heat: of(ColumnRole::Heat) as f32,
        }
    }

    fn refuse(&self, column: usize, found: impl std::fmt::Display, expected: &str) -> String {
        let name = self.columns.get(column).map_or("", |column| column.name.as_str());
        format!("{name}: {found} is not valid; expected {expected}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_recognised_by_the_names_that_programs_use() {
        for names in [["x", "y", "z"], ["P.x", "P.y", "P.z"], ["P[x]", "P[y]", "P[z]"], ["P:x", "P:y", "P:z"]] {
            assert!(ColumnMap::from_names(&names).is_ok(), "{names:?}");
        }
        for names in [["Px", "Py", "Pz"], ["position_x", "position_y", "position_z"], ["P[0]", "P[1]", "P[2]"]] {
            assert!(ColumnMap::from_names(&names).is_ok(), "{names:?}");
        }
        let provided = |name: &str| ColumnMap::from_names(&["x", "y", "z", name]).unwrap().provided;
        assert!(provided("PScale").radius && provided("width").radius && provided("Alpha").amount && provided("ID").id);
        assert!(provided("rotation").rotation && provided("age") == ProvidedAttributes::default());
        let missing = ColumnMap::from_names(&["x", "Z", "ny"]).map(|_| ()).unwrap_err();
        let expected = "expected y, P.y, P[y] or position_y";
        assert_eq!(missing, format!("no column for the y position among the columns \"x, Z, ny\"; {expected}"));
    }

    #[test]
    fn other_columns_are_not_read() {
        let names = ["x", "y", "z", "nx", "0", "v", "Cd[3]", "scale", "", "ä", "vel_x", "vel_y", "g", "r", "scalar"];
        let columns = ColumnMap::from_names(&names).unwrap();
        assert_eq!(columns.names(Attribute::Position), "x, y, z");
        assert_eq!(columns.unknown_names(), names[3..].join(", ").replace(", ,", ", column 9,"));
    }

    #[test]
    fn vectors_are_recognised_by_letters_and_numbers() {
        let vector = |names: [&str; 3], attribute| {
            let columns = ColumnMap::from_names(&[&["x", "y", "z"], &names[..]].concat()).unwrap();
            assert_eq!(columns.names(attribute), names.join(", "));
        };
        for names in [["vx", "vy", "vz"], ["v[0]", "v[1]", "v[2]"], ["velocity.x", "velocity.y", "velocity.z"]] {
            vector(names, Attribute::Velocity);
        }
        for names in [["r", "g", "b"], ["Cd[0]", "Cd[1]", "Cd[2]"], ["red", "green", "blue"], ["Cd.r", "Cd.g", "Cd.b"]]
        {
            vector(names, Attribute::Color);
        }
        vector(["RGB:0", "RGB:1", "RGB:2"], Attribute::Color);
        vector(["diffuse_red", "diffuse_green", "diffuse_blue"], Attribute::Color);
        for names in [["Points:0", "Points:1", "Points:2"], ["Points_0", "Points_1", "Points_2"]] {
            let columns = ColumnMap::from_names(&[&["velocity:0", "y"], &names[..]].concat()).unwrap();
            assert_eq!(columns.names(Attribute::Position), names.join(", "));
            assert_eq!(columns.unknown_names(), "velocity:0, y");
        }
    }

    #[test]
    fn a_red_without_green_and_blue_is_the_radius() {
        let names = |names: &[&str]| {
            let columns = ColumnMap::from_names(&[&["x", "y", "z"], names].concat()).unwrap();
            [columns.names(Attribute::Radius), columns.names(Attribute::Color)]
        };
        assert_eq!(names(&["r"]), ["r", ""]);
        assert_eq!(names(&["R", "scalar_G", "b"]), ["", "R, scalar_G, b"]);
        assert_eq!(names(&["r", "scalar_radius"]), ["scalar_radius", ""]);
        assert_eq!(names(&["r", "b"]), ["", ""]);
    }

    #[test]
    fn floats_are_read_in_place_of_integers_and_two_of_one_name_are_refused() {
        let map = |others: &[(&'static str, ColumnKind)]| {
            let position = ["x", "y", "z"].map(|name| DeclaredColumn { name, kind: ColumnKind::Number });
            let others = others.iter().map(|&(name, kind)| DeclaredColumn { name, kind });
            ColumnMap::new(&position.into_iter().chain(others).collect::<Vec<_>>())
        };
        let byte = ColumnKind::Code(255.0);
        let number = ColumnKind::Number;
        for (others, amount) in [
            ([("alpha", byte), ("opacity", number)], "opacity"),
            ([("amount", byte), ("Alpha", number)], "Alpha"),
            ([("amount", number), ("alpha", number)], "amount"),
            ([("alpha", byte), ("opacity", byte)], "alpha"),
        ] {
            let columns = map(&others).unwrap();
            assert_eq!(columns.names(Attribute::Amount), amount);
            assert_eq!(columns.is_code(Attribute::Amount), others.iter().all(|other| other.1 == byte));
            assert_eq!(columns.replaced_names().count(), 1);
        }
        let columns = map(&[("alpha", byte), ("alpha", number)]).unwrap();
        assert!(!columns.is_read(3) && columns.is_read(4));
        let columns = map(&[("id", ColumnKind::Integer), ("ID", number)]).unwrap();
        assert!(columns.is_read(3) && !columns.is_read(4));
        for kind in [byte, number] {
            let refused = map(&[("alpha", kind), ("scalar_alpha", kind)]).map(|_| ()).unwrap_err();
            assert_eq!(refused, "columns \"alpha\" and \"scalar_alpha\" have one name; expected one of them");
        }
        let bytes = [("red", byte), ("green", byte), ("blue", byte)];
        let floats = [("r", number), ("g", number), ("b", number)];
        assert_eq!(map(&[bytes, floats].concat()).unwrap().names(Attribute::Color), "r, g, b");
        assert_eq!(map(&[bytes[0], bytes[1], ("blue", number)]).unwrap().names(Attribute::Color), "");
    }

    #[test]
    fn the_first_of_several_columns_for_a_role_is_read_and_a_width_is_halved() {
        let columns =
            ColumnMap::from_names(&["x", "y", "z", "width", "alpha", "amount", "pscale", "age", "life"]).unwrap();
        let mut values = RowValues::default();
        for (column, value) in [1.0, 2.0, 3.0, 9.0, 0.9, 0.25, 0.5, 3.0, 4.0].into_iter().enumerate() {
            columns.set(column, value, &mut values).unwrap();
        }
        let particle = columns.particle(7, &values);
        assert_eq!((particle.position, particle.id), (Vec3::new(1.0, 2.0, 3.0), 7));
        assert_eq!((particle.radius, particle.amount, particle.age), (0.5, 0.25, 0.75));
        let columns = ColumnMap::from_names(&["x", "y", "z", "width", "life"]).unwrap();
        let mut values = RowValues::default();
        columns.set(3, 3.0, &mut values).unwrap();
        columns.set(4, 0.4, &mut values).unwrap();
        let particle = columns.particle(0, &values);
        assert_eq!((particle.radius, particle.age), (1.5, 0.4));
    }

    #[test]
    fn values_out_of_range_are_refused_with_the_expected_range() {
        let columns = ColumnMap::from_names(&["x", "y", "z", "pscale", "age", "id"]).unwrap();
        let mut values = RowValues::default();
        let mut refusal = |column, value| columns.set(column, value, &mut values).unwrap_err();
        assert_eq!(refusal(0, f64::NAN), "x: NaN is not valid; expected a number up to 1e9");
        assert_eq!(refusal(2, 1e30), "z: 1000000000000000000000000000000 is not valid; expected a number up to 1e9");
        assert_eq!(refusal(3, -0.5), "pscale: -0.5 is not valid; expected 0 or more, up to 1e9");
        assert!(refusal(4, 3.5).ends_with("0 to 1, or a life column as well"));
        assert_eq!(refusal(5, 1.5), "id: 1.5 is not valid; expected a whole number");
        assert_eq!(
            columns.parse_and_set(0, "one", &mut RowValues::default()).unwrap_err(),
            "x: \"one\" is not valid; expected a number"
        );
    }
}
