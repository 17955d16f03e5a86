//! Shadow of the smoke on a host's lit image.

use haze_core::formula::uniforms::{LightUniform, ScreenShadowUniform};
use haze_core::glam::{Mat4, Vec3};
use haze_core::view_setup::{SmokeShadow, ViewGeometry, scene_light_uniforms};

use super::context::Shared;
use super::gpu::binding::bind_resources;
use super::gpu::host_pass::HostPass;
use super::gpu::idle_counter::IdleCounter;
use super::gpu::record::uniform_buffer;
use super::layouts::LIGHTS_SIZE;
use super::pass::screen_shadow::ScreenShadow;
use super::shadow_map_bindings::ShadowMapBindings;
use crate::frame::FrameInput;

/// Inputs of the pass, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct ScreenShadowState {
    inputs: Option<Inputs>,
    idle: IdleCounter,
    /// True if the frame draws it.
    is_drawn: bool,
}

#[derive(Debug)]
struct Inputs {
    uniform: wgpu::Buffer,
    lights: wgpu::Buffer,
    group: wgpu::BindGroup,
    maps: ShadowMapBindings,
    light_uniforms: Vec<LightUniform>,
}

impl ScreenShadowState {
    /// Prepares the pass for a frame that asks for it. Returns true if it is drawn.
    pub fn write(
        &mut self,
        shared: &Shared,
        frame: &FrameInput<'_>,
        view: &ViewGeometry,
        shadow: Option<&SmokeShadow>,
    ) -> bool {
        let asked = frame.scene_ambient.zip(shadow.filter(|shadow| shadow.on_scene.is_some()));
        self.is_drawn = asked.is_some();
        if self.idle.tick(!self.is_drawn) {
            self.inputs = None;
        }
        let Some((ambient, shadow)) = asked else { return false };
        let inputs = self.inputs.get_or_insert_with(|| Inputs::new(shared));
        inputs.write(shared, frame, view, ambient, shadow);
        true
    }

    /// Returns the pass, if the frame draws it. `frame`, `scene_shadow`: groups of the frame.
    pub fn pass<'a>(
        &'a self,
        shared: &Shared,
        host: HostPass,
        frame: &'a wgpu::BindGroup,
        scene_shadow: &'a wgpu::BindGroup,
    ) -> Option<ScreenShadow<'a>> {
        let inputs = self.inputs.as_ref().filter(|_| self.is_drawn)?;
        let groups = [inputs.maps.group(), frame, &inputs.group, scene_shadow];
        Some(ScreenShadow { pipeline: shared.pipelines.drawn.screen_shadow.get(host), groups })
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.inputs.as_ref().map_or(0, |held| held.uniform.size() + held.lights.size() + held.maps.bytes())
    }
}

impl Inputs {
    fn new(shared: &Shared) -> Self {
        let device = &shared.device;
        let layouts = &shared.layouts;
        let uniform = uniform_buffer(device, "haze screen_shadow", size_of::<ScreenShadowUniform>() as u64);
        let lights = uniform_buffer(device, "haze lights of the scene", LIGHTS_SIZE);
        let resources = [uniform.as_entire_binding(), lights.as_entire_binding()];
        let group = bind_resources(device, "haze screen_shadow", &layouts.screen_shadow, resources);
        Self {
            uniform,
            lights,
            group,
            maps: ShadowMapBindings::new(device, &layouts.shadow_maps, None),
            light_uniforms: Vec::new(),
        }
    }

    fn write(
        &mut self,
        shared: &Shared,
        frame: &FrameInput<'_>,
        view: &ViewGeometry,
        ambient: Vec3,
        shadow: &SmokeShadow,
    ) {
        scene_light_uniforms(view, frame.lights, shadow, &mut self.light_uniforms);
        let world_from_view: Mat4 = view.view_from_world.inverse();
        let uniform = ScreenShadowUniform { world_from_view, ambient, light_count: self.light_uniforms.len() as u32 };
        shared.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        shared.queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&self.light_uniforms));
        self.maps.write(&shared.gpu(), &shared.layouts.shadow_maps, shadow, 0, frame.shadow_maps, None);
    }
}
