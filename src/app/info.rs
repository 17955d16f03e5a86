//! `haze info`: what this machine renders with.

use haze::Error;
use haze::headless::Headless;

pub fn run() -> Result<(), Error> {
    println!("haze {}", env!("CARGO_PKG_VERSION"));
    match Headless::new() {
        Ok(gpu) => {
            println!("gpu: {}", gpu.description());
            println!("largest texture: {} pixels a side", gpu.device.limits().max_texture_dimension_2d);
        }
        Err(error) => println!("gpu: none ({error})"),
    }
    println!("cpu: {} threads", std::thread::available_parallelism().map_or(1, usize::from));
    Ok(())
}
