//! When to give memory back: not at once, for what grew once may grow again.

/// Frames for which something must have been too large, or not in use, before it is given up: two seconds of most games.
const PATIENCE: u32 = 120;

/// Counts frames in which memory was to spare.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Spare {
    frames: u32,
}

impl Spare {
    /// Tells of one more frame; true once it is time to give the memory back.
    pub fn outlasts(&mut self, is_to_spare: bool) -> bool {
        self.frames = if is_to_spare { self.frames + 1 } else { 0 };
        self.frames > PATIENCE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lasts_is_given_back() {
        let mut spare = Spare::default();
        assert!((0..PATIENCE).all(|_| !spare.outlasts(true)));
        assert!(!spare.outlasts(false) && !spare.outlasts(true));
        assert!((1..PATIENCE).all(|_| !spare.outlasts(true)));
        assert!(spare.outlasts(true));
    }
}
