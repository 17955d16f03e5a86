//! Variants of tile_accumulate by the formats of its targets. WGSL and bind group layouts declare the format of a storage
//! texture, so each combination of formats has a module, a layout and pipelines of its own, created on first use.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use haze_core::error::PrepareError;
use haze_core::glam::UVec2;
use haze_core::view_setup::MAX_TARGET_ATTACHMENTS;

use crate::renderer::gpu::pipeline::{PipelineStore, Shader};
use crate::renderer::layouts::Layouts;
use crate::renderer::pass::tile_accumulate::{self, TileAccumulateKey};
use crate::renderer::pipeline_variants::PipelineVariants;
use crate::renderer::targets::{PLACEHOLDER_FORMAT, TiledFormats, single_target};

/// Variants of tile_accumulate.
#[derive(Debug)]
pub(crate) struct AccumulateVariants {
    /// Shader in which all targets have the placeholders' format.
    shader: Shader,
    /// Layouts of groups 0 to 2.
    groups: [wgpu::BindGroupLayout; 3],
    store: PipelineStore,
    /// Textures of one texel, bound instead of textures that a system does not have. One per slot, because no texture
    /// may be bound for writing twice.
    pub placeholders: [wgpu::TextureView; MAX_TARGET_ATTACHMENTS],
    /// Shared by contexts with the same shader.
    variants: Arc<Mutex<HashMap<TiledFormats, Arc<PipelineVariants<TileAccumulateKey>>>>>,
}

impl AccumulateVariants {
    pub fn new(store: &PipelineStore, layouts: &Layouts, shader: Shader) -> Self {
        let written = wgpu::TextureUsages::STORAGE_BINDING;
        let placeholder = || single_target(&store.device, "haze unwritten", PLACEHOLDER_FORMAT, UVec2::ONE, written);
        Self {
            shader,
            groups: [layouts.frame.clone(), layouts.system.clone(), layouts.material.clone()],
            store: store.clone(),
            placeholders: std::array::from_fn(|_| placeholder()),
            variants: Arc::default(),
        }
    }

    /// Shares the variants of another context if its module is the same.
    pub fn share(&mut self, other: &Self) {
        if self.shader.is_same(&other.shader) {
            self.variants = other.variants.clone();
        }
    }

    /// Returns the variant for these formats; creates it on first use. The lock is not held during creation, so other
    /// threads do not wait.
    pub fn get(&self, formats: TiledFormats) -> Arc<PipelineVariants<TileAccumulateKey>> {
        let found = self.lock().get(&formats).cloned();
        found.unwrap_or_else(|| {
            let created = Arc::new(self.create(formats));
            self.lock().entry(formats).or_insert(created).clone()
        })
    }

    /// Compiles the pipeline for `key`, or returns the shader error.
    pub fn check(&self, key: TileAccumulateKey) -> Result<(), PrepareError> {
        self.get(key.formats()).check(key)
    }

    /// Returns the pipeline for `key`; compiles it on first use.
    pub fn pipeline(&self, key: TileAccumulateKey) -> wgpu::ComputePipeline {
        self.get(key.formats()).get(key)
    }

    fn create(&self, formats: TiledFormats) -> PipelineVariants<TileAccumulateKey> {
        let mut shader = self.shader.clone();
        if formats != [PLACEHOLDER_FORMAT; MAX_TARGET_ATTACHMENTS] {
            shader = shader.with_text(|text| {
                (0..).zip(formats).fold(text.to_owned(), |text, (slot, format)| {
                    text.replace(&target_declaration(slot, PLACEHOLDER_FORMAT), &target_declaration(slot, format))
                })
            });
        }
        PipelineVariants::with_inputs(&self.store, &self.groups.each_ref(), shader, &tile_accumulate::inputs(formats))
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<TiledFormats, Arc<PipelineVariants<TileAccumulateKey>>>> {
        self.variants.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the declaration of a target in `shaders/tile_accumulate.wgsl`.
fn target_declaration(slot: usize, format: wgpu::TextureFormat) -> String {
    // WGSL's names of formats are wgpu's in lower case.
    let format = format!("{format:?}").to_lowercase();
    format!("var texture_{slot}: texture_storage_2d<{format}, write>;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_declares_each_target_in_the_placeholders_format() {
        let text = include_str!("../../../shaders/tile_accumulate.wgsl");
        for slot in 0..MAX_TARGET_ATTACHMENTS {
            assert_eq!(text.matches(&target_declaration(slot, PLACEHOLDER_FORMAT)).count(), 1, "{slot}");
        }
        assert_eq!(text.matches("texture_storage_2d<").count(), MAX_TARGET_ATTACHMENTS);
    }
}
