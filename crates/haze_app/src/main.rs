//! Entry point of the `haze` program.

mod bake;
mod bench;
mod command_line;
mod cost;
mod export;
mod findings;
mod flip;
mod frames;
mod info;
mod inputs;
mod interrupt;
mod kind;
mod label;
mod medium;
mod memory;
mod options;
mod output;
mod plot;
mod preset;
mod progress;
mod puffs;
mod ramp;
mod recipe;
mod render;
mod shade_tree;
mod sheet;
mod sprite;
mod techniques;
mod tweak;
mod vary;
mod watch;

use std::process::ExitCode;

fn main() -> ExitCode {
    silence_wayland_without_session();
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
