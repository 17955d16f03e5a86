//! Light baked by normal: the faces of a cubemap, or a motif.

use std::sync::Arc;

use haze_core::formula::diffuse_bake::baked_size_and_layers;
use haze_core::glam::UVec2;
use haze_core::settings::DiffuseMode;

use super::texture_allocator::TextureAllocator;
use crate::renderer::gpu::capabilities::array_layers;

pub(crate) const BAKED_DIFFUSE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Baked light of one system, independent of the view's size.
#[derive(Debug)]
pub(crate) struct BakedDiffuse {
    /// `None` for modes that bake nothing.
    size_and_layers: Option<(u32, u32)>,
    /// One view per face of the cubemap, one for the motif, none for the other diffuse modes.
    pub faces: Arc<[wgpu::TextureView]>,
    /// View of all layers. For modes that bake nothing, a placeholder of one texel that no shader reads.
    pub array: wgpu::TextureView,
    pub bytes: u64,
}

impl BakedDiffuse {
    /// Makes the texture fit a mode. Returns it, and true if it is new.
    pub fn ensure<'a>(baked: &'a mut Option<Self>, device: &wgpu::Device, mode: DiffuseMode) -> (&'a Self, bool) {
        let size_and_layers = baked_size_and_layers(mode);
        if baked.as_ref().is_some_and(|baked| baked.size_and_layers != size_and_layers) {
            *baked = None;
        }
        let is_new = baked.is_none();
        (baked.get_or_insert_with(|| Self::new(device, size_and_layers)), is_new)
    }

    fn new(device: &wgpu::Device, size_and_layers: Option<(u32, u32)>) -> Self {
        let mut textures = TextureAllocator { device, bytes: 0, written: wgpu::TextureUsages::RENDER_ATTACHMENT };
        let (side, layers) = size_and_layers.unwrap_or((1, 1));
        let label = "haze baked diffuse";
        let texture = textures.create(label, BAKED_DIFFUSE_FORMAT, UVec2::splat(side), array_layers(layers));
        let array = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let face = |layer| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            })
        };
        let faces = if size_and_layers.is_some() { 0..layers } else { 0..0 };
        Self { size_and_layers, faces: faces.map(face).collect(), array, bytes: textures.bytes }
    }
}
