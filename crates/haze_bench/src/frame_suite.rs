//! Suite `frame`: the passes of each preset's frame at each scale, on the path that `auto` takes.

use glam::UVec2;
use haze_core::error::Error;
use haze_core::settings::RenderPath;
use haze_demo::shot::Shot;
use haze_preset::builtin;

use super::suite::{Case, Group, Suite, at_scale, changed, full_resolution};

/// Returns a group for each preset. `quick` leaves out the finest and the coarsest scale.
pub fn groups(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let scales: &[u32] = if quick { &[2, 4] } else { &[1, 2, 4, 8] };
    let group = |name: &str| {
        let shot = Shot::load(name, size)?;
        let case = |&scale: &u32| Case {
            name: format!("{name} 1/{scale}"),
            shot: changed(&shot, at_scale(RenderPath::Auto, scale)),
            work: (format!("frame {name}"), 1.0),
        };
        Ok(Group { suite: Suite::Frame, cases: scales.iter().map(case).collect(), reference: full_resolution(&shot) })
    };
    builtin::PRESETS.iter().map(|preset| group(preset.name)).collect()
}
