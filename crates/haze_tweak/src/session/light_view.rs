//! View state of lights: selection, mute, solo, turn. It is not part of the preset.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use haze::{Light, LightKind, LightRole};
use haze_core::frame::MAX_LIGHTS;
use haze_demo::LAMP_HEAD;
use haze_preset::Preset;

use crate::document::keyframes::{copy_light_tracks, renumber_lights};
use crate::document::light_defaults::light_name;
use crate::document::light_roles;

/// View state of a preset's lights, by their indices.
#[derive(Clone, Debug, Default)]
pub struct LightView {
    pub selected: Option<usize>,
    /// System and light whose slider is being moved on the Look tab.
    held_key: Option<(usize, usize)>,
    /// Set while all lights rotate about the smoke.
    pub turn: Option<LightTurn>,
    entries: Vec<LightEntry>,
}

/// Rotation of the lights about a vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightTurn {
    /// Point on the axis.
    pub middle: Vec3,
    /// Angle from the positions in the preset, radians.
    pub angle: f32,
}

/// Distance from the yard's lamp within which a light is that of the lamp, metres.
const NEAR_LAMP: f32 = 0.3;

/// Duration of one turn, seconds.
const TURN_SECONDS: f32 = 5.0;

impl LightTurn {
    /// Advances by the elapsed seconds.
    pub fn advance(&mut self, seconds: f32) {
        self.angle = (self.angle + seconds * TAU / TURN_SECONDS).rem_euclid(TAU);
    }

    /// Returns a light rotated by the present angle.
    pub fn turned(&self, light: &Light) -> Light {
        let turn = Quat::from_rotation_y(self.angle);
        let position = self.middle + turn * (light.position - self.middle);
        Light { position, direction: turn * light.direction, ..*light }
    }
}

#[derive(Clone, Copy, Debug)]
struct LightEntry {
    /// The light as it was last seen, to recognise it when lights are added or removed.
    light: Light,
    mute_solo: MuteSolo,
}

/// Mute and solo flags of a light or a system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MuteSolo {
    /// It is left out of the image.
    pub is_muted: bool,
    /// If any is solo, only those are in the image.
    pub is_solo: bool,
}

impl LightView {
    /// Follows changes of the list of lights, by undo or by another preset.
    pub fn follow(&mut self, lights: &[Light]) {
        let entry = |&light| LightEntry { light, mute_solo: MuteSolo::default() };
        let old = self.entries.len();
        let new = lights.len();
        if old != new {
            // Lights that are equal at either end of the list keep their state.
            let pairs = self.entries.iter().zip(lights);
            let start = pairs.take_while(|(entry, light)| entry.light == **light).count();
            let pairs = self.entries[start..].iter().rev().zip(lights[start..].iter().rev());
            let end = pairs.take_while(|(entry, light)| entry.light == **light).count();
            self.entries.splice(start..old - end, lights[start..new - end].iter().map(entry));
            self.renumber(|index| match index {
                _ if index < start => Some(index),
                _ if index >= old - end => Some(index + new - old),
                _ => None,
            });
        }
        for (entry, light) in self.entries.iter_mut().zip(lights) {
            entry.light = *light;
        }
    }

    /// Gives all stored indices their new values; `None` removes an index.
    fn renumber(&mut self, position: impl Fn(usize) -> Option<usize>) {
        self.selected = self.selected.and_then(&position);
        self.held_key = self.held_key.and_then(|(system, index)| Some((system, position(index)?)));
    }

    /// Returns the preset's key light, or else the light in the image that is brightest at the emitter of a system.
    pub fn key_light(&self, preset: &Preset, system: usize) -> Option<usize> {
        let brightest = || {
            let position = preset.systems.get(system)?.emitter.position;
            let shown = (0..).zip(&preset.lights).filter(|(index, _)| self.is_shown(*index));
            let brightness = |light: &Light| light_roles::brightness_at(light, position);
            shown.max_by(|a, b| brightness(a.1).total_cmp(&brightness(b.1))).map(|(index, _)| index)
        };
        light_roles::key_light(&preset.lights).or_else(brightest)
    }

