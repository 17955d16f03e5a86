//! Attributes of particles and the roles of their columns, recognised by the names that other programs use.

/// An attribute of particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attribute {
    Position,
    Velocity,
    Color,
    Radius,
    Rotation,
    Amount,
    Age,
    Life,
    Heat,
    Id,
}

impl Attribute {
    /// Returns the word for the attribute in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Color => "color",
            Self::Radius => "radius",
            Self::Rotation => "rotation",
            Self::Amount => "amount",
            Self::Age => "age",
            Self::Life => "life",
            Self::Heat => "heat",
            Self::Id => "id",
        }
    }
}

/// The value of a particle that a column holds.
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

/// Columns that hold an attribute together: one, or the three of a vector.
pub struct ColumnNames {
    pub roles: &'static [ColumnRole],
    /// Name of each column in lower case, letters and digits only.
    pub names: Vec<String>,
}

/// An attribute of one column.
struct Scalar {
    attribute: Attribute,
    /// Names of columns in order of preference.
    columns: &'static [(&'static str, ColumnRole)],
}

/// An attribute of three columns. A name is a stem and a component.
struct Vector {
    attribute: Attribute,
    roles: &'static [ColumnRole],
    /// In order of preference.
    stems: &'static [&'static str],
    components: &'static [[&'static str; 3]],
}

static VECTORS: [Vector; 3] = [
    Vector {
        attribute: Attribute::Position,
        roles: &[ColumnRole::X, ColumnRole::Y, ColumnRole::Z],
        stems: &["", "p", "pos", "position", "location", "points"],
        components: &[["x", "y", "z"], ["0", "1", "2"]],
    },
    Vector {
        attribute: Attribute::Velocity,
        roles: &[ColumnRole::VelocityX, ColumnRole::VelocityY, ColumnRole::VelocityZ],
        stems: &["v", "vel", "velocity"],
        components: &[["x", "y", "z"], ["0", "1", "2"]],
    },
    Vector {
        attribute: Attribute::Color,
        roles: &[ColumnRole::Red, ColumnRole::Green, ColumnRole::Blue],
        stems: &["", "cd", "color", "col", "rgb", "diffuse"],
        components: &[["red", "green", "blue"], ["r", "g", "b"], ["0", "1", "2"]],
    },
];

static SCALARS: [Scalar; 7] = [
    Scalar {
        attribute: Attribute::Radius,
        columns: &[
            ("radius", ColumnRole::Radius),
            ("pscale", ColumnRole::Radius),
            ("width", ColumnRole::Width),
            ("diameter", ColumnRole::Width),
            // Unless it is the red of a color: `ColumnMap` decides.
            ("r", ColumnRole::Radius),
        ],
    },
    Scalar {
        attribute: Attribute::Rotation,
        columns: &[("rotation", ColumnRole::Rotation), ("rot", ColumnRole::Rotation)],
    },
    Scalar {
        attribute: Attribute::Amount,
        columns: &[("amount", ColumnRole::Amount), ("alpha", ColumnRole::Amount), ("opacity", ColumnRole::Amount)],
    },
    Scalar { attribute: Attribute::Age, columns: &[("age", ColumnRole::Age)] },
    Scalar { attribute: Attribute::Life, columns: &[("life", ColumnRole::Life)] },
    Scalar {
        attribute: Attribute::Heat,
        columns: &[
            ("heat", ColumnRole::Heat),
            ("temperature", ColumnRole::Heat),
            ("flame", ColumnRole::Heat),
            ("burn", ColumnRole::Heat),
        ],
    },
    Scalar { attribute: Attribute::Id, columns: &[("id", ColumnRole::Id)] },
];

/// Returns every attribute with the names that its columns may have, in order of preference.
pub fn attributes() -> impl Iterator<Item = (Attribute, Vec<ColumnNames>)> {
    let vectors = VECTORS.iter().map(|vector| (vector.attribute, vector.names()));
    let names = |(name, role): &'static (&str, ColumnRole)| ColumnNames {
        roles: std::slice::from_ref(role),
        names: vec![(*name).into()],
    };
    let scalars = SCALARS.iter().map(move |scalar| (scalar.attribute, scalar.columns.iter().map(names).collect()));
    vectors.chain(scalars)
}

/// Returns a name as this module compares it: in lower case, letters and digits only, without CloudCompare's prefix
/// `scalar_`.
pub fn plain_name(name: &str) -> String {
    let name: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    match name.strip_prefix("scalar") {
        Some(rest) if !rest.is_empty() => rest.into(),
        _ => name,
    }
}

impl Vector {
    fn names(&self) -> Vec<ColumnNames> {
        let pairs = self.stems.iter().flat_map(|stem| self.components.iter().map(move |components| (stem, components)));
        // A number alone names no component.
        let pairs = pairs.filter(|(stem, components)| !stem.is_empty() || components[0] != "0");
        pairs
            .map(|(stem, components)| ColumnNames {
                roles: self.roles,
                names: components.iter().map(|component| format!("{stem}{component}")).collect(),
            })
            .collect()
    }
}
