//! Which stops are selected.

use std::collections::BTreeSet;
use std::ops::Range;

/// One stop that fields show, and any that are changed with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    lead: usize,
    /// Where a range begins that is drawn out to another stop.
    anchor: usize,
    /// All of them, the lead too.
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

    /// Those from one to another, which is the lead.
    pub fn between(anchor: usize, lead: usize) -> Self {
        Self { lead, anchor, all: (anchor.min(lead)..=anchor.max(lead)).collect() }
    }

    /// The same stops where their indices are others.
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

    /// From the first to the last of them.
    pub fn range(&self) -> Range<usize> {
        self.all.first().map_or(0, |first| *first)..self.all.last().map_or(0, |last| last + 1)
    }

    /// Makes another of them the lead.
    pub fn lead_with(&mut self, index: usize) {
        if self.contains(index) {
            (self.lead, self.anchor) = (index, index);
        }
    }

    /// Draws the range from where it began out to a stop.
    pub fn extend_to(&mut self, index: usize) {
        *self = Self::between(self.anchor, index);
    }

    /// Adds a stop, or takes it out unless it is the last.
    pub fn toggle(&mut self, index: usize) {
        if !self.all.remove(&index) {
            self.all.insert(index);
            (self.lead, self.anchor) = (index, index);
        } else if let Some(nearest) = self.all.iter().min_by_key(|other| other.abs_diff(index)).copied() {
            if self.lead == index {
                (self.lead, self.anchor) = (nearest, nearest);
            }
        } else {
            self.all.insert(index);
        }
    }

    /// Keeps to as many stops as there are.
    pub fn keep_to(&mut self, count: usize) {
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
    fn a_range_is_drawn_out_from_where_it_began() {
        let mut selection = Selection::one(4);
        for (to, expected) in [(6, vec![4, 5, 6]), (5, vec![4, 5]), (2, vec![2, 3, 4]), (4, vec![4])] {
            selection.extend_to(to);
            assert_eq!((all(&selection), selection.lead()), (expected, to));
        }
        assert!(!selection.is_many());
        assert_eq!(Selection::between(5, 3).range(), 3..6);
    }

    #[test]
    fn stops_are_added_and_taken_out_one_by_one_and_one_stays() {
        let mut selection = Selection::one(4);
        for (index, expected, lead) in
            [(1, vec![1, 4], 1), (7, vec![1, 4, 7], 7), (7, vec![1, 4], 4), (1, vec![4], 4), (4, vec![4], 4)]
        {
            selection.toggle(index);
            assert_eq!((all(&selection), selection.lead()), (expected, lead), "{index}");
        }
    }

    #[test]
    fn it_keeps_to_what_there_is() {
        let mut selection = Selection::between(2, 6);
        selection.keep_to(7);
        assert_eq!(selection, Selection::between(2, 6));
        selection.keep_to(4);
        assert_eq!((all(&selection), selection.lead()), (vec![2, 3], 3));
        selection.keep_to(0);
        assert_eq!(selection, Selection::one(0));
    }
}
