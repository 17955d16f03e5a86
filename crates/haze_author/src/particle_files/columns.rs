//! Columns of a particle file: roles by name, and the valid range of each.

use glam::Vec3;
use haze_core::error::one_line;

use super::column_role::{ColumnRole, ROLE_COUNT, column_role};
use super::particle_frame::{FileParticle, ProvidedAttributes};

/// Maximum number of columns in a file.
pub const MAX_COLUMNS: usize = 1024;

/// Largest magnitude that is accepted for positions, lengths and times.
const MAX_MAGNITUDE: f64 = 1.0e9;

/// 2^53: a double represents every whole number up to this one.
const MAX_ID: f64 = 9_007_199_254_740_992.0;

/// Tolerance beyond 0 and 1 for a fraction of the lifetime: simulations may overshoot the end of a life slightly.
const LIFETIME_TOLERANCE: f64 = 0.001;

/// The columns of a file.
pub struct ColumnMap {
    columns: Vec<Column>,
    /// True if both age and life have a column: age / life is then the fraction of the lifetime.
    has_lives: bool,
    /// True if the file has a radius column; otherwise the radius is half the width.
    has_radius: bool,
    pub provided: ProvidedAttributes,
}

struct Column {
    name: String,
    role: Option<ColumnRole>,
    /// The stored value that means 1: 1 for floats; for amounts, colors and heat, 255 of 8 bits and 65535 of 16.
    unit_value: f64,
}

/// Values of a row, indexed by role.
#[derive(Clone, Copy, Default)]
pub struct RowValues([f64; ROLE_COUNT]);

impl ColumnMap {
    /// Assigns roles to columns by name, in the order of the file. The error names the missing column.
    pub fn from_names(names: &[&str]) -> Result<Self, String> {
        let ranks: Vec<_> = names.iter().map(|name| column_role(name)).collect();
        let chosen = |role: ColumnRole| {
            let of_role =
                ranks.iter().enumerate().filter_map(|(at, rank)| Some((rank.filter(|rank| rank.1 == role)?.0, at)));
            of_role.min().map(|(_, at)| at)
        };
        let columns = names.iter().zip(&ranks).enumerate().map(|(at, (name, rank))| {
            let role = rank.map(|rank| rank.1).filter(|role| chosen(*role) == Some(at));
            Column { name: one_line(name.trim()), role, unit_value: 1.0 }
        });
        let columns = Self {
            columns: columns.collect(),
            has_lives: false,
            has_radius: false,
            provided: ProvidedAttributes::default(),
        };
        let has = |role: ColumnRole| columns.columns.iter().any(|column| column.role == Some(role));
        for (role, axis) in [(ColumnRole::X, 'x'), (ColumnRole::Y, 'y'), (ColumnRole::Z, 'z')] {
            if !has(role) {
                let names: Vec<_> = columns.columns.iter().map(|column| column.name.as_str()).collect();
                let names = one_line(names.join(", "));
                return Err(format!(
                    "no column for the {axis} position among the columns \"{names}\"; expected {axis}, P.{axis}, P[{axis}] or position_{axis}"
                ));
            }
        }
        let provided = ProvidedAttributes {
            id: has(ColumnRole::Id),
            radius: has(ColumnRole::Radius) || has(ColumnRole::Width),
            rotation: has(ColumnRole::Rotation),
            amount: has(ColumnRole::Amount),
            color: has(ColumnRole::Red) || has(ColumnRole::Green) || has(ColumnRole::Blue),
            heat: has(ColumnRole::Heat),
        };
        Ok(Self {
            has_lives: has(ColumnRole::Age) && has(ColumnRole::Life),
            has_radius: has(ColumnRole::Radius),
            provided,
            ..columns
        })
    }

    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// True if the column has a role and its values are read.
    pub fn is_read(&self, column: usize) -> bool {
        self.columns.get(column).is_some_and(|column| column.role.is_some())
    }

    /// If the column holds an amount, a color or heat, sets the stored value that means 1.
    pub fn set_unit_value(&mut self, column: usize, unit_value: f64) {
        let is_share = |role| {
            use ColumnRole::{Amount, Blue, Green, Heat, Red};
            matches!(role, Amount | Red | Green | Blue | Heat)
        };
        if let Some(column) = self.columns.get_mut(column).filter(|column| column.role.is_some_and(is_share)) {
            column.unit_value = unit_value;
        }
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
        let Some(Column { role: Some(role), unit_value, .. }) = self.columns.get(column) else { return Ok(()) };
        let share = -LIFETIME_TOLERANCE..=1.0 + LIFETIME_TOLERANCE;
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
            ColumnRole::Age => (share.contains(&value), "a fraction of the lifetime, 0 to 1, or a life column as well"),
            ColumnRole::Life => {
                (share.contains(&value), "a fraction of the lifetime, 0 to 1, or an age column as well")
            }
            ColumnRole::Id => (value.abs() <= MAX_ID && value.fract() == 0.0, "a whole number"),
        };
        if !is_good {
            return Err(self.refuse(column, value, expected));
        }
        values.0[*role as usize] = value / unit_value;
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
