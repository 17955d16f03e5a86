//! Selection of stops.

use std::collections::BTreeSet;
use std::ops::Range;

/// Set of selected stops. The fields show one stop, the lead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    lead: usize,
    /// Start of the range that [`Selection::extend_to`] selects.
    anchor: usize,
    /// All selected stops, including the lead.
    all: BTreeSet<usize>,
}

impl Default for Selection {
    fn default() -> Self {
        Self::one(0)
    }
}

impl Selection {
    pub fn one(index: usize) -> Self {
        Self { lead: index, anchor: index, all: [index].into() }
    }

    /// Selects the range from `anchor` to `lead`.
    pub fn between(anchor: usize, lead: usize) -> Self {
        Self { lead, anchor, all: (anchor.min(lead)..=anchor.max(lead)).collect() }
    }

    /// Returns the selection with changed indices.
    pub fn map(&self, mut of: impl FnMut(usize) -> usize) -> Self {
        Self { lead: of(self.lead), anchor: of(self.anchor), all: self.all.iter().map(|index| of(*index)).collect() }
    }

    pub fn lead(&self) -> usize {
        self.lead
    }

    pub fn contains(&self, index: usize) -> bool {
        self.all.contains(&index)
    }

    pub fn iter(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        self.all.iter().copied()
    }

    pub fn count(&self) -> usize {
        self.all.len()
    }

    pub fn is_many(&self) -> bool {
        self.count() > 1
    }

    /// Returns the range from the first to the last selected stop.
    pub fn range(&self) -> Range<usize> {
        self.all.first().map_or(0, |first| *first)..self.all.last().map_or(0, |last| last + 1)
    }

    /// Makes another selected stop the lead.
    pub fn set_lead(&mut self, index: usize) {
        if self.contains(index) {
            self.lead = index;
            self.anchor = index;
        }
    }

    /// Selects the range from the anchor to a stop.
    pub fn extend_to(&mut self, index: usize) {
        *self = Self::between(self.anchor, index);
    }

    /// Adds a stop, or removes it unless it is the only selected one.
    pub fn toggle(&mut self, index: usize) {
        if !self.all.remove(&index) {
            self.all.insert(index);
            self.lead = index;
            self.anchor = index;
        } else if let Some(nearest) = self.all.iter().min_by_key(|other| other.abs_diff(index)).copied() {
            if self.lead == index {
                self.lead = nearest;
                self.anchor = nearest;
            }
        } else {
            self.all.insert(index);
        }
    }

    /// Limits the indices to `count` stops.
    pub fn clamp_to(&mut self, count: usize) {
        if self.all.last().is_some_and(|last| *last >= count) || self.anchor >= count {
            *self = self.map(|index| index.min(count.saturating_sub(1)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(selection: &Selection) -> Vec<usize> {
        selection.iter().collect()
    }

    #[test]
    fn a_range_extends_from_its_anchor() {
        let mut selection = Selection::one(4);
        for (to, expected) in [(6, vec![4, 5, 6]), (5, vec![4, 5]), (2, vec![2, 3, 4]), (4, vec![4])] {
            selection.extend_to(to);
            assert_eq!((all(&selection), selection.lead()), (expected, to));
        }
        assert!(!selection.is_many());
        assert_eq!(Selection::between(5, 3).range(), 3..6);
    }

    #[test]
    fn toggling_adds_and_removes_stops_but_keeps_the_last_one() {
        let mut selection = Selection::one(4);
        for (index, expected, lead) in
            [(1, vec![1, 4], 1), (7, vec![1, 4, 7], 7), (7, vec![1, 4], 4), (1, vec![4], 4), (4, vec![4], 4)]
        {
            selection.toggle(index);
            assert_eq!((all(&selection), selection.lead()), (expected, lead), "{index}");
        }
    }

    #[test]
    fn indices_are_limited_to_the_number_of_stops() {
        let mut selection = Selection::between(2, 6);
        selection.clamp_to(7);
        assert_eq!(selection, Selection::between(2, 6));
        selection.clamp_to(4);
        assert_eq!((all(&selection), selection.lead()), (vec![2, 3], 3));
        selection.clamp_to(0);
        assert_eq!(selection, Selection::one(0));
    }
}
