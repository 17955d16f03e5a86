//! Names of the settings that tracks can change, and the nearest one to a wrong name.

use haze_core::settings::{Fields, field_path};

use super::animated_fields::for_each_animated_field;
use crate::asset_folders::MIN_SIMILARITY;

/// Name of the setting that is most like a wrong name: in its last part, and then as a whole.
pub(super) fn nearest(wrong: &str, fields: &mut dyn Fields) -> Option<String> {
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    let wanted = last(wrong);
    let mut nearest = None::<((f64, f64), String)>;
    for_each_animated_field(fields, &mut |path, field| {
        let name = field_path(path);
        let alike = (strsim::jaro_winkler(&wanted, &last(&name)), strsim::jaro_winkler(wrong, &name));
        let is_nearer = nearest.as_ref().is_none_or(|(best, _)| alike > *best);
        if field.kind().is_some() && alike.0 >= MIN_SIMILARITY && is_nearer {
            nearest = Some((alike, name));
        }
    });
    nearest.map(|(_, name)| name)
}
