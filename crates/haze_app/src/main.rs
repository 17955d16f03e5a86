//! The `haze` binary: subcommand dispatch only.

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
    without_a_session();
    command_line::run(std::env::args_os())
}

/// A Vulkan layer of Mesa's asks Wayland which device the display has. Where nobody is logged in, libwayland complains to
/// standard error that it does not know where to look; given a place where nothing is, it is quiet.
#[allow(unsafe_code, reason = "there is no other way to give a library of this process a variable")]
fn without_a_session() {
    const VARIABLE: &str = "XDG_RUNTIME_DIR";
    let is_set = std::env::var_os(VARIABLE).is_some_and(|folder| std::path::Path::new(&folder).is_absolute());
    if cfg!(target_os = "linux") && !is_set {
        // SAFETY: the program has just begun, no other thread reads variables.
        unsafe { std::env::set_var(VARIABLE, "/nonexistent") };
    }
}
