//! Draws smoke in Bevy without a window, and compares the pictures.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper that fails fails its test")]

mod alone;
mod animation;
mod cost;
mod entities;
mod environment;
mod errors;
mod host;
mod parity;
mod picture;
mod reload;
mod setups;
mod shadows;
mod views;
