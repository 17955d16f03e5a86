//! Which lights are selected, alone or silent: how they are looked at, no part of the preset.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use haze::frame::MAX_LIGHTS;
use haze::{Light, LightKind};

/// What is remembered of the lights of a preset, by their places.
#[derive(Clone, Debug, Default)]
pub struct ShownLights {
    pub selected: Option<usize>,
    /// The light that leads, for each system, once it is chosen.
    keys: Vec<Option<usize>>,
    /// All lights are sent round.
    pub turn: Option<Turn>,
    entries: Vec<Entry>,
}

/// The lights go round a vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// A point of the axis.
    pub middle: Vec3,
    /// Radians from where the preset has them.
    pub angle: f32,
}

/// Seconds of a turn.
const TURN: f32 = 5.0;

impl Turn {
    /// Goes on by the seconds that have passed.
    pub fn advance(&mut self, seconds: f32) {
        self.angle = (self.angle + seconds * TAU / TURN).rem_euclid(TAU);
    }

    /// The light as it stands by now.
    pub fn turned(&self, light: &Light) -> Light {
        let turn = Quat::from_rotation_y(self.angle);
        let position = self.middle + turn * (light.position - self.middle);
        Light { position, direction: turn * light.direction, ..*light }
    }
}

/// What a light is called wherever lights are listed, by its place among them.
pub fn name_of(index: usize, light: &Light) -> String {
    let number = index + 1;
    match light.kind {
        LightKind::Directional => format!("sun {number}"),
        kind => format!("lamp {number} ({})", kind.name()),
    }
}

/// A light to be added, about as bright as others of its kind.
pub fn fresh(kind: LightKind, lights: &[Light]) -> Light {
    let usual = if kind == LightKind::Directional { 1.0 } else { 10.0 };
    let alike = lights.iter().find(|light| light.kind == kind);
    Light { kind, intensity: alike.map_or(usual, |light| light.intensity), ..Light::default() }
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    /// As it was when it was last looked at: to know it again when others come and go.
    light: Light,
    marks: Marks,
}

/// What is marked of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// Left out of the picture.
    pub is_muted: bool,
    /// If any light is, only those are in the picture.
    pub is_solo: bool,
}

