//! Draws smoke in Bevy without a window, and compares the pictures.

mod alone;
mod entities;
mod host;
mod parity;
mod picture;
mod reload;
mod shadows;
mod views;