    /// Returns the light that the key light's slider drives. While the slider is held, it stays with its light, even if
    /// another becomes the brightest.
    pub fn held_key_light(&mut self, preset: &Preset, system: usize, is_held: bool) -> Option<usize> {
        let held = self.held_key.filter(|(of, index)| is_held && *of == system && *index < preset.lights.len());
        let index = held.map(|(_, index)| index).or_else(|| self.key_light(preset, system));
        self.held_key = index.map(|index| (system, index));
        index
    }

    /// Returns the flags of a light, for changing them.
    pub fn mute_solo(&mut self, index: usize) -> Option<&mut MuteSolo> {
        self.entries.get_mut(index).map(|entry| &mut entry.mute_solo)
    }

    /// Returns true if a light is in the image.
    pub fn is_shown(&self, index: usize) -> bool {
        let has_solo = self.has_solo();
        self.entries
            .get(index)
            .is_none_or(|LightEntry { mute_solo, .. }| if has_solo { mute_solo.is_solo } else { !mute_solo.is_muted })
    }

    /// Returns the lights that are in the image, turned.
    pub fn shown(&self, lights: &[Light]) -> Vec<Light> {
        (0..).zip(lights).filter(|(index, _)| self.is_shown(*index)).map(|(_, light)| self.turned(light)).collect()
    }

    /// Leaves only the lights that are in the image, turned, with their tracks.
    pub fn apply(&self, preset: &mut Preset) {
        let count = preset.lights.len();
        preset.lights = self.shown(&preset.lights);
        let shown: Vec<_> = (0..count).filter(|index| self.is_shown(*index)).collect();
        renumber_lights(&mut preset.animation, |index| shown.iter().position(|other| *other == index));
    }

    /// Returns the names of the lights that are in the image, in the same order.
    pub fn shown_names(&self, lights: &[Light]) -> Vec<String> {
        let mut of_these = self.clone();
        of_these.follow(lights);
        let shown = (0..).zip(lights).filter(|(index, _)| of_these.is_shown(*index));
        shown.map(|(index, light)| light_name(index, light)).collect()
    }

    /// Returns the lights of another preset that are in its image. They are matched by index, and by equality at the
    /// ends of the lists.
    pub fn shown_of_preset(&self, others: &[Light]) -> Vec<Light> {
        let mut of_others = self.clone();
        of_others.follow(others);
        // If the solo light does not exist there, no light is in the image.
        if self.has_solo() && !of_others.has_solo() { Vec::new() } else { of_others.shown(others) }
    }

    fn has_solo(&self) -> bool {
        self.entries.iter().any(|entry| entry.mute_solo.is_solo)
    }

    /// Returns a light as the turn has moved it.
    pub fn turned(&self, light: &Light) -> Light {
        self.turn.map_or(*light, |turn| turn.turned(light))
    }

    /// Inserts a light and selects it, unless there are already [`MAX_LIGHTS`].
    pub fn insert(&mut self, preset: &mut Preset, index: usize, light: Light) {
        if preset.lights.len() < MAX_LIGHTS {
            self.follow(&preset.lights);
            preset.lights.insert(index, light);
            let position = |position| Some(position + usize::from(position >= index));
            self.renumber(position);
            renumber_lights(&mut preset.animation, position);
            self.entries.insert(index, LightEntry { light, mute_solo: MuteSolo::default() });
            self.selected = Some(index);
        }
    }

    /// Inserts a copy of a light after it, with its keyframes, and selects the copy. The copy of a key light has no role.
    pub fn duplicate(&mut self, preset: &mut Preset, index: usize) {
        if let Some(&light) = preset.lights.get(index) {
            let role = if light.role == LightRole::Key { LightRole::None } else { light.role };
            let count = preset.lights.len();
            self.insert(preset, index + 1, Light { role, ..light });
            if preset.lights.len() > count {
                copy_light_tracks(&mut preset.animation, index, index + 1);
            }
        }
    }

    /// Removes a light and its keyframes, and the lamp of the yard with its light. If it was selected, none is selected
    /// afterwards.
    pub fn remove(&mut self, preset: &mut Preset, index: usize) {
        if index < preset.lights.len() {
            self.follow(&preset.lights);
            let removed = preset.lights.remove(index);
            let is_at_lamp =
                |light: &Light| light.kind != LightKind::Directional && light.position.distance(LAMP_HEAD) < NEAR_LAMP;
            if is_at_lamp(&removed) && !preset.lights.iter().any(is_at_lamp) {
                // The lamp of the yard would glow without light.
                preset.environment.lamp = false;
            }
            self.entries.remove(index);
            let position = |position| (position != index).then(|| position - usize::from(position > index));
            self.renumber(position);
            renumber_lights(&mut preset.animation, position);
        }
    }
}

