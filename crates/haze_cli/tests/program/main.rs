//! The program as its users run it: the command line, the files it is given, the window.

mod cli;
mod cli_inputs;
#[cfg(target_os = "linux")]
mod window;
