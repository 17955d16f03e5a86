//! Scene and sky from files on the GPU.

use std::sync::Arc;

use glam::UVec2;
use half::f16;
use haze_core::assets::image::Image;
use wgpu::util::DeviceExt as _;

use super::mesh_renderer::{MeshPipelines, UploadedMesh};
use super::scene_pipeline::default_view;
use haze_author::backdrop::Backdrop;

/// A backdrop, and what was uploaded of it.
#[derive(Debug)]
pub(crate) struct UploadedBackdrop {
    pub backdrop: Backdrop,
    /// Panorama; one texel without.
    pub sky: wgpu::TextureView,
    pub mesh: Option<(Arc<MeshPipelines>, UploadedMesh)>,
    sky_bytes: u64,
}

impl UploadedBackdrop {
    /// Uploads a backdrop. `pipelines`: called if it has a mesh.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        backdrop: &Backdrop,
        pipelines: impl FnOnce() -> Arc<MeshPipelines>,
    ) -> Self {
        let max_width = device.limits().max_texture_dimension_2d;
        let sky = backdrop.sky.as_ref().map(|sky| sky.fitted(max_width));
        let sky = sky.unwrap_or_else(|| Image::new(UVec2::ONE, [f16::ZERO; 4]));
        let descriptor = wgpu::TextureDescriptor {
            label: Some("demo scene sky"),
            size: wgpu::Extent3d { width: sky.size.x, height: sky.size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let bits: Vec<u16> = sky.texels.as_flattened().iter().map(|value| value.to_bits()).collect();
        let data: &[u8] = bytemuck::cast_slice(&bits);
        let texture =
            device.create_texture_with_data(queue, &descriptor, wgpu::util::TextureDataOrder::LayerMajor, data);
        let mesh = backdrop.mesh().map(|mesh| {
            let pipelines = pipelines();
            let uploaded = pipelines.upload(device, queue, mesh);
            (pipelines, uploaded)
        });
        Self { backdrop: backdrop.clone(), sky: default_view(&texture), mesh, sky_bytes: data.len() as u64 }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.sky_bytes + self.mesh.as_ref().map_or(0, |(_, mesh)| mesh.bytes())
    }
}
