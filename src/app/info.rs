//! `haze info`: what this machine renders with.

use haze::Error;
use haze::headless::Headless;

use super::output::say;

pub fn run() -> Result<(), Error> {
    say!("haze {}", env!("CARGO_PKG_VERSION"))?;
    match Headless::new() {
        Ok(gpu) => {
            say!("gpu: {}", gpu.description())?;
            say!("largest texture: {} pixels a side", gpu.device.limits().max_texture_dimension_2d)?;
        }
        Err(Error::NoDevice(reason)) => say!("gpu: none ({reason})")?,
        Err(error) => return Err(error),
    }
    say!("cpu: {} threads", std::thread::available_parallelism().map_or(1, usize::from))
}
