//! Passes of the camera over the final image on the GPU: smooth edges, then hot air.

use std::sync::OnceLock;

use glam::UVec2;
use haze_core::frame::Light;

use super::antialiasing::ANTIALIASING_SHADER;
use super::heat_haze::HEAT_HAZE_SHADER;
use super::image_pass::{ImagePass, ImagePassInputs};
use super::shot::Shot;

/// Shaders of the passes, in order.
const SHADERS: [&str; 2] = [ANTIALIASING_SHADER, HEAT_HAZE_SHADER];

/// Pipelines of the passes, compiled on first use: few images have any.
#[derive(Debug)]
pub(crate) struct CameraPasses {
    device: wgpu::Device,
    queue: wgpu::Queue,
    passes: [OnceLock<ImagePass>; SHADERS.len()],
}

/// Images that the passes of a frame read; `None` for a pass that is not drawn.
#[derive(Debug, Default)]
pub(crate) struct CameraImages {
    inputs: [Option<ImagePassInputs>; SHADERS.len()],
}

/// Uniforms of the passes of a frame; `None` for a pass that is not drawn.
#[derive(Debug)]
pub(crate) struct CameraUniforms([Option<Vec<u8>>; SHADERS.len()]);

impl CameraUniforms {
    /// Those of a shot. `lights`: as from [`Shot::lights`].
    pub fn new(shot: &Shot, lights: &[Light]) -> Self {
        let antialiasing = shot.antialiasing().then(Vec::new);
        let hot_air = shot.heat_haze(lights).map(|hot_air| bytemuck::bytes_of(&hot_air).to_vec());
        Self([antialiasing, hot_air])
    }
}

impl CameraPasses {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self { device: device.clone(), queue: queue.clone(), passes: Default::default() }
    }

    fn pass(&self, index: usize) -> &ImagePass {
        self.passes[index].get_or_init(|| ImagePass::new(&self.device, &self.queue, SHADERS[index]))
    }

    /// Creates the images that the passes read, and removes those of passes that are not drawn. Call it for images of one size
    /// and one depth buffer.
    pub fn prepare(
        &self,
        images: &mut CameraImages,
        uniforms: &CameraUniforms,
        size: UVec2,
        depth: &wgpu::TextureView,
    ) {
        for (index, (inputs, uniform)) in images.inputs.iter_mut().zip(&uniforms.0).enumerate() {
            match uniform {
                Some(uniform) if inputs.is_none() => {
                    *inputs = Some(self.pass(index).inputs(size, depth, uniform.len()));
                }
                Some(_) => {}
                None => *inputs = None,
            }
        }
    }

    /// Draws the passes, from the first image to `image`.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        images: &CameraImages,
        uniforms: &CameraUniforms,
        image: &wgpu::Texture,
    ) {
        for (index, (inputs, uniform)) in images.inputs.iter().zip(&uniforms.0).enumerate() {
            let Some((inputs, uniform)) = inputs.as_ref().zip(uniform.as_ref()) else { continue };
            let target = images.inputs[index + 1..].iter().flatten().next().map_or(image, |next| &next.image);
            self.pass(index).record(encoder, inputs, uniform, target);
        }
    }
}

impl CameraImages {
    /// The images, from the first that is read.
    pub fn textures(&self) -> impl Iterator<Item = &wgpu::Texture> {
        self.inputs.iter().flatten().map(|inputs| &inputs.image)
    }
}
