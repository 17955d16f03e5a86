//! Targets, as tools and a host's own passes see them.

use glam::{IVec2, UVec2};

/// The textures of one system. All share one grid: texel (i, j) covers `scale` by `scale` pixels of the view from
/// (`origin` + (i, j)) · `scale`. The textures may be larger than the part in use, `size` from (0, 0);
/// they can be copied from.
#[derive(Clone, Copy, Debug)]
pub struct TargetViews<'a> {
    /// First: premultiplied normal in rgb, amount in a.
    pub accumulation: &'a [wgpu::TextureView],
    /// `Depth32Float` linear view depth divided by `depth_limit`; `None` where sprites are compared with the host's own
    /// depth.
    pub reduced_depth: Option<&'a wgpu::TextureView>,
    /// Light by normal: six faces of a cubemap, one motif, or none, `Rgba16Float`.
    pub baked_diffuse: &'a [wgpu::TextureView],
    /// First texel of the view's grid.
    pub origin: IVec2,
    /// Texels in use.
    pub size: UVec2,
    /// Pixels per texel.
    pub scale: u32,
    /// View depth stored as 1, metres: what lies beyond looks alike to the system.
    pub depth_limit: f32,
    /// View depth of the plane that light is flattened to, metres: as [`System::depth`](crate::System::depth).
    pub lit_depth: f32,
}
