//! Six-way maps: light of a sprite lit from each of six sides.
//!
//! A sheet has the layout of its sprite and twice its height. The upper half holds light from the right, the top and
//! the front in red, green and blue; the lower half from the left, the bottom and the back. A texel holds the square
//! root of the light ([`six_way_from_texel`](haze_core::formula::six_way::six_way_from_texel)). Alpha is the amount in both
//! halves.

mod bake_maps;
mod image_as_bytes;
mod packing;
mod trace;

pub use bake_maps::{BakedSixWay, bake_six_way};
pub use haze_core::assets::sprite::six_way_layout;
pub(in crate::sprite) use packing::encode_texel;
pub use packing::{Packing, pack, unpack};
pub use trace::{SixWayMix, TracedSixWay};
