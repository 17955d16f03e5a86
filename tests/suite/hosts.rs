//! Host configurations: several views, handedness, viewports, formats, sample counts, and rejected input.

mod particle_sort;
mod passes;
pub mod retained_resources;
mod submissions;
mod views;
mod warm_up;

use std::sync::OnceLock;

use glam::UVec2;
use haze::{Particles, wgpu};
use haze_core::error::Error;
use haze_demo::headless::Headless;

use crate::test_scene::TestScene;

const SIZE: UVec2 = UVec2::new(160, 90);

/// Returns a device with optional texture formats and a pipeline cache, as far as the adapter has them. The device of
/// other tests has none of these features.
fn device_with_optional_features() -> &'static Headless {
    static GPU: OnceLock<Headless> = OnceLock::new();
    GPU.get_or_init(|| {
        let optional = wgpu::Features::DEPTH32FLOAT_STENCIL8
            | wgpu::Features::RG11B10UFLOAT_RENDERABLE
            | wgpu::Features::PIPELINE_CACHE;
        Headless::with(wgpu::Limits::default(), optional).unwrap()
    })
}

fn slice(scene: &TestScene) -> Particles<'_> {
    Particles::Slice(&scene.particles)
}

fn encoder(gpu: &Headless) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

/// Returns the field that an error names. Panics if there is no error, or another kind of error.
fn rejected_field<T>(result: Result<T, impl Into<Error>>) -> String {
    match result.map_err(Into::into) {
        Err(Error::Field(error)) => error.field,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted; expected an error that names a field"),
    }
}
