//! Six-way maps: light of a sprite lit from each of six sides.
//!
//! A sheet has the layout of its sprite and twice its height. The upper half holds light from the right, the top and
//! the front in red, green and blue; the lower half from the left, the bottom and the back. A texel holds the square
//! root of the light ([`six_way_from_texel`](crate::formula::six_way::six_way_from_texel)). Alpha is the amount in both
//! halves.

mod bake;
mod packing;
mod trace;

use super::SpriteLayout;
pub use bake::BakedSixWay;
pub use packing::{Packing, pack, unpack};
pub use trace::{SixWayMix, TracedSixWay};

/// Returns the layout of a sprite's six-way maps.
pub fn six_way_layout(sprite: SpriteLayout) -> SpriteLayout {
    SpriteLayout { rows: sprite.rows.saturating_mul(2), y_down: false, ..sprite }
}
