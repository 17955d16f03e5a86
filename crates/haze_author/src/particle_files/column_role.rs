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
    Id,
}

/// Number of roles.
pub const ROLE_COUNT: usize = ColumnRole::Id as usize + 1;

/// Column names in lower case, letters and digits only. If a file has two columns for a role, the name listed first is
/// read.
const NAMES: [(&str, ColumnRole); 12] = [
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
    ("id", ColumnRole::Id),
];

/// Prefixes of a position's axis (x, y, z or 0, 1, 2), in order of preference.
const POSITION: [&str; 5] = ["", "p", "pos", "position", "location"];

/// Returns the role of a column by its name, with its rank: of several columns for a role the lowest rank is read.
pub fn column_role(name: &str) -> Option<(usize, ColumnRole)> {
    let name: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    if let Some(found) = NAMES.iter().position(|(known, _)| *known == name) {
        return Some((found, NAMES[found].1));
    }
    let (stem, axis) = name.split_at_checked(name.len().checked_sub(1)?)?;
    let rank = POSITION.iter().position(|known| *known == stem)?;
    let role = match axis {
        "x" => ColumnRole::X,
        "y" => ColumnRole::Y,
        "z" => ColumnRole::Z,
        "0" if !stem.is_empty() => ColumnRole::X,
        "1" if !stem.is_empty() => ColumnRole::Y,
        "2" if !stem.is_empty() => ColumnRole::Z,
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
            assert_eq!(column_role(name), None, "{name}");
        }
    }
}
