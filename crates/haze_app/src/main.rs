//! Entry point of the program `haze`, and of the tweaker on a page.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    haze_app::run()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    haze_app::open_page();
}
