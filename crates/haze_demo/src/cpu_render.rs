//! Renders a shot, scene and smoke, on the CPU. offscreen_renderer.rs does so on the GPU.

use std::cell::RefCell;
use std::rc::Rc;

use glam::{Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::formula::shadow::LIGHTS_PER_BLOCK;
use haze_core::frame::{Light, Particle};
use haze_core::settings::Settings;
use haze_preset::Environment;

use super::antialiasing::antialiased;
use super::bloom::add_bloom;
use super::outline::Outlines;
use super::ray_caster::{self, SceneColor};
use super::scene::coefficients;
use super::shadow_views::ShadowView;
use super::shot::Shot;
use haze_author::backdrop::Backdrop;
use haze_reference::{PreparedFrame, SceneShadow};

impl Shot {
    /// Renders the shot on the CPU. Returns linear HDR.
    ///
    /// # Errors
    /// [`Error::Field`] if the preset was changed to invalid values.
    pub fn render_on_cpu(&self) -> Result<Image<Vec4>, Error> {
        self.at_its_time().render_still()
    }

    fn render_still(&self) -> Result<Image<Vec4>, Error> {
        let view = self.preset.camera.view(self.size);
        let scene = self.scene();
        let groups = ray_caster::render_depth(&scene, &view);
        let depth = Image { size: groups.size, texels: groups.texels.iter().map(|groups| groups.back).collect() };
        let particles = self.systems();
        let systems = self.reference_systems(&particles);
        let maps = ShadowLayers::of_shot(self);
        let shadow_maps = maps.maps();
        let lights = self.lights();
        let frame = PreparedFrame::new(&self.reference_frame(&depth, &systems, &shadow_maps, &lights), self.size)?;
        // The scene's renderer keeps the light of as many lights apart.
        let apart = |shadow: &SceneShadow, light| shadow.lights().take(LIGHTS_PER_BLOCK).any(|index| index == light);
        let through = |world, light: u32| match frame.scene_shadow() {
            Some(shadow) if apart(shadow, light as usize) => shadow.haze_transmittance(world, light as usize),
            _ => Vec3::ONE,
        };
        if !self.shows_scene() {
            let mut color = Image::new(self.size, Vec4::W);
            frame.render(&mut color);
            return Ok(color);
        }
        let SceneColor { behind, front } = ray_caster::render_color(&scene, &view, &groups, through);
        let mut smoked = behind.clone();
        frame.render(&mut smoked);
        let outlines = Outlines {
            groups: &groups,
            coefficients: coefficients(&view),
            behind: &behind,
            smoked: &smoked,
            front: &front,
            smoke_depths: frame.smoke_depths(),
        };
        let mut completed = outlines.completed();
        if self.antialiasing() {
            completed = antialiased(&completed);
        }
        if let Some(hot_air) = self.heat_haze(&lights) {
            completed = hot_air.distorted(&completed, &depth);
        }
        add_bloom(&mut completed, self.bloom());
        Ok(completed)
    }

    pub(super) fn reference_systems<'a>(
        &'a self,
        particles: &'a [(Vec<Particle>, Settings)],
    ) -> Vec<haze_reference::ParticleSystem<'a>> {
        let system =
            |((particles, settings), material)| haze_reference::ParticleSystem::new(particles, settings, material);
        let particles = particles.iter().map(|(particles, settings)| (particles.as_slice(), settings));
        particles.zip(&self.materials).map(system).collect()
    }

    pub(super) fn reference_frame<'a>(
        &'a self,
        scene_depth: &'a Image<f32>,
        systems: &'a [haze_reference::ParticleSystem<'a>],
        shadow_maps: &'a [haze_reference::ShadowMap<'a>],
        lights: &'a [Light],
    ) -> haze_reference::FrameInput<'a> {
        haze_reference::FrameInput {
            shadow_maps,
            lights,
            systems,
            time: self.preset.time,
            up: Vec3::Y,
            debug_view: self.debug_view,
            ..haze_reference::FrameInput::new(self.preset.camera.view(self.size), scene_depth)
        }
    }
}

/// Shadow maps of a scene, in memory.
pub(super) struct ShadowLayers {
    /// Scene that the maps show.
    environment: Environment,
    backdrop: Backdrop,
    maps: Vec<(ShadowView, Vec<Image<f32>>)>,
}

impl ShadowLayers {
    /// Draws the maps of a shot. Frames of a sequence have the same: the last ones of a thread are kept.
    pub fn of_shot(shot: &Shot) -> Rc<Self> {
        thread_local! {
            static LAST: RefCell<Option<Rc<ShadowLayers>>> = const { RefCell::new(None) };
        }
        let views = shot.shadow_views();
        let is_same = |last: &Rc<Self>| {
            last.environment == shot.preset.environment
                && last.backdrop == shot.backdrop
                && last.maps.iter().map(|(view, _)| view).eq(&views)
        };
        let kept = LAST.take().filter(is_same);
        let layers = kept.unwrap_or_else(|| Rc::new(Self::new(shot, views)));
        LAST.set(Some(layers.clone()));
        layers
    }

    fn new(shot: &Shot, views: Vec<ShadowView>) -> Self {
        let scene = shot.scene();
        let drawn = |view: ShadowView| {
            let layers = view.clip_from_world.iter().map(|matrix| view.layer(&scene, matrix)).collect();
            (view, layers)
        };
        Self {
            environment: shot.preset.environment.clone(),
            backdrop: shot.backdrop.clone(),
            maps: views.into_iter().map(drawn).collect(),
        }
    }

    pub fn maps(&self) -> Vec<haze_reference::ShadowMap<'_>> {
        self.maps
            .iter()
            .map(|(view, layers)| haze_reference::ShadowMap { layers, projection: view.projection() })
            .collect()
    }
}
