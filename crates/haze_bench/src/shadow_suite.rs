//! Suite `shadow`: smoke that shades smoke, by number of lights, resolution of the grid, and path.

use glam::{UVec2, Vec3};
use haze::{Light, LightKind};
use haze_core::error::Error;
use haze_core::formula::shadow::SHADOWED_LIGHTS;
use haze_core::settings::{RenderPath, Settings};
use haze_demo::shot::Shot;

use super::sprite_shots::crowd;
use super::suite::{Case, Group, Suite, at_scale, changed, full_resolution};

/// Returns a group for each path: without shadow, with lights at the sprites, and with further lights by depth; then the
/// resolutions of the grid.
pub fn groups(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let mut shot = crowd(size)?;
    shot.preset.lights = lights();
    let paths = [RenderPath::Raster, RenderPath::Tiled];
    Ok(paths.into_iter().map(|path| group(&shot, path, quick)).collect())
}

/// A sun, and lamps around the smoke: as many as can cast shadow.
fn lights() -> Vec<Light> {
    let sun = Light {
        kind: LightKind::Directional,
        direction: Vec3::new(0.4, -1.0, -0.2),
        specular_scatter: 0.0,
        ..Light::default()
    };
    let lamp = |index: u32| {
        let angle = index as f32 * 2.4;
        let position =
            Vec3::new(-3.05, 1.2, 0.5) + Vec3::new(angle.cos(), 0.4 * (angle * 0.7).sin(), angle.sin()) * 2.5;
        Light { position, intensity: 1.0, range: 50.0, specular_scatter: 0.0, ..Light::default() }
    };
    std::iter::once(sun).chain((1..SHADOWED_LIGHTS as u32).map(lamp)).collect()
}

fn group(shot: &Shot, path: RenderPath, quick: bool) -> Group {
    let path_name = path.name();
    let case = |name: &str, lights: usize, change: &dyn Fn(&mut Settings)| {
        let mut shot = changed(shot, |settings| {
            at_scale(path, 2)(settings);
            change(settings);
        });
        shot.preset.lights.truncate(lights);
        Case { name: format!("{path_name} {name}"), shot, work: (format!("shadow {path_name}"), 1.0) }
    };
    let shaded = |settings: &mut Settings| settings.shadow.strength = 1.0;
    let by_depth = |settings: &mut Settings| {
        shaded(settings);
        settings.shadow.by_depth = true;
    };
    let mut cases = vec![
        case("3 lights without shadow", 3, &|_| {}),
        case("3 lights", 3, &shaded),
        case("3 lights by depth", 3, &by_depth),
    ];
    for count in [4, 15] {
        cases.push(case(&format!("{count} lights without shadow"), count, &|_| {}));
        cases.push(case(&format!("{count} lights by depth"), count, &|settings| {
            by_depth(settings);
            settings.shadow.lights = count as u32;
        }));
    }
    let resolutions: &[u32] = if quick { &[64] } else { &[16, 32, 48, 64, 96] };
    for &cells in resolutions {
        cases.push(case(&format!("3 lights, {cells} cells"), 3, &|settings| {
            shaded(settings);
            settings.shadow.resolution = cells;
        }));
    }
    Group { suite: Suite::Shadow, cases, reference: full_resolution(&changed(shot, shaded)) }
}
