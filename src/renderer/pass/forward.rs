//! forward: lights and blends every sprite fragment at full resolution, the classic way.
//!
//! Reads: particles back to front, sprite flipbook, detail map or noise, scene depth, lights, ramps.
//! Writes: the host's color target.
//! Blend: alpha, additive or multiply.
//! Source: OTEE "Typical game particles so far".

use haze_core::settings::{Backlight, BlendMode, SoftScatterMode};

use super::groups::Groups;
use super::sprite_instances::{PARTICLE_LAYOUT, SpriteKey, Sprites};
use crate::renderer::gpu::host_pass::HostPass;
use crate::renderer::gpu::pipeline::{
    ADDITIVE, MULTIPLY, PREMULTIPLIED_OVER, QUAD_STRIP, RenderPipelineDescription, bool_constant, depth_compare,
    enum_constant, read_only_depth,
};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

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

impl PipelineKey for ForwardKey {
    const PASS: &'static str = "forward";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = RenderPipelineDescription;

    fn describe(self) -> RenderPipelineDescription {
        let blend = match self.blend_mode {
            BlendMode::Alpha => PREMULTIPLIED_OVER,
            BlendMode::Additive => ADDITIVE,
            BlendMode::Multiply => MULTIPLY,
        };
        let compare = if self.shows_through { wgpu::CompareFunction::Always } else { depth_compare(self.reversed) };
        RenderPipelineDescription {
            buffers: const { &[Some(PARTICLE_LAYOUT)] },
            primitive: QUAD_STRIP,
            depth_stencil: self.host.depth_format.map(|format| read_only_depth(format, compare)),
            sample_count: self.host.sample_count,
            targets: self.host.color_targets(blend),
            constants: self.sprite.constants([
                enum_constant!("BLEND_MODE", self.blend_mode),
                bool_constant("BY_DEPTH", self.sprite.receives_shadow_by_depth()),
                ("SHADOW_BLOCKS", f64::from(self.shadow_blocks)),
                bool_constant("DEPTH_TESTED", self.host.depth_format.is_some() && !self.shows_through),
                enum_constant!("SOFT_SCATTER_MODE", self.soft_scatter_mode),
                enum_constant!("BACKLIGHT", self.backlight),
                bool_constant("AMBIENT", self.ambient),
                bool_constant("FULL_RESOLUTION", true),
            ]),
        }
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
