//! All access to disk, clock and threads. The rest of the tweaker has no dependency on the operating system.

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