/// Returns the name of a light of the image. `names`: those of the preset's lights, after which come the lights of fires.
pub fn name_in_image(names: &[String], index: usize) -> &str {
    names.get(index).map_or("Fire", String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::preset_diff::step_name;

    fn lights(intensities: &[f32]) -> Vec<Light> {
        intensities.iter().map(|&intensity| Light { intensity, ..Light::default() }).collect()
    }

    fn preset(intensities: &[f32]) -> Preset {
        Preset { lights: lights(intensities), ..Preset::default() }
    }

    fn muted(shown: &LightView) -> Vec<usize> {
        (0..shown.entries.len()).filter(|&index| shown.entries[index].mute_solo.is_muted).collect()
    }

    #[test]
    fn mute_and_solo_stay_with_their_lights() {
        let mut all = preset(&[1.0, 2.0, 3.0]);
        let mut shown = LightView::default();
        shown.follow(&all.lights);
        shown.mute_solo(1).unwrap().is_muted = true;
        shown.selected = Some(2);
        shown.remove(&mut all, 0);
        assert_eq!((muted(&shown), shown.selected), (vec![0], Some(1)));
        shown.insert(&mut all, 0, Light::default());
        assert_eq!((muted(&shown), shown.selected), (vec![1], Some(0)));
        // An undo elsewhere: the added light disappears, then the former first light comes back.
        shown.follow(&lights(&[2.0, 3.0]));
        assert_eq!((muted(&shown), shown.selected), (vec![0], None));
        shown.selected = Some(0);
        shown.follow(&lights(&[1.0, 2.0, 3.0]));
        assert_eq!((muted(&shown), shown.selected), (vec![1], Some(1)));
        // A copy is distinguished from its original.
        let mut twins = preset(&[1.0, 2.0, 3.0]);
        shown.duplicate(&mut twins, 1);
        shown.remove(&mut twins, 1);
        assert_eq!((muted(&shown), shown.selected), (vec![], Some(1)));
    }

    #[test]
    fn the_key_light_is_the_one_with_the_role_or_else_the_brightest_in_the_image() {
        let systems = vec![haze_preset::PresetSystem::default()];
        let mut preset = Preset { lights: lights(&[1.0, 2.0, 3.0]), systems, ..Preset::default() };
        let mut shown = LightView::default();
        shown.follow(&preset.lights);
        assert_eq!(shown.key_light(&preset, 0), Some(2));
        shown.mute_solo(2).unwrap().is_muted = true;
        assert_eq!(shown.key_light(&preset, 0), Some(1));
        preset.lights[0].role = LightRole::Key;
        assert_eq!(shown.key_light(&preset, 0), Some(0));
        // A copy is no second key light.
        shown.duplicate(&mut preset, 0);
        assert_eq!((shown.key_light(&preset, 0), preset.lights[1].role), (Some(0), LightRole::None));
    }

    #[test]
    fn a_held_slider_stays_with_its_light() {
        let systems = vec![haze_preset::PresetSystem::default()];
        let mut preset = Preset { lights: lights(&[1.0, 2.0]), systems, ..Preset::default() };
        let mut shown = LightView::default();
        shown.follow(&preset.lights);
        assert_eq!(shown.held_key_light(&preset, 0, false), Some(1));
        preset.lights[1].intensity = 0.5;
        assert_eq!(shown.held_key_light(&preset, 0, true), Some(1));
        shown.insert(&mut preset, 0, Light { intensity: 0.1, ..Light::default() });
        assert_eq!(shown.held_key_light(&preset, 0, true), Some(2));
        assert_eq!(shown.held_key_light(&preset, 0, false), Some(1));
    }

    #[test]
    fn names_tell_kind_and_index_of_the_lights_in_the_image() {
        let mut all = lights(&[1.0, 2.0, 3.0]);
        all[0].kind = LightKind::Directional;
        all[2].kind = LightKind::Spot;
        all[2].role = LightRole::Rim;
        let mut shown = LightView::default();
        shown.follow(&all);
        assert_eq!(shown.shown_names(&all), ["Sun 1", "Point 2", "Rim (Spot 3)"]);
        shown.mute_solo(0).unwrap().is_muted = true;
        assert_eq!(shown.shown_names(&all), ["Point 2", "Rim (Spot 3)"]);
    }

    #[test]
    fn a_solo_light_mutes_the_others() {
        let all = lights(&[1.0, 2.0, 3.0]);
        let mut shown = LightView::default();
        shown.follow(&all);
        shown.mute_solo(0).unwrap().is_muted = true;
        assert_eq!(shown.shown(&all), all[1..]);
        shown.mute_solo(2).unwrap().is_solo = true;
        assert_eq!(shown.shown(&all), all[2..]);
    }

    #[test]
    fn mute_and_turn_apply_to_the_lights_of_another_preset() {
        let all = lights(&[1.0, 2.0, 3.0]);
        let mut shown = LightView::default();
        shown.follow(&all);
        shown.turn = Some(LightTurn { middle: Vec3::ZERO, angle: 1.0 });
        shown.mute_solo(1).unwrap().is_muted = true;
        let turned = |of: &[f32]| lights(of).iter().map(|light| shown.turned(light)).collect::<Vec<_>>();
        assert_eq!(shown.shown_of_preset(&lights(&[5.0, 6.0, 7.0])), turned(&[5.0, 7.0]));
        // The first light was added since, so it is missing here.
        assert_eq!(shown.shown_of_preset(&lights(&[2.0, 3.0])), turned(&[3.0]));
        let mut alone = shown.clone();
        alone.mute_solo(0).unwrap().is_solo = true;
        assert_eq!(alone.shown_of_preset(&lights(&[5.0, 6.0, 7.0])), turned(&[5.0]));
        assert_eq!(alone.shown_of_preset(&lights(&[2.0, 3.0])), []);
        assert_eq!(alone.shown(&all), turned(&[1.0]), "nothing is changed by looking");
    }

    #[test]
    fn a_full_turn_keeps_height_and_distance_and_ends_at_the_start() {
        let light =
            Light { position: Vec3::new(3.0, 2.0, 1.0), direction: Vec3::new(0.5, -1.0, 0.2), ..Light::default() };
        let mut turn = LightTurn { middle: Vec3::new(1.0, 4.0, 0.0), angle: 0.0 };
        assert_eq!(turn.turned(&light), light);
        for step in 1..=50 {
            turn.advance(TURN_SECONDS / 50.0);
            let turned = turn.turned(&light);
            assert!((turned.position - turn.middle).length() - (light.position - turn.middle).length() < 1e-4);
            assert!((turned.position.y - 2.0).abs() < 1e-5 && (turned.direction.y + 1.0).abs() < 1e-5);
            if step == 25 {
                assert!(turned.position.distance(Vec3::new(-1.0, 2.0, -1.0)) < 1e-4, "{}", turned.position);
            }
        }
        let closed = turn.turned(&light);
        assert!(closed.position.distance(light.position) < 1e-3 && closed.direction.distance(light.direction) < 1e-3);
    }

    #[test]
    fn the_lamp_goes_with_its_light() {
        let mut column = Preset::load("column").unwrap();
        let mut shown = LightView::default();
        shown.remove(&mut column, 0);
        assert!(column.environment.lamp);
        let lamp = column.lights.iter().position(|light| light.position.distance(LAMP_HEAD) < NEAR_LAMP).unwrap();
        shown.duplicate(&mut column, lamp);
        shown.remove(&mut column, lamp);
        assert!(column.environment.lamp, "another light is in it");
        let before = column.clone();
        shown.remove(&mut column, lamp);
        assert!(!column.environment.lamp);
        assert_eq!(step_name(&before, &column), "Light removed");
    }

    #[test]
    fn no_more_lights_are_added_than_a_frame_takes() {
        let mut all = preset(&[]);
        let mut shown = LightView::default();
        for _ in 0..MAX_LIGHTS + 2 {
            shown.insert(&mut all, 0, Light::default());
        }
        assert_eq!(all.lights.len(), MAX_LIGHTS);
    }
}
