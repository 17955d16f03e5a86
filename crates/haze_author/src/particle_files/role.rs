//! Roles of columns, recognised by the names that other programs use.

/// The particle attribute that a column holds.
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

/// Number of roles.
pub const ROLE_COUNT: usize = Role::Id as usize + 1;

/// Column names in lower case, letters and digits only. If a file has two columns for a role, the name listed first is
/// read.
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

/// Prefixes of a position's axis (x, y, z or 0, 1, 2), in order of preference.
const POSITION: [&str; 5] = ["", "p", "pos", "position", "location"];

/// Returns the role of a column by its name, with its rank: of several columns for a role the lowest rank is read.
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
    fn other_columns_have_no_role() {
        for name in ["nx", "0", "vx", "Cd[0]", "scale", "", "ä"] {
            assert_eq!(role(name), None, "{name}");
        }
    }
}
