//! Host configurations: several views, handedness, viewports, formats, sample counts, and rejected input.

pub mod kept;
mod passes;
mod submissions;
mod unsorted;
mod views;
mod warm_up;

use std::sync::OnceLock;

use glam::UVec2;
use haze::{Error, Particles, wgpu};
use haze_demo::headless::Headless;

use crate::test_scene::TestScene;

const SIZE: UVec2 = UVec2::new(160, 90);

/// Returns a device with optional texture formats and a pipeline cache, as far as the adapter has them. The device of
/// other tests has none of these features.
fn featured() -> &'static Headless {
    static GPU: OnceLock<Headless> = OnceLock::new();
    GPU.get_or_init(|| {
        let optional = wgpu::Features::DEPTH32FLOAT_STENCIL8
            | wgpu::Features::RG11B10UFLOAT_RENDERABLE
            | wgpu::Features::PIPELINE_CACHE;
        Headless::with(wgpu::Limits::default(), optional).unwrap()
    })
}

fn slice(stage: &TestScene) -> Particles<'_> {
    Particles::Slice(&stage.particles)
}

fn encoder(gpu: &Headless) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

/// Returns the field that an error names. Panics if there is no error, or another kind of error.
fn field<T>(result: Result<T, Error>) -> String {
    match result {
        Err(Error::Field(error)) => error.field,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted; expected an error that names a field"),
    }
}
