//! Layouts of the bind groups: 0 frame, 1 system, 2 material, 3 the pass's own inputs. See `shaders/lib/bindings.wgsl`.

use haze_core::formula::uniforms::{
    LightUniform, SceneShadowUniform, ScreenShadowUniform, ShadowVisibilityUniform, SystemUniform, ViewUniform,
};
use haze_core::frame::MAX_LIGHTS;

use super::gpu::binding::{FILTERED, LOADED, SAMPLER, bind_group_layout, texture, uniform};
use super::gpu::capabilities::tiles_are_supported;

/// Size of the lights' uniform block, bytes.
pub(crate) const LIGHTS_SIZE: u64 = (MAX_LIGHTS * size_of::<LightUniform>()) as u64;

/// Bindings of a material that the passes that draw sprites or bake light read. WebGPU and WebGL2 guarantee 16 textures per
/// stage, too few for all of the material's.
pub(crate) const SPRITE_BINDINGS: [u32; 13] = [0, 1, 2, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15];

/// Bindings of a material that the passes that light accumulated smoke read: ramps, their sampler, and the painted motif.
pub(crate) const LIGHTING_BINDINGS: [u32; 9] = [1, 2, 3, 4, 5, 10, 12, 13, 15];

/// Format of the optical depths in the cells of the density grid.
pub(crate) const SHADOW_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Bind groups that a pass shares with others, by their indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GroupSet {
    None,
    /// 0 frame, 1 system, 2 material: passes that draw sprites or bake light.
    Sprites,
    /// As `Sprites`, with the part of the material that lights accumulated smoke.
    Lighting,
    /// 0 a host's shadow maps.
    ShadowMaps,
    /// 0 a host's shadow maps, 1 frame, 2 lights of the scene, 3 shadow on the scene.
    ScreenShadow,
}

/// Types of the bindings of a host's shadow maps.
pub(crate) const SHADOW_MAP_TYPES: [wgpu::BindingType; 4] = {
    let map = texture(false, wgpu::TextureViewDimension::D2Array);
    [uniform(size_of::<ShadowVisibilityUniform>()), map, map, map]
};

/// Layouts of the bind groups that passes share.
#[derive(Debug)]
pub(crate) struct Layouts {
    pub frame: wgpu::BindGroupLayout,
    pub system: wgpu::BindGroupLayout,
    /// With [`SPRITE_BINDINGS`].
    pub material: wgpu::BindGroupLayout,
    /// As `material`, with [`LIGHTING_BINDINGS`].
    pub lighting: wgpu::BindGroupLayout,
    /// Of a host's shaders: shadow of the smoke on the scene.
    pub scene_shadow: wgpu::BindGroupLayout,
    /// A host's shadow maps of a block of lights.
    pub shadow_maps: wgpu::BindGroupLayout,
    pub screen_shadow: wgpu::BindGroupLayout,
}

impl Layouts {
    pub fn new(device: &wgpu::Device) -> Self {
        use wgpu::TextureViewDimension::{D2, D2Array, D3};
        let mut visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
        visibility.set(wgpu::ShaderStages::COMPUTE, tiles_are_supported(device));
        let layout = |label, types: &[wgpu::BindingType]| bind_group_layout(device, label, visibility, types);
        let lights = uniform(LIGHTS_SIZE as usize);
        let volume = texture(true, D3);
        // By their numbers in `shaders/lib/bindings.wgsl`.
        let material = |label, bindings: &[u32]| {
            let entry = |&binding| wgpu::BindGroupLayoutEntry {
                binding,
                visibility,
                ty: match binding {
                    0 | 6 => texture(true, D2Array),
                    5 | 9 => SAMPLER,
                    8 => volume,
                    11 => wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Uint,
                        view_dimension: D2,
                        multisampled: false,
                    },
                    _ => FILTERED,
                },
                count: None,
            };
            let entries: Vec<_> = bindings.iter().map(entry).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        Self {
            frame: layout("haze frame", &[uniform(size_of::<ViewUniform>()), LOADED]),
            system: layout("haze system", &[uniform(size_of::<SystemUniform>()), lights, volume]),
            material: material("haze material", &SPRITE_BINDINGS),
            lighting: material("haze material lighting", &LIGHTING_BINDINGS),
            scene_shadow: layout(
                "haze scene shadow",
                &[uniform(size_of::<SceneShadowUniform>()), volume, FILTERED, SAMPLER],
            ),
            shadow_maps: layout("haze shadow maps", &SHADOW_MAP_TYPES),
            screen_shadow: layout("haze screen_shadow inputs", &[uniform(size_of::<ScreenShadowUniform>()), lights]),
        }
    }

    /// Returns the layouts of a set, in the order of the groups.
    pub fn groups(&self, set: GroupSet) -> Vec<&wgpu::BindGroupLayout> {
        match set {
            GroupSet::None => Vec::new(),
            GroupSet::Sprites => vec![&self.frame, &self.system, &self.material],
            GroupSet::Lighting => vec![&self.frame, &self.system, &self.lighting],
            GroupSet::ShadowMaps => vec![&self.shadow_maps],
            GroupSet::ScreenShadow => vec![&self.shadow_maps, &self.frame, &self.screen_shadow, &self.scene_shadow],
        }
    }
}
