//! Presets on the GPU.

use std::sync::Arc;

use bevy::asset::AssetId;
use bevy::ecs::system::SystemParamItem;
use bevy::ecs::system::lifetimeless::SRes;
use bevy::log::error;
use bevy::render::render_asset::{PrepareAssetError, RenderAsset};
use haze::preset::PresetSystem;
use haze::{Material, MaterialAssets};

use crate::asset::SmokeAsset;
use crate::renderers::SmokeRenderers;

/// Preset whose images are on the GPU. If they cannot be uploaded, the last ones stay.
#[derive(Clone)]
pub(crate) struct GpuSmoke {
    pub systems: Arc<[GpuSystem]>,
}

pub(crate) struct GpuSystem {
    pub preset: PresetSystem,
    /// For the light of fire, which the CPU computes.
    pub images: MaterialAssets,
    pub material: Material,
}

impl RenderAsset for GpuSmoke {
    type SourceAsset = SmokeAsset;
    type Param = SRes<SmokeRenderers>;

    fn prepare_asset(
        asset: SmokeAsset,
        _id: AssetId<SmokeAsset>,
        renderers: &mut SystemParamItem<'_, '_, Self::Param>,
        previous: Option<&Self>,
    ) -> Result<Self, PrepareAssetError<SmokeAsset>> {
        let upload = |system: crate::asset::SmokeSystem| {
            let material = renderers.context.create_material(&system.images)?;
            Ok(GpuSystem { preset: system.preset, images: system.images, material })
        };
        match asset.systems.into_iter().map(upload).collect::<Result<Vec<_>, haze::PrepareError>>() {
            Ok(systems) => Ok(Self { systems: systems.into() }),
            Err(error) => {
                error!("smoke: {error}");
                Ok(previous.cloned().unwrap_or(Self { systems: Arc::new([]) }))
            }
        }
    }
}