impl ShownLights {
    /// Keeps up with what happened to the lights, by undo or another preset.
    pub fn follow(&mut self, lights: &[Light]) {
        let entry = |&light| Entry { light, marks: Marks::default() };
        let (old, new) = (self.entries.len(), lights.len());
        if old != new {
            // What is alike at both ends stays what it was.
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

    /// What is known by its place has another, or none.
    fn renumber(&mut self, place: impl Fn(usize) -> Option<usize>) {
        self.selected = self.selected.and_then(&place);
        self.keys.iter_mut().for_each(|key| *key = key.and_then(&place));
    }

    /// The light that leads a system: chosen once, and kept as long as it is there.
    pub fn key(&mut self, system: usize, choose: impl FnOnce() -> Option<usize>) -> Option<usize> {
        self.keys.resize(self.keys.len().max(system + 1), None);
        let key = &mut self.keys[system];
        *key = key.or_else(choose);
        *key
    }

    /// The light that leads a system, once it is chosen.
    pub fn known_key(&self, system: usize) -> Option<usize> {
        self.keys.get(system).copied().flatten()
    }

    /// Chooses leading lights anew: the preset is another.
    pub fn forget_keys(&mut self) {
        self.keys.clear();
    }

    /// The marks of a light, to be changed.
    pub fn marks(&mut self, index: usize) -> Option<&mut Marks> {
        self.entries.get_mut(index).map(|entry| &mut entry.marks)
    }

    /// Whether a light is in the picture.
    pub fn is_shown(&self, index: usize) -> bool {
        let has_solo = self.has_solo();
        self.entries.get(index).is_none_or(|Entry { marks, .. }| if has_solo { marks.is_solo } else { !marks.is_muted })
    }

    /// The lights that are in the picture, as they are there.
    pub fn shown(&self, lights: &[Light]) -> Vec<Light> {
        (0..).zip(lights).filter(|(index, _)| self.is_shown(*index)).map(|(_, light)| self.turned(light)).collect()
    }

    /// The names of those that are in the picture, in their order there.
    pub fn shown_names(&self, lights: &[Light]) -> Vec<String> {
        let mut of_these = self.clone();
        of_these.follow(lights);
        let shown = (0..).zip(lights).filter(|(index, _)| of_these.is_shown(*index));
        shown.map(|(index, light)| name_of(index, light)).collect()
    }

    /// The same of another preset's lights, which are known by their places, and by what is alike at both ends of the lists.
    pub fn shown_of(&self, others: &[Light]) -> Vec<Light> {
        let mut of_others = self.clone();
        of_others.follow(others);
        // One that is alone and not there leaves none.
        if self.has_solo() && !of_others.has_solo() { Vec::new() } else { of_others.shown(others) }
    }

    fn has_solo(&self) -> bool {
        self.entries.iter().any(|entry| entry.marks.is_solo)
    }

    /// A light where the turn has taken it.
    pub fn turned(&self, light: &Light) -> Light {
        self.turn.map_or(*light, |turn| turn.turned(light))
    }

    /// Adds a light at a place in the list, and selects it; not beyond what a frame may have.
    pub fn insert(&mut self, lights: &mut Vec<Light>, index: usize, light: Light) {
        if lights.len() < MAX_LIGHTS {
            self.follow(lights);
            lights.insert(index, light);
            self.renumber(|place| Some(place + usize::from(place >= index)));
            self.entries.insert(index, Entry { light, marks: Marks::default() });
            self.selected = Some(index);
        }
    }

    /// Adds a twin of a light after it, and selects it.
    pub fn duplicate(&mut self, lights: &mut Vec<Light>, index: usize) {
        if let Some(&light) = lights.get(index) {
            self.insert(lights, index + 1, light);
        }
    }

    /// Takes a light away; the next one is not selected in its place.
    pub fn remove(&mut self, lights: &mut Vec<Light>, index: usize) {
        if index < lights.len() {
            self.follow(lights);
            lights.remove(index);
            self.entries.remove(index);
            self.renumber(|place| (place != index).then(|| place - usize::from(place > index)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lights(intensities: &[f32]) -> Vec<Light> {
        intensities.iter().map(|&intensity| Light { intensity, ..Light::default() }).collect()
    }

    fn muted(shown: &ShownLights) -> Vec<usize> {
        (0..shown.entries.len()).filter(|&index| shown.entries[index].marks.is_muted).collect()
    }

    #[test]
    fn marks_stay_with_their_lights() {
        let mut all = lights(&[1.0, 2.0, 3.0]);
        let mut shown = ShownLights::default();
        shown.follow(&all);
        shown.marks(1).unwrap().is_muted = true;
        shown.selected = Some(2);
        shown.remove(&mut all, 0);
        assert_eq!((muted(&shown), shown.selected), (vec![0], Some(1)));
        shown.insert(&mut all, 0, Light::default());
        assert_eq!((muted(&shown), shown.selected), (vec![1], Some(0)));
        // Undone elsewhere: the one that was added goes, then the first that was there comes back.
        shown.follow(&lights(&[2.0, 3.0]));
        assert_eq!((muted(&shown), shown.selected), (vec![0], None));
        shown.selected = Some(0);
        shown.follow(&lights(&[1.0, 2.0, 3.0]));
        assert_eq!((muted(&shown), shown.selected), (vec![1], Some(1)));
        // A twin is told from the one it was made of.
        let mut twins = lights(&[1.0, 2.0, 3.0]);
        shown.duplicate(&mut twins, 1);
        shown.remove(&mut twins, 1);
        assert_eq!((muted(&shown), shown.selected), (vec![], Some(1)));
    }

    #[test]
    fn the_light_that_leads_stays_the_one_it_was() {
        let mut all = lights(&[1.0, 2.0, 3.0]);
        let mut shown = ShownLights::default();
        shown.follow(&all);
        assert_eq!((shown.key(0, || Some(1)), shown.key(1, || Some(2))), (Some(1), Some(2)));
        shown.insert(&mut all, 0, Light::default());
        assert_eq!((shown.key(0, || Some(0)), shown.key(1, || Some(0))), (Some(2), Some(3)));
        shown.remove(&mut all, 2);
        assert_eq!((shown.key(0, || Some(0)), shown.key(1, || Some(0))), (Some(0), Some(2)));
        shown.forget_keys();
        assert_eq!(shown.key(1, || Some(1)), Some(1));
    }

    #[test]
    fn names_tell_kind_and_place_of_what_is_in_the_picture() {
        let mut all = lights(&[1.0, 2.0, 3.0]);
        (all[0].kind, all[2].kind) = (LightKind::Directional, LightKind::Spot);
        let mut shown = ShownLights::default();
        shown.follow(&all);
        assert_eq!(shown.shown_names(&all), ["sun 1", "lamp 2 (point)", "lamp 3 (spot)"]);
        shown.marks(0).unwrap().is_muted = true;
        assert_eq!(shown.shown_names(&all), ["lamp 2 (point)", "lamp 3 (spot)"]);
    }

    #[test]
    fn one_alone_silences_the_others() {
        let all = lights(&[1.0, 2.0, 3.0]);
        let mut shown = ShownLights::default();
        shown.follow(&all);
        shown.marks(0).unwrap().is_muted = true;
        assert_eq!(shown.shown(&all), all[1..]);
        shown.marks(2).unwrap().is_solo = true;
        assert_eq!(shown.shown(&all), all[2..]);
    }

    #[test]
    fn the_lights_of_another_preset_are_seen_in_the_same_way() {
        let all = lights(&[1.0, 2.0, 3.0]);
        let mut shown = ShownLights::default();
        shown.follow(&all);
        shown.turn = Some(Turn { middle: Vec3::ZERO, angle: 1.0 });
        shown.marks(1).unwrap().is_muted = true;
        let turned = |of: &[f32]| lights(of).iter().map(|light| shown.turned(light)).collect::<Vec<_>>();
        assert_eq!(shown.shown_of(&lights(&[5.0, 6.0, 7.0])), turned(&[5.0, 7.0]));
        // Without the first, which was added since.
        assert_eq!(shown.shown_of(&lights(&[2.0, 3.0])), turned(&[3.0]));
        let mut alone = shown.clone();
        alone.marks(0).unwrap().is_solo = true;
        assert_eq!(alone.shown_of(&lights(&[5.0, 6.0, 7.0])), turned(&[5.0]));
        assert_eq!(alone.shown_of(&lights(&[2.0, 3.0])), []);
        assert_eq!(alone.shown(&all), turned(&[1.0]), "nothing is changed by looking");
    }

    #[test]
    fn a_turn_keeps_height_and_distance_and_closes() {
        let light =
            Light { position: Vec3::new(3.0, 2.0, 1.0), direction: Vec3::new(0.5, -1.0, 0.2), ..Light::default() };
        let mut turn = Turn { middle: Vec3::new(1.0, 4.0, 0.0), angle: 0.0 };
        assert_eq!(turn.turned(&light), light);
        for step in 1..=50 {
            turn.advance(TURN / 50.0);
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
    fn no_more_lights_than_a_frame_takes() {
        let (mut all, mut shown) = (Vec::new(), ShownLights::default());
        for _ in 0..MAX_LIGHTS + 2 {
            shown.insert(&mut all, 0, Light::default());
        }
        assert_eq!(all.len(), MAX_LIGHTS);
    }
}
