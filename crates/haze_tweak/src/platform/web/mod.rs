//! Replacements in a browser for the disk, file dialogs and threads.

pub mod disk;
pub mod file_dialog;
pub mod lock_file;
pub mod page;
pub mod storage;
mod web_job;
pub mod worker;
