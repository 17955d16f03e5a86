//! Single-sampled copy of a host's multisampled depth buffer.

use glam::UVec2;

use super::context::Shared;
use super::gpu::error_scopes::with_error_scopes;
use super::layouts::bind_textures;
use super::pass::depth_resolve::{DepthResolve, DepthResolveKey, RESOLVED_DEPTH_FORMAT};
use super::targets::depth_target;
use crate::error::FieldError;
use crate::view_setup::ViewGeometry;

/// Resolved depth, and the bind group of the buffer that it is resolved from. Both are kept while the host passes the
/// same buffer.
#[derive(Debug)]
pub(crate) struct ResolvedDepth {
    samples: wgpu::TextureView,
    bound: wgpu::BindGroup,
    pub target: wgpu::TextureView,
}

impl ResolvedDepth {
    /// Returns `kept` if it belongs to this buffer; otherwise creates the target and the bind group.
    ///
    /// # Errors
    /// Names the field `scene_depth` if the view cannot be bound.
    pub fn ensure(kept: Option<Self>, shared: &Shared, samples: &wgpu::TextureView) -> Result<Self, FieldError> {
        if let Some(kept) = kept.filter(|kept| kept.samples == *samples) {
            return Ok(kept);
        }
        let texture = samples.texture();
        let device = &shared.device;
        let bind = || bind_textures(device, "haze depth samples", &shared.layouts.depth_resolve, [samples]);
        let bound = with_error_scopes(device, bind).map_err(|reason| {
            let expected =
                format!("a 2D view of one layer and the depth aspect of a texture of this device ({reason})");
            FieldError::new("scene_depth", format!("a view of a {:?}", texture.format()), expected)
        })?;
        let size = UVec2::new(texture.width(), texture.height());
        let target = depth_target(device, "haze resolved depth", RESOLVED_DEPTH_FORMAT, size);
        Ok(Self { samples: samples.clone(), bound, target })
    }

    /// Returns the pass that resolves the part of the buffer that a view covers.
    pub fn pass(&self, shared: &Shared, view: &ViewGeometry) -> DepthResolve<'_> {
        let key = DepthResolveKey { reversed: view.depth.reversed };
        DepthResolve {
            pipeline: shared.pipelines.depth_resolve.get(key),
            target: &self.target,
            samples: &self.bound,
            origin: view.origin,
            size: view.size,
        }
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        let texture = self.target.texture();
        4 * u64::from(texture.width()) * u64::from(texture.height())
    }
}
