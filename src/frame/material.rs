//! Images of a particle system on the GPU.

use std::sync::Arc;

use haze_core::assets::material_assets::MaterialInfo;

/// Ramps and sprite images on the GPU. Cheap to clone and to share between systems, renderers and frames.
/// [`Context::create_material`](crate::Context::create_material) creates it.
#[derive(Clone, Debug)]
pub struct Material {
    /// Number of the context that created it.
    pub(crate) context: u64,
    pub(crate) bind_group: wgpu::BindGroup,
    /// The part of it that the passes that light accumulated smoke read.
    pub(crate) lighting: wgpu::BindGroup,
    pub(crate) shadow_ramp: Arc<UploadedImage>,
    /// All images but the ramp of the shadow.
    pub(crate) images: Vec<Arc<UploadedImage>>,
    pub(crate) info: MaterialInfo,
}

/// An image on the GPU.
#[derive(Debug)]
pub(crate) struct UploadedImage {
    pub view: wgpu::TextureView,
    /// Size of the texels.
    pub bytes: u64,
}

impl Material {
    /// GPU memory of the images, bytes. Images that other materials share count in each.
    pub fn memory_use(&self) -> u64 {
        self.shadow_ramp.bytes + self.images.iter().map(|image| image.bytes).sum::<u64>()
    }
}
