//! map_light: measures the light of environment maps. WGSL: `map_light.wgsl`.
//!
//! A map's texels may be on the GPU only: Bevy unloads them, or generates them there. So a compute pass reads the map, and
//! the CPU reads its result some frames later: once for each image and each change of it, and every few frames for maps that
//! Bevy generates, such as that of its atmosphere.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use bevy::asset::AssetId;
use bevy::ecs::prelude::*;
use bevy::image::Image;
use bevy::log::warn_once;
use bevy::math::Vec3;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::TextureId;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::texture::GpuImage;
use haze::{hemisphere_light, wgpu};

use crate::convert;
use crate::environment::{ExtractedEnvironments, HemisphereLight};
use crate::extract::ExtractedSmokes;

/// Frames from one measurement of a generated map to the next.
const GENERATED_INTERVAL: u32 = 8;
/// Mean light, and means weighted by x, y and z: four `vec4f`.
const MEANS_SIZE: u64 = 64;

/// Light of a map, in units of its texels: a white matte surface with the normal n shows `mean + slope · n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapLight {
    mean: Vec3,
    /// Change along x, y and z.
    slope: [Vec3; 3],
}

impl MapLight {
    /// From means over the sphere: of the light, and of the light times x, y and z. The mean of x² is 1/3.
    fn from_means([mean, x, y, z]: [Vec3; 4]) -> Self {
        Self { mean, slope: [x, y, z].map(|moment| 3.0 * moment) }
    }

    /// Light on surfaces that face up and down; `up` in the space of the map.
    pub fn hemispheres(&self, up: Vec3) -> HemisphereLight {
        let [x, y, z] = self.slope;
        let slope = x * up.x + y * up.y + z * up.z;
        let light = hemisphere_light(convert::vec3(self.mean), convert::vec3(slope));
        let [sky, ground] = light.map(|light| Vec3::from_array(light.to_array()));
        HemisphereLight { sky, ground }
    }
}

/// Light of all maps in use. Made again with every device.
#[derive(Resource)]
pub(crate) struct MapLights {
    /// `None` without compute shaders.
    pass: Option<MeasurePass>,
    maps: HashMap<AssetId<Image>, Map>,
}

struct MeasurePass {
    pipeline: wgpu::ComputePipeline,
    sampler: wgpu::Sampler,
}

struct Map {
    texture: TextureId,
    bindings: wgpu::BindGroup,
    means: wgpu::Buffer,
    readback: wgpu::Buffer,
    /// Holds the outcome of the readback once it is there.
    pending: Option<Arc<OnceLock<Result<(), wgpu::BufferAsyncError>>>>,
    light: Option<MapLight>,
    /// True if the texels have changed since the last measurement began.
    is_changed: bool,
    /// Frames since the last measurement began.
    age: u32,
}

impl FromWorld for MapLights {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>().wgpu_device();
        let limits = device.limits();
        let computes =
            limits.max_compute_invocations_per_workgroup >= 64 && limits.max_storage_buffers_per_shader_stage > 0;
        Self { pass: computes.then(|| MeasurePass::new(device)), maps: HashMap::new() }
    }
}

impl MapLights {
    /// Light of a map that has been measured.
    pub fn get(&self, map: AssetId<Image>) -> Option<&MapLight> {
        self.maps.get(&map)?.light.as_ref()
    }
}

/// Measures new and changed maps, and reads those that are done.
pub(crate) fn measure_maps(
    mut lights: ResMut<MapLights>,
    environments: Res<ExtractedEnvironments>,
    smokes: Res<ExtractedSmokes>,
    images: Res<RenderAssets<GpuImage>>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let MapLights { pass, maps } = &mut *lights;
    maps.retain(|id, _| environments.environments.iter().any(|environment| environment.map == *id));
    for id in &environments.changed {
        if let Some(map) = maps.get_mut(id) {
            map.is_changed = true;
        }
    }
    if smokes.smokes.is_empty() {
        return;
    }
    for environment in &environments.environments {
        let Some(image) = images.get(environment.map) else { continue };
        let Some(pass) = pass else {
            warn_once!("environment maps do not light smoke: this device has no compute shaders");
            return;
        };
        let view_dimension = image.texture_view_descriptor.as_ref().and_then(|view| view.dimension);
        if !is_readable(&image.texture_descriptor, view_dimension, device.features()) {
            warn_once!(
                "an environment map does not light smoke: its format is {:?}, its view {view_dimension:?}; expected a cube \
                 map of a format that can be filtered",
                image.texture_descriptor.format
            );
            continue;
        }
        let device = device.wgpu_device();
        if maps.get(&environment.map).is_none_or(|map| map.texture != image.texture.id()) {
            let light = maps.remove(&environment.map).and_then(|map| map.light);
            maps.insert(environment.map, pass.map(device, image, light));
        }
        if let Some(map) = maps.get_mut(&environment.map) {
            map.read();
            map.age += 1;
            let is_old = environment.is_generated && map.age >= GENERATED_INTERVAL;
            if map.pending.is_none() && (map.is_changed || is_old) {
                pass.measure(device, &queue, map);
            }
        }
    }
}

