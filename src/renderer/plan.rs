//! Plan of a system's passes and pipeline keys, decided from plain data before any device call.

use haze_core::assets::ramp_steps::RampSteps;
use haze_core::formula::diffuse_bake::baked_size_and_layers;
use haze_core::glam::UVec2;
use haze_core::settings::{
    BlendMode, BlendOrder, DebugView, DepthSource, DiffuseMode, LightingResolution, RenderPath, Settings, Technique,
    Traversal, Upsample,
};
use haze_core::view_setup::{AttachmentSet, ResolvedSettings, Support};

use super::gpu::host_pass::HostPass;
use super::pass::TexelPlan;
use super::pass::accumulate::{AccumulateKey, DepthTest};
use super::pass::depth_downsample::{DepthCopyKey, DepthDownsampleKey};
use super::pass::depth_resolve::RESOLVED_DEPTH_FORMAT;
use super::pass::depth_slopes::DepthSlopesKey;
use super::pass::diffuse_bake::DiffuseBakeKey;
use super::pass::forward::ForwardKey;
use super::pass::light_target::LightingKey;
use super::pass::mark_cells::MarkCellsKey;
use super::pass::specular_scatter::SpecularScatterKey;
use super::pass::sprite_instances::SpriteKey;
use super::pass::texel_pass::Planned;
use super::pass::tile_accumulate::{TileAccumulateKey, TraversalMode};
use super::pass::tile_project::TileProjectKey;
use super::pass::transfer::{BoundingBoxKey, TransferKey};
use super::pass::transfer_lit::{Tiles, TransferLitKey};
use super::pass::upsample_lit::{LitPixelKey, UpsampleLitKey};
use super::tiled::TiledKeys;
use crate::frame::SceneDepth;

/// Kind of scene depth that a host supplies, and the format of the depth buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneDepthKind {
    /// [`SceneDepth::Buffer`].
    Buffer(wgpu::TextureFormat),
    /// [`SceneDepth::Multisampled`].
    Multisampled,
    /// [`SceneDepth::Linear`].
    Linear,
    /// [`SceneDepth::BufferAndLinear`].
    BufferAndLinear(wgpu::TextureFormat),
}

impl SceneDepth<'_> {
    /// Returns the kind of this scene depth.
    pub fn kind(&self) -> SceneDepthKind {
        match self {
            Self::Buffer(view) => SceneDepthKind::Buffer(view.texture().format()),
            Self::Multisampled(_) => SceneDepthKind::Multisampled,
            Self::Linear(_) => SceneDepthKind::Linear,
            Self::BufferAndLinear { buffer, .. } => SceneDepthKind::BufferAndLinear(buffer.texture().format()),
        }
    }
}

/// Inputs that all systems of a frame share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PipelineInputs<'a> {
    pub host: HostPass,
    pub exact_filtering: bool,
    /// True if one pass can test and sample the same depth buffer.
    pub read_only_depth: bool,
    /// True if the traversal of tiles is cooperative, false if it is per invocation; `None` without the path `tiled`.
    pub tiles: Option<bool>,
    /// As [`PathModel::computes_pixels`](super::auto::PathModel).
    pub computes_pixels: bool,
    pub scene_depth: SceneDepthKind,
    /// True if the depth buffer stores the near plane as 1.
    pub reversed: bool,
    /// True if the view mirrors.
    pub mirrored: bool,
    /// Debug views that may be shown.
    pub debug_views: &'a [DebugView],
}

/// Passes and pipeline keys of one system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::large_enum_variant, reason = "only one exists at a time, on the stack")]
pub(crate) enum Plan<'a> {
    /// The path `forward` has no intermediate values to show.
    Skip,
    Forward(ForwardPlan),
    Deferred(DeferredPlan<'a>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ForwardPlan {
    /// True if the scene depth is read from the linear target instead of the depth buffer.
    pub reads_linear: bool,
    pub key: ForwardKey,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DeferredPlan<'a> {
    /// As in [`ForwardPlan`].
    pub reads_linear: bool,
    pub diffuse_bake: Option<DiffuseBakeKey>,
    pub accumulate: AccumulateKey,
    /// Compute passes that replace `accumulate`.
    pub tiled: Option<TiledKeys>,
    /// Accumulation variant that counts layers.
    pub overdraw: Option<AccumulateKey>,
    /// Passes over texels: depth_copy for the coarse copy of the reduced depth, light_target if smoke is lit at the target's
    /// resolution, depth_slopes if lit smoke is upsampled by `guided`, mark_cells if light_target is drawn, upsample_lit if the
    /// pixels that transfer_lit draws are computed.
    pub texels: TexelPlan,
    /// Key of the debug view `Final`; `transfers` derives the keys of all debug views from it.
    pub transfer: TransferKey,
    /// Key of the debug view `Final` and of all tiles, if smoke is lit at the target's resolution; see `lit_transfers`.
    pub transfer_lit: Option<TransferLitKey>,
    /// True if transfer_lit draws tiles with and without slopes by a pipeline each.
    pub splits_tiles: bool,
    pub debug_views: &'a [DebugView],
    pub specular_scatter: Option<SpecularScatterKey>,
}

