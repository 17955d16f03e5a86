//! Six-way maps: a sprite under light from six sides.
//!
//! A sheet of them is laid out as its sprite, and as high again: above, light from the right, the top and the front in red, green and
//! blue; below, from the left, the bottom and the back. What a texel holds is the square root of the light
//! ([`six_way_from_texel`](haze::formula::six_way::six_way_from_texel)); alpha is the amount, in both halves.

mod bake;
mod packing;
mod trace;

pub use bake::BakedSixWay;
pub use haze::sprite::six_way_layout;
pub use packing::{Packing, pack, unpack};
pub use trace::{SixWayMix, TracedSixWay};
