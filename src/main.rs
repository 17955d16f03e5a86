//! The `haze` binary: subcommand dispatch only.

mod app;

use std::process::ExitCode;

fn main() -> ExitCode {
    app::run(std::env::args_os())
}
