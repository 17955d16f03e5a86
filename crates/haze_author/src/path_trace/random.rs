//! Random numbers of a path, from an integer hash so that every machine draws the same.

use glam::{UVec3, Vec2};

use haze_core::formula::hash::{pcg3d, unit};

pub(super) struct Random {
    key: UVec3,
    drawn: [u32; 3],
    left: usize,
}

impl Random {
    pub fn new(key: UVec3) -> Self {
        Self { key: pcg3d(key), drawn: [0; 3], left: 0 }
    }

    /// Returns a uniform number in [0, 1).
    pub fn unit(&mut self) -> f32 {
        if self.left == 0 {
            self.key.x = self.key.x.wrapping_add(1);
            self.drawn = pcg3d(self.key).to_array();
            self.left = 3;
        }
        self.left -= 1;
        unit(self.drawn[self.left])
    }

    /// Returns a uniform unit vector in the plane.
    pub fn on_circle(&mut self) -> Vec2 {
        loop {
            let p = Vec2::new(self.unit(), self.unit()) * 2.0 - 1.0;
            let square = p.length_squared();
            if square > 1.0e-4 && square <= 1.0 {
                return p / square.sqrt();
            }
        }
    }
}
