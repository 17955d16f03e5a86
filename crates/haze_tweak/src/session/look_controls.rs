//! Controls of the look tab: their names for artists, and the settings that they change.

use haze_preset::PresetSystem;

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

/// Controls of one part of a look. Names differ from those of tabs.
pub struct LookSection {
    pub name: &'static str,
    /// True for a system that has this part.
    applies_to: fn(&PresetSystem) -> bool,
    pub controls: &'static [LookControl],
}

/// All controls, in the order of the tab.
pub const LOOK_SECTIONS: &[LookSection] = &[
    LookSection {
        name: "fire",
        applies_to: |system| system.settings.burns(),
        controls: &[
            control("fire", ControlTarget::System("settings.fire.intensity", Some((0.0, 20.0)))),
            control("dark edges", ControlTarget::System("settings.fire.core", None)),
            control("soot", ControlTarget::System("settings.fire.crust", None)),
            control("light of the fire", ControlTarget::System("settings.fire.light", Some((0.0, 4.0)))),
            control("flicker", ControlTarget::System("settings.fire.flicker", None)),
            control("shimmer", ControlTarget::Camera("heat_haze", None)),
        ],
    },
    LookSection {
        name: "shape and light",
        applies_to: |_| true,
        controls: &[
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
            control("tonemap", ControlTarget::Camera("tonemap", None)),
            control("bloom", ControlTarget::Camera("bloom", Some((0.0, 0.5)))),
        ],
    },
    LookSection {
        name: "grain",
        applies_to: |system| system.settings.grain_octaves() > 0,
        controls: &[
            control("torn edges", ControlTarget::System("settings.grain.erosion", None)),
            control("torn with age", ControlTarget::System("settings.grain.dissolve", None)),
            control("lumps", ControlTarget::System("settings.grain.bump", None)),
            control("fineness", ControlTarget::System("settings.grain.tiles", Some((0.5, 8.0)))),
        ],
    },
    LookSection {
        name: "streaks",
        applies_to: |system| system.settings.sprite.stretch > 0.0,
        controls: &[
            control("streak length", ControlTarget::System("settings.sprite.stretch", Some((0.0, 0.2)))),
            control("longest streak", ControlTarget::System("settings.sprite.stretch_limit", Some((1.0, 16.0)))),
        ],
    },
    LookSection {
        name: "ambient",
        applies_to: |system| system.settings.ambient.intensity > 0.0,
        controls: &[
            control("ambient light", ControlTarget::System("settings.ambient.intensity", Some((0.0, 2.0)))),
            control("from above", ControlTarget::System("settings.ambient.sky_color", None)),
            control("from below", ControlTarget::System("settings.ambient.ground_color", None)),
        ],
    },
];

impl LookSection {
    /// True if a system has this part, or if one of its controls has changed: a slider that reaches 0 stays.
    pub fn is_shown(&self, system: &PresetSystem, index: usize, is_changed: impl Fn(&str) -> bool) -> bool {
        let mut paths = self.controls.iter().filter_map(|control| control.path(index, None));
        (self.applies_to)(system) || paths.any(|path| is_changed(&path))
    }
}

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
