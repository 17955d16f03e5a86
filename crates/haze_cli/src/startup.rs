//! Start of the program on a desktop.

use std::process::ExitCode;

use haze_export::interrupt;

use crate::command_line;

/// Runs the command line.
pub fn run() -> ExitCode {
    silence_wayland_without_session();
    silence_decoder_panics();
    interrupt::ignore_file_size_signal();
    command_line::run(std::env::args_os())
}

/// Points `XDG_RUNTIME_DIR` to a folder that does not exist if it is not set. A Vulkan layer of Mesa asks Wayland for
/// the device of the display. If the variable is missing, as without a login session, libwayland prints an error; if
/// the folder is missing, it does not.
#[allow(unsafe_code, reason = "there is no other way to set a variable for a library in this process")]
fn silence_wayland_without_session() {
    const VARIABLE: &str = "XDG_RUNTIME_DIR";
    let is_set = std::env::var_os(VARIABLE).is_some_and(|folder| std::path::Path::new(&folder).is_absolute());
    if cfg!(target_os = "linux") && !is_set {
        // SAFETY: this is the first call in `main`; no other thread exists yet that could read variables.
        unsafe { std::env::set_var(VARIABLE, "/nonexistent") };
    }
}

/// Prints nothing for a panic of an image decoder, which becomes an error that names the file.
fn silence_decoder_panics() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !haze_core::assets::image::is_decoding() {
            print(panic);
        }
    }));
}
