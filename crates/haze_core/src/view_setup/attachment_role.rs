//! Roles of the accumulation target's textures, and the set of roles that a system uses. Both renderers read it.

use crate::error::FieldError;
use crate::settings::Settings;

/// Maximum number of textures of a target: WebGPU guarantees four storage textures per shader, WebGL2 four draw buffers.
/// `MAX_TARGET_ATTACHMENTS` in `shaders/lib/attachments.wgsl`.
pub const MAX_TARGET_ATTACHMENTS: usize = 4;

/// Role of a texture of the accumulation target. The order is that of the textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AttachmentRole {
    /// Sum of premultiplied normals in rgb, amount in a. With six-way maps: light from right, top and front in rgb.
    /// Every system has it.
    NormalAndAmount,
    /// Light from left, bottom and back in rgb, sum of weights in a.
    SixWay,
    /// Sum of the normals' weights.
    Weights,
    /// Weighted optical depths towards three lights in rgb, sum of weights in a.
    OpticalDepths,
    /// Weighted depth, as a fraction of the system's range of depths, and its square, in rg; sum of weights in a.
    Depth,
    /// Weighted heat, and its square, in rg; sum of weights in a.
    Heat,
    /// Weighted color of particles in rgb, sum of weights in a.
    Tint,
}

impl AttachmentRole {
    /// All roles, in order.
    pub const ALL: [Self; 7] =
        [Self::NormalAndAmount, Self::SixWay, Self::Weights, Self::OpticalDepths, Self::Depth, Self::Heat, Self::Tint];

    /// True if a system with these settings has the texture.
    pub fn is_used(self, settings: &Settings) -> bool {
        match self {
            Self::NormalAndAmount => true,
            Self::SixWay => settings.is_six_way(),
            // Six-way light has a sum of weights of its own.
            Self::Weights => settings.accumulate.sums_weights() && !settings.is_six_way(),
            Self::OpticalDepths => settings.receives_shadow(),
            Self::Depth => settings.shadow.by_depth,
            Self::Heat => settings.burns(),
            Self::Tint => settings.is_tinted(),
        }
    }

    /// Setting of these `settings` that adds the texture, and its value, for messages.
    pub fn setting(self, settings: &Settings) -> (&'static str, &'static str) {
        match self {
            Self::NormalAndAmount => ("path", "raster"),
            Self::SixWay => ("lighting", "six_way"),
            Self::Weights => ("accumulate.order", "weighted"),
            Self::OpticalDepths => ("shadow.strength", "1"),
            Self::Depth => ("shadow.by_depth", "true"),
            Self::Heat => ("fire.intensity", "1"),
            Self::Tint if settings.sprite.age_color > 0.0 => ("sprite.age_color", "1"),
            Self::Tint => ("sprite.tint", "1"),
        }
    }
}

/// Set of roles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AttachmentSet(u8);

impl AttachmentSet {
    /// The first texture alone.
    pub const NORMAL_AND_AMOUNT: Self = Self(1);

    /// Returns the roles that a system with these settings uses.
    pub fn of(settings: &Settings) -> Self {
        AttachmentRole::ALL.into_iter().filter(|role| role.is_used(settings)).collect()
    }

    /// Refuses settings that need more textures than every device has. `path` precedes the field's name.
    ///
    /// # Errors
    /// Names the setting that adds the first texture that is too much.
    pub fn validate(settings: &Settings, path: impl Fn() -> String) -> Result<(), FieldError> {
        let excess = Self::of(settings).iter().nth(MAX_TARGET_ATTACHMENTS).filter(|_| !settings.is_forward());
        excess.map_or(Ok(()), |role| {
            let (setting, value) = role.setting(settings);
            let expected = format!(
                "another value, or fewer settings that add textures to the accumulation target: at most \
                 {MAX_TARGET_ATTACHMENTS} fit"
            );
            Err(FieldError::new(format!("{}.{setting}", path()), value, expected))
        })
    }

    /// True if the set has this role.
    pub fn contains(self, role: AttachmentRole) -> bool {
        self.0 & bit(role) != 0
    }

    /// Returns the roles, in order.
    pub fn iter(self) -> impl Iterator<Item = AttachmentRole> {
        AttachmentRole::ALL.into_iter().filter(move |role| self.contains(*role))
    }

    /// Returns the index of a role's texture among those of the set; `None` if the set does not have it.
    pub fn slot(self, role: AttachmentRole) -> Option<usize> {
        self.contains(role).then(|| (self.0 & (bit(role) - 1)).count_ones() as usize)
    }
}

impl FromIterator<AttachmentRole> for AttachmentSet {
    fn from_iter<I: IntoIterator<Item = AttachmentRole>>(roles: I) -> Self {
        Self(roles.into_iter().fold(0, |bits, role| bits | bit(role)))
    }
}

fn bit(role: AttachmentRole) -> u8 {
    1 << role as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_number_the_roles_of_a_set_in_order() {
        for bits in 0..1 << AttachmentRole::ALL.len() {
            let set = AttachmentSet(bits);
            let slots: Vec<_> = set.iter().map(|role| set.slot(role)).collect();
            assert_eq!(slots, (0..slots.len()).map(Some).collect::<Vec<_>>(), "{set:?}");
            assert_eq!(set, set.iter().collect());
            for role in AttachmentRole::ALL {
                assert_eq!(set.slot(role).is_some(), set.contains(role), "{set:?}, {role:?}");
            }
        }
        assert!(AttachmentRole::ALL.iter().enumerate().all(|(index, role)| *role as usize == index));
    }

    #[test]
    fn a_fifth_texture_is_refused_by_name() {
        let mut settings = Settings::default();
        settings.shadow.strength = 1.0;
        settings.shadow.by_depth = true;
        settings.fire.intensity = 1.0;
        settings.sprite.age_color = 1.0;
        let error = AttachmentSet::validate(&settings, || "systems[1].settings".into()).unwrap_err().to_string();
        assert!(error.starts_with("systems[1].settings.sprite.age_color: 1 is not valid"), "{error}");
        settings.shadow.by_depth = false;
        AttachmentSet::validate(&settings, String::new).unwrap();
    }

    #[test]
    fn every_system_has_the_first_texture() {
        assert_eq!(AttachmentSet::of(&Settings::default()), AttachmentSet::NORMAL_AND_AMOUNT);
        assert_eq!(AttachmentSet::NORMAL_AND_AMOUNT, [AttachmentRole::NormalAndAmount].into_iter().collect());
    }
}
