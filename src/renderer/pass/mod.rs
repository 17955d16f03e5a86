//! Passes, one file each: pipeline keys, pipeline parts and recording. A pass receives values (bind groups, buffers,
//! counts, targets) and does not depend on their owner.

pub(crate) mod accumulate;
pub(crate) mod density_splat;
pub(crate) mod depth_downsample;
pub(crate) mod depth_resolve;
pub(crate) mod depth_slopes;
pub(crate) mod depth_sort;
pub(crate) mod diffuse_bake;
pub(crate) mod emit;
pub(crate) mod forward;
pub(crate) mod groups;
pub(crate) mod light_target;
pub(crate) mod mark_cells;
pub(crate) mod measure;
pub(crate) mod screen_shadow;
pub(crate) mod shadow_march;
pub(crate) mod shadow_march_slice;
pub(crate) mod shadow_visibility;
pub(crate) mod shadow_visibility_slice;
pub(crate) mod sort;
pub(crate) mod specular_scatter;
pub(crate) mod sprite_instances;
pub(crate) mod texel_pass;
pub(crate) mod tile_accumulate;
pub(crate) mod tile_bin;
pub(crate) mod tile_gather;
pub(crate) mod tile_project;
pub(crate) mod tile_refine;
pub(crate) mod transfer;
pub(crate) mod transfer_lit;
pub(crate) mod upsample_lit;
pub(crate) mod volume_slices;

use haze_core::error::PrepareError;

use super::gpu::pipeline::{PipelineStore, Shader};
use super::layouts::Layouts;
use super::targets::{PlannedTargets, planned_targets};
use depth_downsample::{DepthCopyKey, DepthDownsampleKey};
use depth_slopes::DepthSlopesKey;
use light_target::LightingKey;
use mark_cells::MarkCellsKey;
use texel_pass::{Planned, TexelInputs, TexelPass, TexelPipelines};
use upsample_lit::UpsampleLitKey;

/// Defines the set of texel passes from their names and keys.
macro_rules! texel_passes {
    ($($pass:ident: $key:ty,)+) => {
        /// Pipelines of the texel passes.
        #[derive(Debug)]
        pub(crate) struct TexelPipelineSet {
            $($pass: TexelPipelines<$key>,)+
        }

        /// Texel passes in the plan of a system.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) struct TexelPlan {
            $(pub $pass: Option<Planned<$key>>,)+
        }

        /// Texel passes of a system in a frame.
        #[derive(Debug)]
        pub(crate) struct TexelPasses {
            $(pub $pass: Option<TexelPass>,)+
        }

        impl TexelPipelineSet {
            /// As [`TexelPipelines::new`].
            pub fn new<E>(
                store: &PipelineStore,
                layouts: &Layouts,
                computes: bool,
                shader: impl Fn(&'static str) -> Result<Shader, E>,
            ) -> Result<Self, E> {
                Ok(Self { $($pass: TexelPipelines::new(store, layouts, computes, &shader)?,)+ })
            }

            /// Shares the pipelines of another context of the device that have the same module.
            pub fn share(&mut self, other: &Self) {
                $(self.$pass.share(&other.$pass);)+
            }

            /// Compiles the pipelines of a plan, or returns the shader error.
            pub fn check(&self, plan: &TexelPlan) -> Result<(), PrepareError> {
                $(plan.$pass.map_or(Ok(()), |planned| self.$pass.check(planned))?;)+
                Ok(())
            }

            /// Builds the passes of a plan.
            pub fn passes(&self, plan: &TexelPlan, system: &mut TexelInputs<'_>) -> TexelPasses {
                TexelPasses { $($pass: plan.$pass.and_then(|planned| self.$pass.pass(planned, system)),)+ }
            }
        }

        impl TexelPlan {
            /// Returns what the passes write.
            pub fn targets(&self) -> PlannedTargets {
                planned_targets(std::iter::empty()$(.chain(self.$pass.into_iter().flat_map(Planned::targets)))+)
            }
        }
    };
}

texel_passes! {
    depth_downsample: DepthDownsampleKey,
    depth_copy: DepthCopyKey,
    light_target: LightingKey,
    depth_slopes: DepthSlopesKey,
    mark_cells: MarkCellsKey,
    upsample_lit: UpsampleLitKey,
}
