//! Views of a system's targets, for tools and a host's own passes.

use haze_core::glam::{IVec2, UVec2};

use haze_core::view_setup::AttachmentSet;

/// Textures of one system. All share one grid: texel (i, j) covers `scale` by `scale` pixels of the view, from `scale`
/// · (`origin` + (i, j)). The part in use has `size` texels and starts at texel (0, 0) of the textures, which may be
/// larger. All have the usage `COPY_SRC`.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TargetViews<'a> {
    /// Textures of the accumulation target, in the order of `roles`. The first has normal and amount.
    pub accumulation: &'a [wgpu::TextureView],
    /// Roles of the textures of `accumulation`.
    pub roles: AttachmentSet,
    /// Linear view depth divided by `depth_limit`, `Depth32Float`, or `R32Float` where compute shaders write it; `None` if
    /// sprites are compared with the host's own depth, as on the path `tiled` at scale 1.
    pub reduced_depth: Option<&'a wgpu::TextureView>,
    /// Light by normal, `Rgba16Float`: six faces of a cubemap, one motif, or none.
    pub baked_diffuse: &'a [wgpu::TextureView],
    /// First texel, on the view's grid.
    pub origin: IVec2,
    /// Size of the part in use, texels.
    pub size: UVec2,
    /// Pixels per texel.
    pub scale: u32,
    /// View depth that is stored as 1, metres. All depths beyond it are equal to this system.
    pub depth_limit: f32,
    /// View depth of the plane on which light is evaluated, metres. See [`ParticleSystem::depth`](crate::ParticleSystem::depth).
    pub lit_depth: f32,
    /// View depths, metres, that the texture of [`AttachmentRole::Depth`](crate::AttachmentRole::Depth) has as 0 and 1. `None`
    /// for particles in a host's buffer, whose depths only the GPU has measured.
    pub smoke_depths: Option<[f32; 2]>,
}
