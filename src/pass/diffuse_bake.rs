//! diffuse_bake
//! What: bakes all lights through the diffuse ramp into a small texture by normal, once per system and frame.
//! Reads: lights, diffuse ramp. Writes: cubemap faces or motif, Rgba16Float. Blend: none.
//! Source: OTEE "Diffuse lighting": "use cubemaps", "motif lighting".

use super::{Layouts, PipelineParts, Variants, color_target, create_pipeline, switch};
use super::{begin_pass, bind, color_attachment};
use crate::frame_bindings::FrameBindings;
use crate::settings::DiffuseMode;
use crate::slot::{DrawPath, Slot};

pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Side and layers of the baked texture. A ramp's gradient is broad: 32 texels across 90 degrees resolve it; the motif
/// has to hold the rim, where its texels shrink, and gets twice that.
pub(crate) fn size_and_layers(mode: DiffuseMode) -> Option<(u32, u32)> {
    match mode {
        DiffuseMode::Cubemap => Some((32, 6)),
        DiffuseMode::Motif => Some((64, 1)),
        DiffuseMode::Ramp | DiffuseMode::PaintedMotif | DiffuseMode::SphericalHarmonics => None,
    }
}

#[derive(Debug)]
pub(crate) struct DiffuseBakePass {
    variants: Variants<DiffuseMode>,
    exact_filtering: bool,
}

impl DiffuseBakePass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts, exact_filtering: bool) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material)];
        Self { variants: Variants::new(device, "diffuse_bake", &groups), exact_filtering }
    }

    /// `None` for the modes that bake nothing.
    pub fn pipeline(&mut self, device: &wgpu::Device, mode: DiffuseMode) -> Option<wgpu::RenderPipeline> {
        let (side, _) = size_and_layers(mode)?;
        let exact_filtering = self.exact_filtering;
        Some(self.variants.get(mode, |module, layout| {
            create_pipeline(
                device,
                PipelineParts {
                    label: "diffuse_bake",
                    module,
                    layout,
                    buffers: &[],
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: None,
                    sample_count: 1,
                    targets: &[color_target(FORMAT, None)],
                    constants: &[
                        switch("MOTIF", mode == DiffuseMode::Motif),
                        ("BAKE_SIZE", f64::from(side)),
                        switch("EXACT_FILTERING", exact_filtering),
                    ],
                },
            )
        }))
    }
}

/// Records the pass for one system: every face of the cubemap, or the motif.
pub(crate) fn record(encoder: &mut wgpu::CommandEncoder, frame: &FrameBindings, slot: &Slot) {
    let (Some(draw), Some(targets)) = (&slot.draw, &slot.targets) else { return };
    let DrawPath::Deferred { diffuse_bake: Some(pipeline), .. } = &draw.path else { return };
    for (face, view) in (0..).zip(&targets.baked_diffuse) {
        let mut pass = begin_pass(encoder, "diffuse_bake", &[color_attachment(view)], None);
        pass.set_pipeline(pipeline);
        bind(&mut pass, frame, slot, draw);
        pass.draw(3 * face..3 * face + 3, 0..1);
    }
}