/// Plans the passes of a system. `back_faces`: true if the near plane cuts its bounding box, or its sprites show
/// through the scene.
pub(crate) fn plan<'a>(inputs: &PipelineInputs<'a>, settings: &ResolvedSettings, back_faces: bool) -> Plan<'a> {
    let reads_linear = reads_linear_target(inputs.scene_depth, inputs.read_only_depth, settings);
    if !settings.is_forward() {
        return Plan::Deferred(deferred(inputs, settings, back_faces, reads_linear));
    }
    if !inputs.debug_views.iter().any(|debug_view| debug_view.shows_lit_smoke()) {
        return Plan::Skip;
    }
    let key = ForwardKey {
        host: inputs.host,
        blend_mode: settings.blend_mode,
        sprite: SpriteKey::new(settings, reads_linear, inputs.exact_filtering),
        shows_through: settings.show_through_distance() > 0.0,
        soft_scatter_mode: settings.soft_scatter.mode,
        backlight: settings.diffuse.backlight,
        ambient: settings.has_ambient(),
        shadow_blocks: settings.shadow_blocks(),
        reversed: inputs.reversed,
    };
    Plan::Forward(ForwardPlan { reads_linear, key })
}

/// Returns plans that together use every pass, for a minimal host pass.
pub(crate) fn plans_covering_every_pass(read_only_depth: bool, tiles: Option<bool>) -> [Plan<'static>; 4] {
    let depth_format = wgpu::TextureFormat::Depth32Float;
    let inputs = PipelineInputs {
        host: HostPass { depth_format: Some(depth_format), ..HostPass::color_only(wgpu::TextureFormat::Rgba8Unorm) },
        exact_filtering: false,
        read_only_depth,
        tiles,
        computes_pixels: false,
        scene_depth: SceneDepthKind::Buffer(depth_format),
        reversed: false,
        mirrored: false,
        debug_views: &[DebugView::Final],
    };
    let mut deferred = Settings::default();
    deferred.diffuse.mode = DiffuseMode::Cubemap;
    deferred.accumulate.lighting_resolution = LightingResolution::Full;
    let mut lit = deferred;
    lit.accumulate.lighting_resolution = LightingResolution::Target;
    lit.diffuse.mode = DiffuseMode::Ramp;
    lit.shadow.strength = 1.0;
    let forward = Settings { path: RenderPath::Forward, ..Settings::default() };
    let tiled = Settings { path: RenderPath::Tiled, ..Settings::default() };
    [(deferred, false), (lit, false), (forward, false), (tiled, true)].map(|(settings, computes_pixels)| {
        plan(
            &PipelineInputs { computes_pixels, ..inputs },
            &ResolvedSettings::new(&settings, 1.0, UVec2::ONE, 2.0, &RampSteps::default(), Support::ALL),
            false,
        )
    })
}

