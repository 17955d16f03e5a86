//! Textures that one system is accumulated into and lit from.

use haze_core::glam::UVec2;
use haze_core::settings::DepthSource;
use haze_core::view_setup::{AttachmentSet, ResolvedSettings};

use crate::renderer::plan::DeferredPlan;
use crate::renderer::targets::{
    AccumulationKey, AccumulationTarget, BakedDiffuse, Extent, InputGroups, SystemTextures,
};

/// Textures of one system, and their bind groups, which are recreated with the textures.
#[derive(Debug, Default)]
pub(crate) struct SystemTargets {
    accumulation: Option<AccumulationTarget>,
    baked_diffuse: Option<BakedDiffuse>,
    inputs: InputGroups,
}

impl SystemTargets {
    /// Makes all textures fit `size` texels. `limit`: size of the whole view at this scale, texels. Returns the textures and
    /// their bind groups.
    pub fn ensure(
        &mut self,
        device: &wgpu::Device,
        settings: &ResolvedSettings,
        plan: &DeferredPlan<'_>,
        size: UVec2,
        limit: UVec2,
    ) -> (SystemTextures<'_>, &mut InputGroups) {
        let targets = plan.texels.targets();
        let has_pixels = targets.iter().flatten().any(|planned| planned.target.extent == Extent::Pixels);
        let key = AccumulationKey {
            format: settings.accumulate.format,
            attachments: AttachmentSet::of(settings),
            is_host_sized: settings.accumulate.depth_source == DepthSource::Host,
            overdraw: plan.overdraw.is_some(),
            tiled: plan.tiled.is_some(),
            pixels_scale: has_pixels.then_some(settings.scale),
            targets,
        };
        let (accumulation, is_new) = AccumulationTarget::ensure(&mut self.accumulation, device, key, size, limit);
        let (baked_diffuse, is_newly_baked) =
            BakedDiffuse::ensure(&mut self.baked_diffuse, device, settings.diffuse.mode);
        if is_new || is_newly_baked {
            self.inputs.clear();
        }
        (SystemTextures { accumulation, baked_diffuse }, &mut self.inputs)
    }

    /// Returns the textures, if they exist.
    pub fn textures(&self) -> Option<SystemTextures<'_>> {
        let accumulation = self.accumulation.as_ref()?;
        let baked_diffuse = self.baked_diffuse.as_ref()?;
        Some(SystemTextures { accumulation, baked_diffuse })
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        let accumulation = self.accumulation.as_ref().map_or(0, |target| target.bytes);
        accumulation + self.baked_diffuse.as_ref().map_or(0, |baked| baked.bytes)
    }
}
