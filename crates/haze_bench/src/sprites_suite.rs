//! Suite `sprites`: what each value that sprites carry costs, by path.

use glam::UVec2;
use haze_core::error::Error;
use haze_core::settings::{RenderPath, Settings};
use haze_demo::shot::Shot;

use super::sprite_shots::crowd;
use super::suite::{Case, Group, Suite, at_scale, changed, full_resolution};

type Change = (&'static str, fn(&mut Settings));

const CHANGES: &[Change] = &[
    ("normals", |_| {}),
    ("tint", |s| s.sprite.tint = 1.0),
    ("heat", |s| s.fire.intensity = 4.0),
    ("tint and heat", |s| (s.sprite.tint, s.fire.intensity) = (1.0, 4.0)),
    ("stretch", |s| s.sprite.stretch = 0.1),
    ("grain, 1 octave", |s| (s.grain.erosion, s.grain.bump, s.grain.octaves) = (0.5, 1.0, 1)),
    ("grain, 2 octaves", |s| (s.grain.erosion, s.grain.bump, s.grain.octaves) = (0.5, 1.0, 2)),
    ("grain, 3 octaves", |s| (s.grain.erosion, s.grain.bump, s.grain.octaves) = (0.5, 1.0, 3)),
];

/// Returns a group for each path.
pub fn groups(size: UVec2) -> Result<Vec<Group>, Error> {
    let shot = crowd(size)?;
    Ok([RenderPath::Raster, RenderPath::Tiled].into_iter().map(|path| group(&shot, path)).collect())
}

fn group(shot: &Shot, path: RenderPath) -> Group {
    let case = |&(name, change): &Change| Case {
        name: format!("{} {name}", path.name()),
        shot: changed(shot, |settings| {
            at_scale(path, 2)(settings);
            change(settings);
        }),
        work: (format!("sprites {}", path.name()), 1.0),
    };
    Group { suite: Suite::Sprites, cases: CHANGES.iter().map(case).collect(), reference: full_resolution(shot) }
}
