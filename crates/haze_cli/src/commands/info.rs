//! `haze info`: prints what this machine renders with.

use glam::UVec2;
use haze::{Context, PathChoice, PathReason, PathWorkload};
use haze_core::error::Error;
use haze_core::settings::{RenderPath, Technique};
use haze_demo::headless::Headless;

use haze_export::output::print_line;

pub fn run() -> Result<(), Error> {
    print_line!("haze {}", env!("CARGO_PKG_VERSION"))?;
    match Headless::new() {
        Ok(gpu) => {
            print_line!("gpu: {}", gpu.description())?;
            print_line!("largest texture: {} pixels per side", gpu.device.limits().max_texture_dimension_2d)?;
            print_line!("choices of path auto at 1280x720:")?;
            for choice in choices(&gpu)? {
                print_line!("  {choice}")?;
            }
        }
        Err(Error::NoDevice(reason)) => print_line!("gpu: none ({reason})")?,
        Err(error) => return Err(error),
    }
    print_line!("cpu: {} threads", std::thread::available_parallelism().map_or(1, usize::from))
}

/// Returns the choices of the path `auto` for few layers and for many, from the measured costs of this adapter.
fn choices(gpu: &Headless) -> Result<Vec<PathChoice>, Error> {
    let context = Context::new(&gpu.device, &gpu.queue);
    let model = context.measure_paths(|encoder| gpu.submit(encoder))?;
    if !context.supports_tiled() {
        return Ok(vec![PathChoice { path: RenderPath::Raster, reason: PathReason::TiledUnsupported }]);
    }
    let size = UVec2::new(1280, 720);
    let load = |layers: f64| {
        let fragments = layers * size.as_dvec2().element_product();
        let mut load = PathWorkload::new(Technique::Soft, size, 16.0 * layers, fragments);
        // -ln(1 - amount) of sprites of amount 0.3, averaged over a texture that is one third full.
        load.optical_depth = 0.12;
        load
    };
    Ok([4.0, 16.0, 64.0, 256.0].map(|layers| PathChoice::new(&model, &load(layers))).into())
}
