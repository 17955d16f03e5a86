//! Controls of the look tab: their names for artists, and the settings that they change.

use super::macro_param::{Made, SOFTNESS, THICKNESS, WIND};
use super::slider_range::UsualRange;

/// Control of the look tab.
pub struct Control {
    pub name: &'static str,
    pub of: Of,
}

/// Target of a control: a field by its relative path with the usual range of its slider, or a value made of several
/// fields.
#[derive(Clone, Copy)]
pub enum Of {
    System(&'static str, UsualRange),
    KeyLight(&'static str, UsualRange),
    Camera(&'static str, UsualRange),
    Made(&'static Made),
}

const fn control(name: &'static str, of: Of) -> Control {
    Control { name, of }
}

const fn made(made: &'static Made) -> Control {
    control(made.name, Of::Made(made))
}

/// All controls, in the order of the tab.
pub const LOOK: &[Control] = &[
    made(&THICKNESS),
    control("size at birth", Of::System("emitter.radius_start", Some((0.0, 1.5)))),
    control("size at death", Of::System("emitter.radius_end", Some((0.0, 4.0)))),
    control("rise", Of::System("emitter.buoyancy", Some((-1.0, 3.0)))),
    made(&WIND),
    control("turbulence", Of::System("emitter.turbulence", Some((0.0, 3.0)))),
    control("swirl size", Of::System("emitter.turbulence_scale", Some((0.1, 6.0)))),
    made(&SOFTNESS),
    control("key light", Of::KeyLight("intensity", Some((0.0, 100.0)))),
    control("scatter colour", Of::System("settings.soft_scatter.scatter_colour", None)),
    control("glow", Of::System("settings.specular_scatter.intensity", Some((0.0, 4.0)))),
    control("exposure", Of::Camera("exposure", Some((-4.0, 4.0)))),
];

impl Control {
    /// Returns the path of the target in the preset. `key` is the index of the system's key light.
    pub fn path(&self, system: usize, key: Option<usize>) -> Option<String> {
        Some(match self.of {
            Of::System(path, _) => format!("systems[{system}].{path}"),
            Of::KeyLight(path, _) => format!("lights[{}].{path}", key?),
            Of::Camera(path, _) => format!("camera.{path}"),
            Of::Made(made) => made.path(system),
        })
    }
}
