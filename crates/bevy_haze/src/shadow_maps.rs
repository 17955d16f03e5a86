//! Bevy's shadow maps for haze: cascades of directional lights, maps of spot lights, cubes of point lights.
//!
//! Bevy does not tell which layer of a texture belongs to which light. The layers are derived here as Bevy's `prepare_lights`
//! assigns them: cascades in the order of the view's `ViewLightEntities`; after the most cascades of any view, spot lights by
//! entity; in a texture of their own, point lights by entity; volumetric ones first.

use std::collections::HashMap;

use bevy::ecs::prelude::*;
use bevy::ecs::system::SystemParam;
use bevy::math::{Mat4, Vec3};
use bevy::pbr::{ExtractedDirectionalLight, ExtractedPointLight, LightEntity, ViewLightEntities, ViewShadowBindings};
use bevy::render::render_resource::Texture;
use bevy::render::view::ExtractedView;
use haze::{MAX_SHADOW_LAYERS, ShadowMap, ShadowProjection, glam};

use crate::convert;
use crate::lights::SceneLight;

/// Distance in front of smoke from which a surface shades it, metres: less than a cell of haze's grid.
const BIAS: f32 = 0.05;

/// Views of the render world that draw shadow maps.
#[derive(SystemParam)]
pub(crate) struct ShadowViews<'w, 's> {
    views: Query<'w, 's, (&'static LightEntity, &'static ExtractedView)>,
    points: Query<'w, 's, (Entity, &'static ExtractedPointLight)>,
    suns: Query<'w, 's, &'static ExtractedDirectionalLight>,
}

/// Map of one light of a frame.
pub(crate) struct LightShadow<'a> {
    texture: &'a Texture,
    first_layer: u32,
    clip_from_world: Vec<glam::Mat4>,
    /// Index of the light in the frame.
    light: usize,
    bias: f32,
}

impl LightShadow<'_> {
    pub fn map(&self) -> ShadowMap<'_> {
        let Self { texture, first_layer, clip_from_world, light, bias } = self;
        let projection = ShadowProjection { light: *light, clip_from_world, reversed: true, bias: *bias };
        ShadowMap { depth: texture, first_layer: *first_layer, projection }
    }
}

impl ShadowViews<'_, '_> {
    /// Maps of those lights that have one. `smoke`: a point in the smoke. `first_light`: index of the first of `lights` in
    /// the frame.
    pub fn maps<'a>(
        &self,
        lights: &[SceneLight],
        first_light: usize,
        view_lights: &ViewLightEntities,
        bindings: &'a ViewShadowBindings,
        smoke: Vec3,
    ) -> Vec<LightShadow<'a>> {
        let layers = bindings.directional_light_depth_texture.size().depth_or_array_layers;
        let cubes = self.mapped_points(false);
        let spots = self.mapped_points(true);
        let faces = self.faces_by_light();
        let shadow = |(index, light): (usize, &SceneLight)| {
            let entity = light.entity;
            let position = |list: &[Entity]| list.iter().position(|listed| *listed == entity);
            let (texture, first_layer, clip_from_world) = if self.suns.contains(entity) {
                let (first_layer, cascades) = self.cascades(entity, view_lights)?;
                (&bindings.directional_light_depth_texture, first_layer, cascades)
            } else if let Some(position) = position(&spots) {
                let first_layer = (layers + position as u32).checked_sub(spots.len() as u32)?;
                (&bindings.directional_light_depth_texture, first_layer, faces.get(&entity)?.clone())
            } else {
                let first_layer = position(&cubes)? as u32 * 6;
                (&bindings.point_light_depth_texture, first_layer, faces.get(&entity)?.clone())
            };
            let last = first_layer + clip_from_world.len() as u32;
            let fits = (1..=MAX_SHADOW_LAYERS).contains(&clip_from_world.len())
                && last <= texture.size().depth_or_array_layers
                && clip_from_world.iter().all(Mat4::is_finite);
            let bias = clip_from_world.first().map_or(0.0, |clip| bias(clip, smoke));
            fits.then(|| {
                let clip_from_world = clip_from_world.iter().copied().map(convert::mat4).collect();
                LightShadow { texture, first_layer, clip_from_world, light: first_light + index, bias }
            })
        };
        lights.iter().enumerate().filter_map(shadow).collect()
    }

    /// Point or spot lights with a map, in the order of their layers.
    fn mapped_points(&self, is_spot: bool) -> Vec<Entity> {
        let mapped =
            |light: &ExtractedPointLight| light.shadow_maps_enabled && light.spot_light_angles.is_some() == is_spot;
        let mut mapped: Vec<_> = self.points.iter().filter(|(_, light)| mapped(light)).collect();
        mapped.sort_by_key(|(entity, light)| (!light.volumetric, *entity));
        mapped.into_iter().map(|(entity, _)| entity).collect()
    }

    /// Matrices of spot and point lights, faces in order.
    fn faces_by_light(&self) -> HashMap<Entity, Vec<Mat4>> {
        let mut faces: HashMap<Entity, Vec<(usize, Mat4)>> = HashMap::new();
        for (light, view) in &self.views {
            let (light, face) = match *light {
                LightEntity::Point { light_entity, face_index } => (light_entity, face_index),
                LightEntity::Spot { light_entity } => (light_entity, 0),
                LightEntity::Directional { .. } => continue,
            };
            faces.entry(light).or_default().push((face, clip_from_world(view)));
        }
        let sorted = |mut faces: Vec<(usize, Mat4)>| {
            faces.sort_by_key(|(face, _)| *face);
            faces.into_iter().map(|(_, matrix)| matrix).collect()
        };
        faces.into_iter().map(|(light, faces)| (light, sorted(faces))).collect()
    }

    /// First layer and matrices of a directional light's cascades in a view.
    fn cascades(&self, sun: Entity, view_lights: &ViewLightEntities) -> Option<(u32, Vec<Mat4>)> {
        let views = view_lights.lights.iter().map(|view| self.views.get(*view).ok());
        let mut first = None;
        let mut matrices = Vec::new();
        for (layer, view) in views.enumerate() {
            if let Some((LightEntity::Directional { light_entity, .. }, view)) = view
                && *light_entity == sun
            {
                first.get_or_insert(layer as u32);
                matrices.push(clip_from_world(view));
            }
        }
        Some((first?, matrices))
    }
}

fn clip_from_world(view: &ExtractedView) -> Mat4 {
    view.clip_from_world.unwrap_or_else(|| view.clip_from_view * view.world_from_view.to_matrix().inverse())
}

/// [`BIAS`] in units of a map: the change of its depth over that distance towards the light, at the smoke. For the depth
/// z/w, it is |∇z − (z/w) ∇w| / w.
fn bias(clip_from_world: &Mat4, smoke: Vec3) -> f32 {
    let clip = *clip_from_world * smoke.extend(1.0);
    let depth = clip_from_world.row(2).truncate();
    let weight = clip_from_world.row(3).truncate();
    let w = clip.w.abs().max(1.0e-3);
    let slope = (depth - weight * (clip.z / w)).length() / w;
    if slope.is_finite() { BIAS * slope } else { 0.0 }
}
