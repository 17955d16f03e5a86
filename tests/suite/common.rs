//! What the tests share: the device.

use std::sync::OnceLock;

use haze::headless::Headless;

/// The one device of this process. A machine without an adapter fails, with the line that installs one.
pub fn gpu() -> &'static Headless {
    static GPU: OnceLock<Headless> = OnceLock::new();
    GPU.get_or_init(|| match Headless::new() {
        Ok(gpu) => {
            eprintln!("adapter: {}", gpu.description());
            gpu
        }
        Err(error) => panic!("{error}"),
    })
}
