//! What one system is accumulated into and lit from, bound for the passes that read it.

use glam::UVec2;

use super::context::Shared;
use super::layouts::bind_textures;
use super::plan::DeferredPlan;
use super::targets::{AccumulationKey, AccumulationTarget, BakedDiffuse, Beside};
use crate::settings::Settings;

/// The textures of one system, and their bind groups, which are made anew with them.
#[derive(Debug, Default)]
pub(crate) struct SystemTargets {
    accumulation: Option<AccumulationTarget>,
    baked_diffuse: Option<BakedDiffuse>,
    inputs: Option<TargetInputs>,
}

/// Bind groups of the textures.
#[derive(Debug)]
pub(crate) struct TargetInputs {
    /// Group 3 of accumulate; `None` where sprites are compared with the host's own depth.
    pub accumulate: Option<wgpu::BindGroup>,
    /// Group 3 of transfer, specular_scatter and light_target.
    pub transfer: wgpu::BindGroup,
    /// The same with counted layers in place of the amount.
    pub overdraw: Option<wgpu::BindGroup>,
    /// The same with lit smoke.
    pub lit: Option<wgpu::BindGroup>,
}

/// Textures that are ready to be drawn to and read.
#[derive(Clone, Copy)]
pub(crate) struct ReadyTargets<'a> {
    pub accumulation: &'a AccumulationTarget,
    pub baked_diffuse: &'a BakedDiffuse,
    pub inputs: &'a TargetInputs,
}

impl SystemTargets {
    /// Makes everything ready for `size` texels; the whole view at this scale has `limit`.
    pub fn fit(
        &mut self,
        shared: &Shared,
        settings: &Settings,
        plan: &DeferredPlan<'_>,
        size: UVec2,
        limit: UVec2,
    ) -> ReadyTargets<'_> {
        let device = &shared.device;
        let key = AccumulationKey {
            format: settings.accumulate.format,
            beside: Beside::of(settings),
            depth_source: settings.accumulate.depth_source,
            overdraw: plan.overdraw.is_some(),
            lit: plan.light_target.is_some(),
            depth_copy: !shared.read_only_depth,
            tiled: plan.tiled.is_some(),
        };
        let (accumulation, is_new) = AccumulationTarget::fit(&mut self.accumulation, device, key, size, limit);
        let (baked_diffuse, is_newly_baked) = BakedDiffuse::fit(&mut self.baked_diffuse, device, settings.diffuse.mode);
        if is_new || is_newly_baked {
            self.inputs = None;
        }
        let inputs = self.inputs.get_or_insert_with(|| {
            let depth = accumulation.reduced_depth.as_ref();
            let amount = &accumulation.attachments[0];
            let (accumulate, transfer) = (&shared.layouts.accumulate, &shared.layouts.transfer);
            // Without a reduced depth or a second texture nothing reads them, but something must be bound.
            let transfer = |amount| {
                let depth = depth.unwrap_or(amount);
                let beside = accumulation.attachments.get(1).unwrap_or(amount);
                let inputs = [amount, depth, &baked_diffuse.array, beside];
                bind_textures(device, "haze transfer inputs", transfer, inputs)
            };
            TargetInputs {
                accumulate: depth.map(|depth| bind_textures(device, "haze accumulate inputs", accumulate, [depth])),
                transfer: transfer(amount),
                overdraw: accumulation.overdraw.as_ref().map(|layers| transfer(&layers[0])),
                lit: accumulation.lit.as_ref().map(transfer),
            }
        });
        ReadyTargets { accumulation, baked_diffuse, inputs }
    }

    /// The textures, if there are any.
    pub fn textures(&self) -> Option<(&AccumulationTarget, &BakedDiffuse)> {
        self.accumulation.as_ref().zip(self.baked_diffuse.as_ref())
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let accumulation = self.accumulation.as_ref().map_or(0, |target| target.bytes);
        accumulation + self.baked_diffuse.as_ref().map_or(0, |baked| baked.bytes)
    }
}
