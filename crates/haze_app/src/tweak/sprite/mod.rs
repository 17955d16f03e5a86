//! Sprite of the selected system: its preview, and its recipe while it is edited.

pub mod bakery;
pub mod draw;
pub mod files;
pub mod look;
pub mod source;

#[cfg(test)]
mod tests;
