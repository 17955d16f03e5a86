//! The pictures of a particle system on the GPU.

use crate::assets::material::MaterialInfo;

/// Ramps and sprite pictures on the GPU. Cheap to clone and to share between systems, renderers and frames; made by
/// [`Renderer::create_material`](crate::Renderer::create_material).
#[derive(Clone, Debug)]
pub struct Material {
    /// Number of the context that made it.
    pub(crate) context: u64,
    pub(crate) bind_group: wgpu::BindGroup,
    pub(crate) info: MaterialInfo,
    pub(crate) bytes: u64,
}

impl Material {
    /// Bytes of GPU memory that the pictures take.
    pub fn memory_use(&self) -> u64 {
        self.bytes
    }
}