fn deferred<'a>(
    inputs: &PipelineInputs<'a>,
    settings: &ResolvedSettings,
    back_faces: bool,
    reads_linear: bool,
) -> DeferredPlan<'a> {
    let accumulate = &settings.accumulate;
    let debug_views = inputs.debug_views;
    let host = inputs.host;
    let ramp_filter = settings.ramp_filter;
    let exact_filtering = inputs.exact_filtering;
    let depth_test = depth_test(inputs, settings);
    let mode = accumulate.depth_downsample;
    let bakes = !settings.is_six_way() && baked_size_and_layers(settings.diffuse.mode).is_some();
    let tiled = inputs.tiles.filter(|_| settings.path == RenderPath::Tiled);
    let overdraw = debug_views.contains(&DebugView::Overdraw);
    // At scale 1 a compute shader reads the host's depth in place. The hardware, which counts layers, cannot test it there: all
    // attachments of a pass must have one size.
    let in_place = tiled.is_some() && settings.scale == 1 && !overdraw;
    let host_depth = accumulate.depth_source == DepthSource::Host || in_place;
    // Cooperative: on a GPU. Where computing is not slower than drawing it can be far faster: server GPUs draw with a few of
    // their processors only.
    let computes_texels = tiled.is_some() || inputs.tiles == Some(true);
    // At scale 1 a texel is a pixel, whose light can be computed too.
    let is_lit = settings.lights_per_texel() || (computes_texels && settings.scale == 1);
    let lights_target = is_lit && debug_views.iter().any(|view| view.shows_lit_smoke() || view.shows_glow());
    let lighting = LightingKey {
        encoding: accumulate.encoding,
        decode: accumulate.decode,
        attachments: AttachmentSet::of(settings),
        shadow_blocks: settings.shadow_blocks(),
        diffuse_mode: settings.diffuse.mode,
        soft_scatter_mode: settings.soft_scatter.mode,
        backlight: settings.diffuse.backlight,
        ambient: settings.has_ambient(),
        ramp_filter,
        exact_filtering,
    };
    let upsample = accumulate.upsample;
    let coverage = settings.coverage;
    let is_additive = settings.blend_mode == BlendMode::Additive;
    let drawn = BoundingBoxKey {
        host,
        // Without a depth attachment, the hardware cannot hide the box behind the scene, so front faces have no
        // advantage; back faces are never clipped by the near plane.
        back_faces: back_faces || host.depth_format.is_none(),
        reversed: inputs.reversed,
        mirrored: inputs.mirrored,
    };
    let glows =
        debug_views.iter().any(|debug_view| debug_view.shows_glow()) && settings.specular_scatter.intensity > 0.0;
    let accumulate_key = AccumulateKey {
        format: accumulate.format,
        encoding: accumulate.encoding,
        order: accumulate.order,
        attachments: AttachmentSet::of(settings),
        sprite: SpriteKey::new(settings, reads_linear, exact_filtering),
        host_depth,
        depth_test,
        overdraw: false,
    };
    let is_coarse = settings.scale > 1;
    let has_slopes = lights_target && upsample == Upsample::Guided && is_coarse;
    let glows_in_pixels = computes_texels && glows;
    let pixel = LitPixelKey {
        glows: glows_in_pixels,
        coarse: glows_in_pixels && is_coarse,
        upsample,
        coverage,
        is_additive,
        ramp_filter,
        exact_filtering,
    };
    let slope_cells = has_slopes && !exact_filtering;
    // One image for all debug views that show it.
    let same_pixels = !glows || debug_views.iter().all(|view| view.shows_glow() || !view.shows_lit_smoke());
    // At scale 1, a pixel is hardly more than its lit texel.
    let computes_pixels = inputs.computes_pixels && computes_texels && lights_target && is_coarse && same_pixels;
    DeferredPlan {
        reads_linear,
        diffuse_bake: bakes.then_some(DiffuseBakeKey {
            mode: settings.diffuse.mode,
            backlight: settings.diffuse.backlight,
            ambient: settings.has_ambient(),
            ramp_filter,
            exact_filtering,
        }),
        accumulate: accumulate_key,
        tiled: tiled.map(|cooperative| tiled_keys(&accumulate_key, accumulate.layers, cooperative, exact_filtering)),
        overdraw: overdraw.then_some(AccumulateKey { overdraw: true, ..accumulate_key }),
        texels: TexelPlan {
            // Hardware that counts layers tests the depth as well.
            depth_downsample: (!host_depth)
                .then_some(Planned { key: DepthDownsampleKey { mode }, computed: tiled.is_some() && !overdraw }),
            depth_copy: (depth_test == DepthTest::Copy).then_some(Planned::drawn(DepthCopyKey { mode })),
            light_target: lights_target.then_some(Planned { key: lighting, computed: computes_texels }),
            depth_slopes: has_slopes.then_some(Planned { key: DepthSlopesKey, computed: computes_texels }),
            mark_cells: (lights_target && !computes_texels)
                .then_some(Planned::drawn(MarkCellsKey { slopes: has_slopes })),
            upsample_lit: computes_pixels.then_some(Planned::computed(UpsampleLitKey { slope_cells, pixel })),
        },
        transfer: TransferKey {
            drawn,
            lighting,
            upsample,
            host_depth,
            debug_view: DebugView::Final,
            coverage,
            is_additive,
        },
        transfer_lit: lights_target.then_some(TransferLitKey {
            drawn,
            tiles: Tiles::All,
            computed: computes_pixels,
            pixel,
        }),
        splits_tiles: slope_cells && !computes_pixels,
        debug_views,
        specular_scatter: glows.then_some(SpecularScatterKey {
            host,
            lit: lights_target,
            coarse: is_coarse,
            upsample,
            ramp_filter,
            exact_filtering,
        }),
    }
}

