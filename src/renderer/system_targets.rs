//! Textures that one system is accumulated into and lit from, bound for the passes that read them.

use glam::UVec2;

use super::context::Shared;
use super::layouts::{TRANSFER_TEXTURES, bind_textures};
use super::plan::DeferredPlan;
use super::targets::{AccumulationKey, AccumulationTarget, BakedDiffuse};
use crate::settings::DepthSource;
use crate::view_setup::{AttachmentSet, ResolvedSettings};

/// Textures of one system, and their bind groups, which are recreated with the textures.
#[derive(Debug, Default)]
pub(crate) struct SystemTargets {
    accumulation: Option<AccumulationTarget>,
    baked_diffuse: Option<BakedDiffuse>,
    inputs: Option<TargetInputs>,
}

/// Bind groups of the textures.
#[derive(Debug)]
pub(crate) struct TargetInputs {
    /// Group 3 of accumulate; `None` if sprites are compared with the host's own depth.
    pub accumulate: Option<wgpu::BindGroup>,
    /// Group 3 of transfer.
    pub transfer: wgpu::BindGroup,
    /// As `transfer`, with counted layers in place of the first attachment.
    pub overdraw: Option<wgpu::BindGroup>,
    /// Group 3 of depth_downsample, if it is computed.
    pub depth_downsample: Option<wgpu::BindGroup>,
    /// Group 3 of light_target.
    pub light_target: Option<wgpu::BindGroup>,
    /// Group 3 of depth_slopes, which writes the slopes.
    pub depth_slopes: Option<wgpu::BindGroup>,
    /// Group 3 of transfer_lit and specular_scatter: lit smoke and its slopes, or the first attachment.
    pub upsampled: wgpu::BindGroup,
    /// Group 3 of mark_cells, if cells are drawn.
    pub mark_cells: Option<wgpu::BindGroup>,
    /// Group 3 of upsample_lit, if pixels are computed.
    pub upsample_lit: Option<wgpu::BindGroup>,
    /// Group 3 of transfer_lit, if pixels are computed: they take the place of the lit smoke.
    pub pixels: Option<wgpu::BindGroup>,
}

/// Textures that fit the current frame, and their bind groups.
#[derive(Clone, Copy)]
pub(crate) struct ReadyTargets<'a> {
    pub accumulation: &'a AccumulationTarget,
    pub baked_diffuse: &'a BakedDiffuse,
    pub inputs: &'a TargetInputs,
}

