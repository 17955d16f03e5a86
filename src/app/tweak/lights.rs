//! Which lights are selected, alone or silent: how they are looked at, no part of the preset.

use haze::Light;
use haze::frame::MAX_LIGHTS;

/// What is remembered of the lights of a preset, by their places.
#[derive(Clone, Debug, Default)]
pub struct ShownLights {
    pub selected: Option<usize>,
    entries: Vec<Entry>,
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
            self.selected = self.selected.and_then(|index| match index {
                _ if index < start => Some(index),
                _ if index >= old - end => Some(index + new - old),
                _ => None,
            });
        }
        for (entry, light) in self.entries.iter_mut().zip(lights) {
            entry.light = *light;
        }
    }

    /// The marks of a light, to be changed.
    pub fn marks(&mut self, index: usize) -> Option<&mut Marks> {
        self.entries.get_mut(index).map(|entry| &mut entry.marks)
    }

    /// Whether a light is in the picture.
    pub fn is_shown(&self, index: usize) -> bool {
        let is_any_solo = self.entries.iter().any(|entry| entry.marks.is_solo);
        self.entries
            .get(index)
            .is_none_or(|Entry { marks, .. }| if is_any_solo { marks.is_solo } else { !marks.is_muted })
    }

    /// The lights that are in the picture.
    pub fn shown(&self, lights: &[Light]) -> Vec<Light> {
        (0..).zip(lights).filter(|(index, _)| self.is_shown(*index)).map(|(_, light)| *light).collect()
    }

    /// Adds a light at a place in the list, and selects it; not beyond what a frame may have.
    pub fn insert(&mut self, lights: &mut Vec<Light>, index: usize, light: Light) {
        if lights.len() < MAX_LIGHTS {
            self.follow(lights);
            lights.insert(index, light);
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
            self.selected = self.selected.filter(|&selected| selected != index);
            self.selected = self.selected.map(|selected| selected - usize::from(selected > index));
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
    fn no_more_lights_than_a_frame_takes() {
        let (mut all, mut shown) = (Vec::new(), ShownLights::default());
        for _ in 0..MAX_LIGHTS + 2 {
            shown.insert(&mut all, 0, Light::default());
        }
        assert_eq!(all.len(), MAX_LIGHTS);
    }
}
