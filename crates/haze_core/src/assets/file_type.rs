//! Types of files that are neither read nor replaced: pipes, devices, sockets and folders.

use std::fs::{Metadata, OpenOptions};

/// Name of the type: `a pipe`, `a folder`.
pub fn name(found: &Metadata) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        let kind = found.file_type();
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
        if kind.is_socket() {
            return "a socket";
        }
    }
    match found.file_type() {
        kind if kind.is_dir() => "a folder",
        kind if kind.is_symlink() => "a link",
        kind if kind.is_file() => "a file",
        _ => "something else",
    }
}

/// `O_NONBLOCK`. Without it, opening a pipe blocks until another process opens it.
#[cfg(target_os = "linux")]
const NONBLOCK: i32 = 0o4000;
#[cfg(target_os = "macos")]
const NONBLOCK: i32 = 4;

/// Options with which opening a path of any type does not block.
pub fn nonblocking() -> OpenOptions {
    #[cfg_attr(not(any(target_os = "linux", target_os = "macos")), expect(unused_mut, reason = "set only there"))]
    let mut options = OpenOptions::new();
    #[cfg(any(target_os = "linux", target_os = "macos"))]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, NONBLOCK);
    options
}
