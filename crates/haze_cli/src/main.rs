//! Entry point of the program `haze`, and of the tweaker on a page.

#[cfg(not(target_arch = "wasm32"))]
mod bake_job;
#[cfg(not(target_arch = "wasm32"))]
mod command_line;
#[cfg(not(target_arch = "wasm32"))]
mod commands;
#[cfg(not(target_arch = "wasm32"))]
mod findings;
#[cfg(not(target_arch = "wasm32"))]
mod medium_options;
#[cfg(not(target_arch = "wasm32"))]
mod plot;
#[cfg(not(target_arch = "wasm32"))]
mod puff_error;
#[cfg(not(target_arch = "wasm32"))]
mod startup;

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    startup::run()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    haze_tweak::open_page();
}