fn tiled_keys(key: &AccumulateKey, layers: Traversal, cooperative: bool, exact_filtering: bool) -> TiledKeys {
    let &AccumulateKey { format, encoding, order, attachments, sprite, host_depth, .. } = key;
    let weighted = order == BlendOrder::Weighted;
    TiledKeys {
        project: TileProjectKey { sprite, weighted },
        accumulate: TileAccumulateKey {
            sprite,
            format,
            encoding,
            weighted,
            attachments,
            host_depth,
            // With weighted normals every sprite counts, even behind opaque smoke.
            stops: layers == Traversal::UntilOpaque && !weighted,
            // Per-invocation traversal loads sprite texels in its own way, which is not the reference's filter.
            traversal: match cooperative || exact_filtering {
                true => TraversalMode::Cooperative,
                false => TraversalMode::PerInvocation,
            },
        },
    }
}

/// Selects the depth test that rejects hidden sprites before shading.
fn depth_test(inputs: &PipelineInputs, settings: &Settings) -> DepthTest {
    if settings.show_through_distance() > 0.0 {
        return DepthTest::InShader;
    }
    if settings.accumulate.depth_source == DepthSource::Reduced {
        return if inputs.read_only_depth { DepthTest::Reduced } else { DepthTest::Copy };
    }
    match inputs.scene_depth {
        SceneDepthKind::Buffer(format) | SceneDepthKind::BufferAndLinear(format) => {
            DepthTest::Host(format, inputs.reversed)
        }
        SceneDepthKind::Multisampled => DepthTest::Host(RESOLVED_DEPTH_FORMAT, inputs.reversed),
        // `validate` refuses this case.
        SceneDepthKind::Linear => DepthTest::InShader,
    }
}

/// Returns true if a system reads the scene's linear target instead of its depth buffer.
pub(crate) fn reads_linear_target(scene_depth: SceneDepthKind, read_only_depth: bool, settings: &Settings) -> bool {
    match scene_depth {
        SceneDepthKind::Buffer(_) | SceneDepthKind::Multisampled => false,
        SceneDepthKind::Linear => true,
        // A backend that cannot test and sample one depth buffer samples the linear target and only tests the buffer.
        SceneDepthKind::BufferAndLinear(_) => settings.technique == Technique::SoftLinear || !read_only_depth,
    }
}

impl DeferredPlan<'_> {
    /// Returns the transfer keys of all debug views that transfer draws.
    pub fn transfers(&self) -> impl Iterator<Item = TransferKey> {
        let drawn =
            |debug_view: &&DebugView| **debug_view != DebugView::SpecularScatter && !self.draws_lit(**debug_view);
        self.debug_views.iter().filter(drawn).map(|&debug_view| TransferKey { debug_view, ..self.transfer })
    }

    /// Returns the debug views that transfer_lit draws, with the keys of their pipelines.
    pub fn lit_transfers(&self) -> impl Iterator<Item = (DebugView, [Option<TransferLitKey>; 2])> {
        let drawn = self.debug_views.iter().filter(|debug_view| self.draws_lit(**debug_view));
        drawn.zip(self.transfer_lit.into_iter().cycle()).map(|(&debug_view, key)| {
            let pixel = LitPixelKey { glows: key.pixel.glows && debug_view.shows_glow(), ..key.pixel };
            let of_tiles = |tiles: Tiles| TransferLitKey { tiles, pixel, ..key };
            (debug_view, Tiles::of_frame(self.splits_tiles).map(|tiles| tiles.map(of_tiles)))
        })
    }

    /// Returns true if transfer_lit adds the glow of lights.
    pub fn glows_in_transfer(&self) -> bool {
        self.transfer_lit.is_some_and(|key| key.pixel.glows)
    }

    /// Returns true if transfer_lit draws a debug view. Those that show a part of the light need transfer.
    pub fn draws_lit(&self, debug_view: DebugView) -> bool {
        self.transfer_lit.is_some() && debug_view.shows_lit_smoke()
    }
}

impl Plan<'_> {
    /// Returns true if smoke shades the system.
    pub fn receives_shadow(&self) -> bool {
        match self {
            Self::Skip => false,
            Self::Forward(plan) => plan.key.sprite.receives_shadow(),
            Self::Deferred(plan) => plan.accumulate.sprite.receives_shadow(),
        }
    }

    /// Returns true if the plan reads the scene's linear target.
    pub fn reads_linear_target(&self) -> bool {
        match self {
            Self::Skip => false,
            Self::Forward(plan) => plan.reads_linear,
            Self::Deferred(plan) => plan.reads_linear,
        }
    }
}

#[cfg(test)]
mod tests;
