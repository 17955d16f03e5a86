//! The sprite that is looked at: how it is lit, and its recipe while it is changed.

pub mod bakery;
pub mod draw;
pub mod files;
pub mod look;
pub mod source;

#[cfg(test)]
mod tests;
