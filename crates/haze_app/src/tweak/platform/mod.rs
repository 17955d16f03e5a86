//! Everything that touches disk, clock or threads: the rest of the tweaker runs wherever this can be had.

pub mod assets;
pub mod clock;
pub mod dialog;
pub mod export;
pub mod files;
pub mod folders;
pub mod lock;
pub mod memory;
pub mod wake;
pub mod worker;