impl SystemTargets {
    /// Makes all textures fit `size` texels. `limit`: size of the whole view at this scale, texels.
    pub fn ensure(
        &mut self,
        shared: &Shared,
        settings: &ResolvedSettings,
        plan: &DeferredPlan<'_>,
        size: UVec2,
        limit: UVec2,
    ) -> ReadyTargets<'_> {
        let device = &shared.device;
        let key = AccumulationKey {
            format: settings.accumulate.format,
            attachments: AttachmentSet::of(settings),
            is_host_sized: settings.accumulate.depth_source == DepthSource::Host,
            reduced_depth: plan.depth_downsample.is_some(),
            overdraw: plan.overdraw.is_some(),
            lit: plan.light_target.is_some(),
            depth_slopes: plan.depth_slopes.is_some(),
            depth_copy: !shared.read_only_depth,
            tiled: plan.tiled.is_some(),
            computes_depth: plan.computes_depth(),
            computes_texels: plan.computes_texels,
            pixels_scale: plan.upsample_lit.map(|_| settings.scale),
        };
        let (accumulation, is_new) = AccumulationTarget::ensure(&mut self.accumulation, device, key, size, limit);
        let (baked_diffuse, is_newly_baked) =
            BakedDiffuse::ensure(&mut self.baked_diffuse, device, settings.diffuse.mode);
        if is_new || is_newly_baked {
            self.inputs = None;
        }
        let inputs = self.inputs.get_or_insert_with(|| {
            let depth = accumulation.reduced_depth.as_ref();
            let amount = &accumulation.attachments[0];
            let layouts = &shared.layouts;
            // Placeholders: no shader reads the textures that a system does not have, but the bindings must be filled.
            let transfer_textures = |amount| {
                let mut inputs = [amount; TRANSFER_TEXTURES];
                (inputs[1], inputs[2]) = (depth.unwrap_or(amount), &baked_diffuse.array);
                inputs[3..].iter_mut().zip(&accumulation.attachments[1..]).for_each(|(input, view)| *input = view);
                inputs
            };
            let bind_transfer =
                |amount| bind_textures(device, "haze transfer inputs", &layouts.transfer, transfer_textures(amount));
            let transfer = bind_transfer(amount);
            let lit = accumulation.lit.as_ref().unwrap_or(amount);
            let (cells, glows) = (accumulation.smoke_cells.as_ref(), accumulation.glows.as_ref());
            let slope_cells = accumulation.slope_cells.as_ref().unwrap_or(lit);
            let lit_textures = |lit, slopes| {
                let (cells, glows) = (cells.unwrap_or(lit), glows.unwrap_or(lit));
                [lit, depth.unwrap_or(lit), slopes, cells, glows, slope_cells]
            };
            // For passes that write slopes or cells, which cannot be bound in the same pass.
            let unmarked_inputs = |slopes| {
                let textures = [lit, depth.unwrap_or(lit), slopes, lit, lit, lit];
                bind_textures(device, "haze unmarked inputs", &layouts.lit, textures)
            };
            let lit_inputs =
                |lit, slopes| bind_textures(device, "haze lit inputs", &layouts.lit, lit_textures(lit, slopes));
            // Passes that compute texels write the last of their textures.
            let computed = shared.pipelines.tiled.as_ref().map(|tiled| &tiled.layouts);
            let computed_texels = computed.filter(|_| plan.computes_texels);
            let depth_slopes = accumulation.depth_slopes.as_ref();
            let pixels = accumulation.pixels.as_ref();
            TargetInputs {
                depth_downsample: computed.filter(|_| key.computes_depth).zip(depth).map(|(computed, depth)| {
                    bind_textures(device, "haze depth_downsample target", &computed.depth_downsample, [depth])
                }),
                accumulate: depth
                    .map(|depth| bind_textures(device, "haze accumulate inputs", &layouts.accumulate, [depth])),
                overdraw: accumulation.overdraw.as_ref().map(|layers| bind_transfer(&layers[0])),
                light_target: accumulation.lit.as_ref().map(|lit| match computed_texels {
                    Some(computed) => {
                        let written = [Some(lit), cells, glows].into_iter().flatten();
                        let textures = transfer_textures(amount).into_iter().chain(written);
                        bind_textures(device, "haze light_target inputs", &computed.light_target, textures)
                    }
                    None => transfer.clone(),
                }),
                depth_slopes: depth_slopes.map(|slopes| match computed_texels {
                    Some(computed) => {
                        let textures = [lit, depth.unwrap_or(lit), slopes, slope_cells];
                        bind_textures(device, "haze depth_slopes inputs", &computed.depth_slopes, textures)
                    }
                    None => unmarked_inputs(lit),
                }),
                mark_cells: plan.mark_cells.map(|_| unmarked_inputs(depth_slopes.unwrap_or(lit))),
                upsampled: lit_inputs(lit, depth_slopes.unwrap_or(lit)),
                upsample_lit: computed_texels.zip(pixels).map(|(computed, pixels)| {
                    let textures = lit_textures(lit, depth_slopes.unwrap_or(lit)).into_iter().chain([pixels]);
                    bind_textures(device, "haze upsample_lit inputs", &computed.upsample_lit, textures)
                }),
                pixels: pixels.map(|pixels| lit_inputs(pixels, pixels)),
                transfer,
            }
        });
        ReadyTargets { accumulation, baked_diffuse, inputs }
    }

    /// Returns the textures, if they exist.
    pub fn textures(&self) -> Option<(&AccumulationTarget, &BakedDiffuse)> {
        self.accumulation.as_ref().zip(self.baked_diffuse.as_ref())
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        let accumulation = self.accumulation.as_ref().map_or(0, |target| target.bytes);
        accumulation + self.baked_diffuse.as_ref().map_or(0, |baked| baked.bytes)
    }
}