/// True for cube maps that a shader can sample with a filter.
fn is_readable<L, V>(
    texture: &wgpu::wgt::TextureDescriptor<L, V>,
    view: Option<wgpu::TextureViewDimension>,
    features: wgpu::Features,
) -> bool {
    view == Some(wgpu::TextureViewDimension::Cube)
        && texture.usage.contains(wgpu::TextureUsages::TEXTURE_BINDING)
        && texture.format.sample_type(None, Some(features)) == Some(wgpu::TextureSampleType::Float { filterable: true })
}

impl MeasurePass {
    fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("map_light.wgsl"));
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("smoke_map_light"),
            layout: None,
            module: &module,
            entry_point: Some("measure"),
            compilation_options: Default::default(),
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("smoke_map_light"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { pipeline, sampler }
    }

    /// Buffers for a map. `light`: what is shown until it has been measured.
    fn map(&self, device: &wgpu::Device, image: &GpuImage, light: Option<MapLight>) -> Map {
        let buffer = |label, usage| {
            let descriptor = wgpu::BufferDescriptor { label, size: MEANS_SIZE, usage, mapped_at_creation: false };
            device.create_buffer(&descriptor)
        };
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let means = buffer(Some("smoke_map_light"), usage);
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let readback = buffer(Some("smoke_map_light_readback"), usage);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("smoke_map_light"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&image.texture_view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
                wgpu::BindGroupEntry { binding: 2, resource: means.as_entire_binding() },
            ],
        });
        let texture = image.texture.id();
        Map { texture, bindings, means, readback, pending: None, light, is_changed: true, age: 0 }
    }

    fn measure(&self, device: &wgpu::Device, queue: &wgpu::Queue, map: &mut Map) {
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &map.bindings, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&map.means, 0, &map.readback, 0, MEANS_SIZE);
        queue.submit([encoder.finish()]);
        let outcome = Arc::new(OnceLock::new());
        let pending = outcome.clone();
        // wgpu calls this once.
        map.readback.map_async(wgpu::MapMode::Read, .., move |result| drop(outcome.set(result)));
        map.pending = Some(pending);
        map.is_changed = false;
        map.age = 0;
    }
}

impl Map {
    /// Takes the result of a measurement, if it is there.
    fn read(&mut self) {
        let Some(outcome) = self.pending.as_ref().and_then(|pending| pending.get().cloned()) else { return };
        self.pending = None;
        if let Err(error) = outcome {
            warn_once!("the light of an environment map could not be read: {error}");
            return;
        }
        if let Ok(bytes) = self.readback.get_mapped_range(..) {
            let word = |index: usize| {
                let word = bytes.get(4 * index..4 * index + 4).and_then(|bytes| bytes.try_into().ok());
                word.map_or(0.0, f32::from_le_bytes)
            };
            let means = [0, 4, 8, 12].map(|at| Vec3::new(word(at), word(at + 1), word(at + 2)));
            if means.iter().all(|mean| mean.is_finite()) {
                self.light = Some(MapLight::from_means(means));
            }
        }
        self.readback.unmap();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A diffuse map of a sky and a ground is linear in the normal, so its hemispheres are exact.
    #[test]
    fn sky_and_ground_come_back_from_their_means() {
        let sky = Vec3::new(1.0, 0.5, 0.0);
        let ground = Vec3::new(0.0, 0.25, 2.0);
        let turned_up = Vec3::new(0.6, 0.0, 0.8);
        let mean = 0.5 * (sky + ground);
        let slope = 0.5 * (sky - ground);
        let moments = turned_up.to_array().map(|part| slope * part / 3.0);
        let light = MapLight::from_means([mean, moments[0], moments[1], moments[2]]);
        let hemispheres = light.hemispheres(turned_up);
        assert!(hemispheres.sky.abs_diff_eq(sky, 1e-5) && hemispheres.ground.abs_diff_eq(ground, 1e-5));
        let level = light.hemispheres(Vec3::Y);
        assert!(level.sky.abs_diff_eq(mean, 1e-5) && level.ground.abs_diff_eq(mean, 1e-5));
    }

    #[test]
    fn cube_maps_of_usual_formats_are_readable() {
        let texture = |format| wgpu::wgt::TextureDescriptor {
            label: None::<&str>,
            size: wgpu::Extent3d { width: 32, height: 32, depth_or_array_layers: 6 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: (),
        };
        let cube = Some(wgpu::TextureViewDimension::Cube);
        let is_readable = |format, view| is_readable(&texture(format), view, wgpu::Features::empty());
        for format in [
            wgpu::TextureFormat::Rgba16Float,
            wgpu::TextureFormat::Rgb9e5Ufloat,
            wgpu::TextureFormat::Bc6hRgbUfloat,
            wgpu::TextureFormat::Rgba8UnormSrgb,
        ] {
            assert!(is_readable(format, cube) && !is_readable(format, None), "{format:?}");
        }
        assert!(!is_readable(wgpu::TextureFormat::Rgba32Float, cube));
    }
}
