//! Roles of columns, recognised by the names that other programs use.

/// The particle attribute that a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnRole {
    X,
    Y,
    Z,
    Radius,
    /// Twice the radius.
    Width,
    Rotation,
    Amount,
    Age,
    Life,
    VelocityX,
    VelocityY,
    VelocityZ,
    Red,
    Green,
    Blue,
    Heat,
    Id,
}

/// Number of roles.
pub const ROLE_COUNT: usize = ColumnRole::Id as usize + 1;

/// Column names in lower case, letters and digits only. If a file has two columns for a role, the name listed first is
/// read.
const NAMES: [(&str, ColumnRole); 22] = [
    ("radius", ColumnRole::Radius),
    ("pscale", ColumnRole::Radius),
    ("width", ColumnRole::Width),
    ("diameter", ColumnRole::Width),
    ("rotation", ColumnRole::Rotation),
    ("rot", ColumnRole::Rotation),
    ("amount", ColumnRole::Amount),
    ("alpha", ColumnRole::Amount),
    ("opacity", ColumnRole::Amount),
    ("age", ColumnRole::Age),
    ("life", ColumnRole::Life),
    ("red", ColumnRole::Red),
    ("green", ColumnRole::Green),
    ("blue", ColumnRole::Blue),
    ("r", ColumnRole::Red),
    ("g", ColumnRole::Green),
    ("b", ColumnRole::Blue),
    ("heat", ColumnRole::Heat),
    ("temperature", ColumnRole::Heat),
    ("flame", ColumnRole::Heat),
    ("burn", ColumnRole::Heat),
    ("id", ColumnRole::Id),
];

/// A vector of three columns.
struct VectorNames {
    /// Names before the component, in order of preference.
    stems: &'static [&'static str],
    /// Letters of the components. They may also be numbered from 0.
    letters: [char; 3],
    roles: [ColumnRole; 3],
}

const VECTORS: [VectorNames; 3] = [
    VectorNames {
        stems: &["", "p", "pos", "position", "location"],
        letters: ['x', 'y', 'z'],
        roles: [ColumnRole::X, ColumnRole::Y, ColumnRole::Z],
    },
    VectorNames {
        stems: &["v", "vel", "velocity"],
        letters: ['x', 'y', 'z'],
        roles: [ColumnRole::VelocityX, ColumnRole::VelocityY, ColumnRole::VelocityZ],
    },
    VectorNames {
        stems: &["cd", "color", "col"],
        letters: ['r', 'g', 'b'],
        roles: [ColumnRole::Red, ColumnRole::Green, ColumnRole::Blue],
    },
];

/// Returns the role of a column by its name, with its rank: of several columns for a role the lowest rank is read.
pub fn column_role(name: &str) -> Option<(usize, ColumnRole)> {
    let name: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    if let Some(found) = NAMES.iter().position(|(known, _)| *known == name) {
        return Some((found, NAMES[found].1));
    }
    let (stem, axis) = name.split_at_checked(name.len().checked_sub(1)?)?;
    let axis = axis.chars().next()?;
    VECTORS.iter().find_map(|vector| {
        let rank = vector.stems.iter().position(|known| *known == stem)?;
        let is_component = |number: usize| {
            axis == vector.letters[number] || !stem.is_empty() && axis.to_digit(10) == Some(number as u32)
        };
        let component = (0..3).find(|number| is_component(*number))?;
        // After the names above.
        Some((NAMES.len() + rank, vector.roles[component]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_columns_have_no_role() {
        for name in ["nx", "0", "v", "Cd[3]", "scale", "", "ä"] {
            assert_eq!(column_role(name), None, "{name}");
        }
    }

    #[test]
    fn vectors_are_recognised_by_letters_and_numbers() {
        let role = |name| column_role(name).map(|(_, role)| role);
        for names in [["vx", "vy", "vz"], ["v[0]", "v[1]", "v[2]"], ["velocity.x", "velocity.y", "velocity.z"]] {
            assert_eq!(role(names[2]), Some(ColumnRole::VelocityZ), "{names:?}");
            assert_eq!(role(names[0]), Some(ColumnRole::VelocityX), "{names:?}");
        }
        for names in [["r", "g", "b"], ["Cd[0]", "Cd[1]", "Cd[2]"], ["red", "green", "blue"], ["Cd.r", "Cd.g", "Cd.b"]]
        {
            assert_eq!(role(names[1]), Some(ColumnRole::Green), "{names:?}");
        }
    }
}
