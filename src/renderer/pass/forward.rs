//! forward: lights and blends every sprite fragment at full resolution, the classic way.
//!
//! Reads: particles back to front, sprite flipbook, detail map or noise, scene depth, lights, ramps.
//! Writes: the host's color target.
//! Blend: alpha, additive or multiply.
//! Source: OTEE "Typical game particles so far".

use super::Groups;
use crate::renderer::gpu::host_pass::HostPass;
use crate::renderer::gpu::pipeline::{
    ADDITIVE, MULTIPLY, PREMULTIPLIED_OVER, QUAD_STRIP, RenderPipelineDescription, bool_constant, depth_compare,
    enum_constant, read_only_depth,
};
use crate::renderer::sprite_instances::{PARTICLE_LAYOUT, SpriteKey, Sprites};
use crate::settings::{Backlight, BlendMode, SoftScatterMode};

/// Key of a forward pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ForwardKey {
    pub host: HostPass,
    pub blend_mode: BlendMode,
    pub sprite: SpriteKey,
    /// True if sprites show through the scene: there is no depth test.
    pub shows_through: bool,
    pub soft_scatter_mode: SoftScatterMode,
    pub backlight: Backlight,
    pub ambient: bool,
    pub shadow_blocks: u32,
    pub reversed: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: ForwardKey) -> RenderPipelineDescription {
    let blend = match key.blend_mode {
        BlendMode::Alpha => PREMULTIPLIED_OVER,
        BlendMode::Additive => ADDITIVE,
        BlendMode::Multiply => MULTIPLY,
    };
    let compare = if key.shows_through { wgpu::CompareFunction::Always } else { depth_compare(key.reversed) };
    RenderPipelineDescription {
        buffers: const { &[Some(PARTICLE_LAYOUT)] },
        primitive: QUAD_STRIP,
        depth_stencil: key.host.depth_format.map(|format| read_only_depth(format, compare)),
        sample_count: key.host.sample_count,
        targets: key.host.color_targets(blend),
        constants: key.sprite.constants([
            enum_constant!("BLEND_MODE", key.blend_mode),
            bool_constant("BY_DEPTH", key.sprite.lights_by_depth()),
            ("SHADOW_BLOCKS", f64::from(key.shadow_blocks)),
            bool_constant("DEPTH_TESTED", key.host.depth_format.is_some() && !key.shows_through),
            enum_constant!("SOFT_SCATTER_MODE", key.soft_scatter_mode),
            enum_constant!("BACKLIGHT", key.backlight),
            bool_constant("AMBIENT", key.ambient),
            bool_constant("FULL_RESOLUTION", true),
        ]),
    }
}

/// The pass for one system, in the host's pass.
#[derive(Debug)]
pub(crate) struct Forward {
    pub pipeline: wgpu::RenderPipeline,
    pub groups: Groups,
    pub sprites: Sprites,
}

impl Forward {
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        self.groups.bind(pass);
        self.sprites.draw(pass);
    }
}
