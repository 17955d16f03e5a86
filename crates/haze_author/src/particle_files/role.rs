//! What columns are for, by the names that programs give them.

/// What a column is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
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
    Id,
}

/// How many roles there are.
pub const ROLES: usize = Role::Id as usize + 1;

/// What columns are called in small letters, without points, brackets, colons, lines and blanks; of two for one role the name
/// that comes first here is read.
const NAMES: [(&str, Role); 12] = [
    ("radius", Role::Radius),
    ("pscale", Role::Radius),
    ("width", Role::Width),
    ("diameter", Role::Width),
    ("rotation", Role::Rotation),
    ("rot", Role::Rotation),
    ("amount", Role::Amount),
    ("alpha", Role::Amount),
    ("opacity", Role::Amount),
    ("age", Role::Age),
    ("life", Role::Life),
    ("id", Role::Id),
];

/// What stands before the x, y and z, or 0, 1 and 2, of a position.
const POSITION: [&str; 5] = ["", "p", "pos", "position", "location"];

/// What a column of this name is for, and how soon it is taken among several.
pub fn role(name: &str) -> Option<(usize, Role)> {
    let name: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    if let Some(found) = NAMES.iter().position(|(known, _)| *known == name) {
        return Some((found, NAMES[found].1));
    }
    let (stem, axis) = name.split_at_checked(name.len().checked_sub(1)?)?;
    let rank = POSITION.iter().position(|known| *known == stem)?;
    let role = match axis {
        "x" => Role::X,
        "y" => Role::Y,
        "z" => Role::Z,
        "0" if !stem.is_empty() => Role::X,
        "1" if !stem.is_empty() => Role::Y,
        "2" if !stem.is_empty() => Role::Z,
        _ => return None,
    };
    Some((rank, role))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_columns_are_for_nothing() {
        for name in ["nx", "0", "vx", "Cd[0]", "scale", "", "ä"] {
            assert_eq!(role(name), None, "{name}");
        }
    }
}
