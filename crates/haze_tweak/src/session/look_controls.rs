//! Controls of the look tab: their names for artists, and the settings that they change.

use super::macro_param::{MacroParam, SOFTNESS, THICKNESS, WIND};
use super::slider_range::UsualRange;

/// Control of the look tab.
pub struct LookControl {
    pub name: &'static str,
    pub target: ControlTarget,
}

/// Target of a control: a field by its relative path with the usual range of its slider, or a value made of several
/// fields.
#[derive(Clone, Copy)]
pub enum ControlTarget {
    System(&'static str, UsualRange),
    KeyLight(&'static str, UsualRange),
    Camera(&'static str, UsualRange),
    Macro(&'static MacroParam),
}

const fn control(name: &'static str, target: ControlTarget) -> LookControl {
    LookControl { name, target }
}

const fn param(param: &'static MacroParam) -> LookControl {
    control(param.name, ControlTarget::Macro(param))
}

/// All controls, in the order of the tab.
pub const LOOK_CONTROLS: &[LookControl] = &[
    control("size", ControlTarget::System("emitter.size", Some((0.1, 4.0)))),
    param(&THICKNESS),
    control("size at birth", ControlTarget::System("emitter.radius_start", Some((0.0, 1.5)))),
    control("size at death", ControlTarget::System("emitter.radius_end", Some((0.0, 4.0)))),
    control("rise", ControlTarget::System("emitter.buoyancy", Some((-1.0, 3.0)))),
    param(&WIND),
    control("turbulence", ControlTarget::System("emitter.turbulence", Some((0.0, 3.0)))),
    control("swirl size", ControlTarget::System("emitter.turbulence_scale", Some((0.1, 6.0)))),
    param(&SOFTNESS),
    control("key light", ControlTarget::KeyLight("intensity", Some((0.0, 100.0)))),
    control("shadow", ControlTarget::System("settings.shadow.strength", None)),
    control("scatter color", ControlTarget::System("settings.soft_scatter.scatter_color", None)),
    control("glow", ControlTarget::System("settings.specular_scatter.intensity", Some((0.0, 4.0)))),
    control("exposure", ControlTarget::Camera("exposure", Some((-4.0, 4.0)))),
];

impl LookControl {
    /// Returns the path of the target in the preset. `key` is the index of the system's key light.
    pub fn path(&self, system: usize, key: Option<usize>) -> Option<String> {
        Some(match self.target {
            ControlTarget::System(path, _) => format!("systems[{system}].{path}"),
            ControlTarget::KeyLight(path, _) => format!("lights[{}].{path}", key?),
            ControlTarget::Camera(path, _) => format!("camera.{path}"),
            ControlTarget::Macro(param) => param.path(system),
        })
    }
}
