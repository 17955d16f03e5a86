//! haze's renderers, one for each view.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use bevy::camera::visibility::RenderLayers;
use bevy::ecs::prelude::*;
use bevy::log::error;
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::sync_world::MainEntity;
use bevy::render::view::ExtractedView;
use haze::preset::MAX_SYSTEMS;
use haze::{Context, PrepareError, Renderer, RendererDescriptor};

use crate::composite::CompositeBinding;
use crate::extract::{ExtractedSmoke, ExtractedSmokes};

/// Everything of haze that lasts from frame to frame. Made again with every device.
#[derive(Resource)]
pub(crate) struct SmokeRenderers {
    pub context: Context,
    views: HashMap<Entity, ViewRenderer>,
}

/// Renderer of one view.
pub(crate) struct ViewRenderer {
    pub pass: PassFormat,
    pub renderer: Renderer,
    /// Keys of the systems in sight, far to near, for each entity with smoke.
    pub drawn: HashMap<MainEntity, Vec<u64>>,
    /// Bindings of the composite, for views that are tonemapped in the shader of each mesh.
    pub composite: Option<CompositeBinding>,
    /// Errors since the last frame without one, which have been logged.
    reported: Vec<String>,
}

/// Pass that a renderer draws in.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct PassFormat {
    pub color: TextureFormat,
    pub depth: TextureFormat,
    pub samples: u32,
    /// Format of the view's color.
    pub scene_color: TextureFormat,
    /// True if the pass is not Bevy's, but one whose light is composited.
    pub composited: bool,
}

impl FromWorld for SmokeRenderers {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>();
        let queue = world.resource::<RenderQueue>();
        Self { context: Context::new(device.wgpu_device(), queue), views: HashMap::new() }
    }
}

impl SmokeRenderers {
    /// Renderer of a view whose pass has this format.
    pub fn ensure(&mut self, view: Entity, pass: PassFormat) -> Result<&mut ViewRenderer, PrepareError> {
        match self.views.entry(view) {
            Entry::Occupied(kept) if kept.get().pass == pass => Ok(kept.into_mut()),
            entry => {
                let descriptor = RendererDescriptor {
                    color_format: pass.color,
                    depth_format: Some(pass.depth),
                    sample_count: pass.samples,
                    scene_color_format: Some(pass.scene_color),
                    ..RendererDescriptor::default()
                };
                let renderer = Renderer::new(&self.context, &descriptor)?;
                let drawn = HashMap::new();
                let made = ViewRenderer { pass, renderer, drawn, composite: None, reported: Vec::new() };
                Ok(entry.insert_entry(made).into_mut())
            }
        }
    }

    /// Lets a view show nothing in this frame.
    pub fn clear_drawn(&mut self, view: Entity) {
        if let Some(kept) = self.views.get_mut(&view) {
            kept.drawn.clear();
            kept.composite = None;
        }
    }

    pub fn get(&self, view: Entity) -> Option<&ViewRenderer> {
        self.views.get(&view)
    }
}

impl ViewRenderer {
    /// Logs an error unless it has been logged. Its field identifies it: its numbers may change.
    pub fn report(&mut self, view: MainEntity, error: &PrepareError) {
        let identity = match error {
            PrepareError::Field(error) => error.field.clone(),
            other => other.to_string(),
        };
        if !self.reported.contains(&identity) {
            error!("smoke in camera {}: {error}", view.id());
            self.reported.push(identity);
        }
    }

    /// Lets errors be logged again.
    pub fn report_success(&mut self) {
        self.reported.clear();
    }
}

/// Key of a system of an entity's smoke: unique among the entities that exist at one time.
pub(crate) fn system_key(entity: MainEntity, system: usize) -> u64 {
    let entity = entity.id();
    let generation = u64::from(entity.generation().to_bits());
    let per_entity = MAX_SYSTEMS as u64;
    // The shift drops the upper bits of the generation; generations that follow each other differ in the lowest bit.
    (u64::from(entity.index_u32()) * per_entity + system as u64 % per_entity) | generation << (32 + per_entity.ilog2())
}

/// Smoke that a view shows.
pub(crate) fn smokes_in_view<'a>(
    smokes: &'a ExtractedSmokes,
    layers: Option<&'a RenderLayers>,
) -> impl Iterator<Item = &'a ExtractedSmoke> {
    let layers = layers.unwrap_or_default();
    smokes.smokes.iter().filter(|smoke| smoke.layers.intersects(layers))
}

/// Drops the renderers of cameras that are gone.
pub(crate) fn drop_renderers(
    mut renderers: ResMut<SmokeRenderers>,
    cameras: Query<(), (With<ExtractedCamera>, With<ExtractedView>)>,
) {
    renderers.views.retain(|view, _| cameras.contains(*view));
}
