//! What a browser has in place of a disk, a file dialog and threads.

pub mod disk;
pub mod file_dialog;
pub mod lock_file;
pub mod page;
pub mod storage;
pub mod worker;
