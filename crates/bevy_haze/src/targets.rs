//! Textures that smoke needs in a view beside Bevy's own.

use std::collections::HashMap;

use bevy::camera::Camera3d;
use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_resource::{Extent3d, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages};
use bevy::render::renderer::RenderDevice;
use bevy::render::texture::{CachedTexture, TextureCache};
use bevy::render::view::Msaa;

use crate::extract::ExtractedSmokes;

/// Format of the light of the smoke, before it is tonemapped.
pub(crate) const LIGHT_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Textures of one view. Views that share a target share them: their commands follow each other.
#[derive(Component, Clone)]
pub(crate) struct SmokeTargets {
    /// Copy of the opaque depth, which haze reads while Bevy's pass is attached to the original. `None` with
    /// multisampling: there, haze resolves the depth into a texture of its own.
    pub depth_copy: Option<CachedTexture>,
    /// Light of the smoke, premultiplied, for views that are tonemapped in the shader of each mesh.
    pub light: Option<LightTarget>,
}

#[derive(Clone)]
pub(crate) struct LightTarget {
    /// As many samples as the view.
    pub color: CachedTexture,
    /// One sample, if the view has more.
    pub resolved: Option<CachedTexture>,
}

impl LightTarget {
    /// Texture that the composite reads.
    pub fn source(&self) -> &CachedTexture {
        self.resolved.as_ref().unwrap_or(&self.color)
    }
}

/// True if smoke is drawn straight into the view's color. False if Bevy tonemaps in the shader of each mesh, which it does
/// without [`Hdr`](bevy::camera::Hdr).
pub(crate) fn draws_directly(camera: &ExtractedCamera, tonemapping: Option<&Tonemapping>) -> bool {
    camera.hdr || !tonemapping.is_some_and(Tonemapping::is_enabled)
}

/// Lets haze read the depth of every 3D camera.
pub(crate) fn allow_depth_reads(mut cameras: Query<&mut Camera3d>) {
    let read = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
    for mut camera in &mut cameras {
        let usages = TextureUsages::from(camera.depth_texture_usages);
        if !usages.contains(read) {
            camera.depth_texture_usages = (usages | read).into();
        }
    }
}

pub(crate) fn prepare_targets(
    mut commands: Commands,
    mut cache: ResMut<TextureCache>,
    device: Res<RenderDevice>,
    smokes: Res<ExtractedSmokes>,
    views: Query<(Entity, &ExtractedCamera, &Msaa, Option<&Tonemapping>, Has<SmokeTargets>), With<Camera3d>>,
) {
    let mut shared = HashMap::new();
    for (view, camera, msaa, tonemapping, had_targets) in &views {
        let size = camera.physical_target_size.filter(|_| !smokes.smokes.is_empty());
        let Some(size) = size else {
            if had_targets {
                commands.entity(view).remove::<SmokeTargets>();
            }
            continue;
        };
        let mut get = |label, format, samples, usage| {
            let descriptor = TextureDescriptor {
                label: Some(label),
                size: Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: TextureDimension::D2,
                format,
                usage: usage | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            cache.get(&device, descriptor)
        };
        let direct = draws_directly(camera, tonemapping);
        let samples = msaa.samples();
        let targets = shared.entry((camera.target.clone(), size, samples, direct)).or_insert_with(|| SmokeTargets {
            // haze may attach a depth of its own, RENDER_ATTACHMENT is for its depth_source "host".
            depth_copy: (samples == 1).then(|| {
                let usage = TextureUsages::COPY_DST | TextureUsages::RENDER_ATTACHMENT;
                get("smoke_depth", CORE_3D_DEPTH_FORMAT, 1, usage)
            }),
            light: (!direct).then(|| {
                let usage = TextureUsages::RENDER_ATTACHMENT;
                let resolved = (samples > 1).then(|| get("smoke_light_resolved", LIGHT_FORMAT, 1, usage));
                LightTarget { color: get("smoke_light", LIGHT_FORMAT, samples, usage), resolved }
            }),
        });
        commands.entity(view).insert(targets.clone());
    }
}
