//! Single-sampled copy of a host's multisampled depth buffer.

use haze_core::error::FieldError;
use haze_core::glam::UVec2;
use haze_core::view_setup::ViewGeometry;

use super::context::Shared;
use super::gpu::error_scopes::with_error_scopes;
use super::pass::depth_resolve::{DepthResolve, DepthResolveKey, RESOLVED_DEPTH_FORMAT};
use super::targets::single_target;

/// Resolved depth, and the bind group of the buffer that it is resolved from.
#[derive(Debug)]
pub(crate) struct ResolvedDepth {
    samples: wgpu::TextureView,
    bound: wgpu::BindGroup,
    pub target: wgpu::TextureView,
}

impl ResolvedDepth {
    /// Returns the resolved depth of a buffer. What `kept` holds is used again: all of it for the same view, its target for
    /// another view of the same size, because hosts may create a view each frame.
    ///
    /// # Errors
    /// Names the field `scene_depth` if the view cannot be bound.
    pub fn ensure(kept: Option<Self>, shared: &Shared, samples: &wgpu::TextureView) -> Result<Self, FieldError> {
        let texture = samples.texture();
        let kept = kept.filter(|kept| {
            let target = kept.target.texture();
            (target.width(), target.height()) == (texture.width(), texture.height())
        });
        let kept = match kept {
            Some(kept) if kept.samples == *samples => return Ok(kept),
            kept => kept,
        };
        let device = &shared.device;
        let bind = || shared.pipelines.drawn.depth_resolve.bind_textures([samples]);
        let bound = with_error_scopes(device, bind).map_err(|reason| {
            let expected =
                format!("a 2D view of one layer and the depth aspect of a texture of this device ({reason})");
            FieldError::new("scene_depth", format!("a view of a {:?}", texture.format()), expected)
        })?;
        let size = UVec2::new(texture.width(), texture.height());
        let written = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let create = || single_target(device, "haze resolved depth", RESOLVED_DEPTH_FORMAT, size, written);
        Ok(Self { samples: samples.clone(), bound, target: kept.map_or_else(create, |kept| kept.target) })
    }

    /// Returns the pass that resolves the part of the buffer that a view covers.
    pub fn pass(&self, shared: &Shared, view: &ViewGeometry) -> DepthResolve<'_> {
        let key = DepthResolveKey { reversed: view.depth.reversed };
        DepthResolve {
            pipeline: shared.pipelines.drawn.depth_resolve.get(key),
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
