//! Surroundings of the smoke in the demo program.

use std::ffi::OsStr;
use std::path::{Component, Path};

use haze_core::glam::Vec3;

use haze_core::settings::{BackdropKind, choice, settings};

settings! {
    /// Scene around the smoke, and the light of its sky.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Environment {
        /// Scene around the smoke, which hides the smoke and is hidden by it.
        scene: SceneName = SceneName::Yard, choice;
        /// glTF file, instead of the demo scene; empty for none. Its y axis points up.
        scene_file: String = String::new(), backdrop(BackdropKind::Scene);
        /// Metres per unit of the scene file. glTF's unit is the metre. Higher: a larger scene around the same smoke.
        scene_scale: f32 = 1.0, number(1.0e-4..=1.0e4, "m");
        /// Shows the lamp of the yard with its glowing body: a prop for the light that presets put there. The light
        /// itself belongs to the preset and stays.
        lamp: bool = true, flag;
        /// Shows the brazier of the yard with its glowing embers: a prop for smoke, and for the light that presets put
        /// there. The light itself belongs to the preset and stays.
        brazier: bool = true, flag;
        /// Linear RGB of the sky overhead. It lights the scene, not the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        zenith: Vec3 = Vec3::new(0.045, 0.07, 0.14), color(0.0..=100.0);
        /// Linear RGB of the sky at the horizon, behind the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        horizon: Vec3 = Vec3::new(0.22, 0.19, 0.2), color(0.0..=100.0);
        /// Linear RGB of the light that the ground reflects to the undersides of the scene.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        ground: Vec3 = Vec3::new(0.03, 0.028, 0.026), color(0.0..=100.0);
        /// Panorama of all directions, twice as wide as high, instead of the sky's colors behind the smoke; empty for none.
        sky_file: String = String::new(), backdrop(BackdropKind::Sky);
        /// Turns the panorama about the vertical axis, and its light with it.
        sky_rotation: f32 = 0.0, number(-360.0..=360.0, "degrees");
        /// Multiplies the panorama, and its light, by 2^exposure.
        sky_exposure: f32 = 0.0, number(-16.0..=16.0, "EV");
        /// Lights scene and smoke by the panorama: its light replaces `zenith`, `horizon` and `ground`, and the ambient
        /// colors of every system, whose ambient intensity stays. Off: the panorama is a background alone.
        sky_light: bool = true, flag;
    }
}

choice! {
    /// Demo scenes.
    SceneName {
        /// A yard with walls, crates, pillars and a fence.
        #[default]
        Yard = "yard",
        /// A colonnade with a far door.
        Corridor = "corridor",
        /// A floor and a wall of even neutral gray (0.18), and nothing else: for judging light.
        Studio = "studio",
        /// The sky alone.
        Empty = "empty",
    }
}

impl Environment {
    /// Name of the file of a backdrop, to be changed.
    pub fn backdrop_name_mut(&mut self, kind: BackdropKind) -> &mut String {
        match kind {
            BackdropKind::Scene => &mut self.scene_file,
            BackdropKind::Sky => &mut self.sky_file,
        }
    }
}

/// File that the name of a backdrop stands for, relative to the preset's folder. `None` if it has another ending or lies
/// outside.
pub fn backdrop_file_path(name: &str, kind: BackdropKind) -> Option<&Path> {
    let path = Path::new(name);
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (stays && backdrop_kind(path) == Some(kind)).then_some(path)
}

/// Endings of the files of a kind: glTF scenes, panoramas.
pub const fn backdrop_endings(kind: BackdropKind) -> [&'static str; 2] {
    match kind {
        BackdropKind::Scene => ["glb", "gltf"],
        BackdropKind::Sky => ["hdr", "exr"],
    }
}

/// Kind of a file by the ending of its name.
pub fn backdrop_kind(path: &Path) -> Option<BackdropKind> {
    let ending = path.extension().and_then(OsStr::to_str)?;
    let has_it = |kind: &BackdropKind| backdrop_endings(*kind).iter().any(|known| ending.eq_ignore_ascii_case(known));
    BackdropKind::ALL.into_iter().find(has_it)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backdrops_stay_inside_the_presets_folder_and_have_the_ending_of_their_kind() {
        use BackdropKind::{Scene, Sky};
        for (name, kind) in [("a.glb", Scene), ("yard/b.GLTF", Scene), ("./c.hdr", Sky), ("d.exr", Sky)] {
            assert_eq!(backdrop_file_path(name, kind), Some(Path::new(name)));
            assert_eq!(backdrop_kind(Path::new(name)), Some(kind));
        }
        for (name, kind) in [("", Scene), ("../a.glb", Scene), ("/a.glb", Scene), ("a.hdr", Scene), ("a.png", Sky)] {
            assert_eq!(backdrop_file_path(name, kind), None, "{name}");
        }
    }
}
