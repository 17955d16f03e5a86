//! Readback of a frame's intermediate targets, from which the pixel probe explains each pixel.

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::frame::Particle;
use haze_core::settings::Settings;

use super::cpu_render::ShadowLayers;
use super::shot::Shot;
use super::texture_readback::TextureReadback;
use haze::{AttachmentSet, TargetViews};
use haze_reference::{AccumulatedTextures, Probe, ProbeTextures, probe};

/// Pending readback of a frame's targets.
#[derive(Clone, Debug)]
pub struct Capture {
    readback: TextureReadback,
    /// Targets of every system; `None` for systems that are out of view or use the forward path.
    systems: Vec<Option<CapturedTarget>>,
}

/// Used part of a system's textures.
#[derive(Clone, Copy, Debug)]
struct CapturedTarget {
    size: UVec2,
    depth_limit: f32,
    roles: AttachmentSet,
    has_depth: bool,
    /// Number of cube faces of baked light.
    faces: usize,
}

/// Targets of a frame after readback.
#[derive(Clone, Debug)]
pub struct CapturedFrame {
    /// Depth buffer of the scene, 0..1.
    pub scene_depth: Image<f32>,
    /// Scene color without smoke, linear HDR; at the outline of an object, that of the surfaces behind it.
    pub behind: Image<Vec4>,
    /// Color of objects at their outlines, with their fraction of the pixel in alpha; 0 elsewhere.
    pub front: Image<Vec4>,
    /// Targets of the systems; `None` for systems that are out of view or use the forward path.
    pub systems: Vec<Option<ProbeTextures>>,
}

impl Capture {
    /// Records copies of all targets that a frame was composed from.
    pub(super) fn record(
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        scene: [&wgpu::Texture; 3],
        systems: &[Option<TargetViews<'_>>],
    ) -> Self {
        let mut textures = scene.to_vec();
        for views in systems.iter().flatten() {
            textures.extend(views.accumulation.iter().map(wgpu::TextureView::texture));
            textures.extend(views.reduced_depth.map(wgpu::TextureView::texture));
            textures.extend(views.baked_diffuse.first().map(wgpu::TextureView::texture));
        }
        let target = |views: &TargetViews<'_>| CapturedTarget {
            size: views.size,
            depth_limit: views.depth_limit,
            roles: views.roles,
            has_depth: views.reduced_depth.is_some(),
            faces: views.baked_diffuse.len(),
        };
        let readback = TextureReadback::record(device, encoder, &textures);
        Self { readback, systems: systems.iter().map(|views| views.as_ref().map(target)).collect() }
    }

    /// True once the readback has finished or failed. Progresses only when the device is polled or work is submitted.
    pub fn is_finished(&self) -> bool {
        self.readback.is_finished()
    }

    /// Decodes the targets. Returns `None` if the readback has not finished or has failed, and on every call after the
    /// first success.
    pub fn read(&self) -> Option<CapturedFrame> {
        let bytes = self.readback.take()?;
        let mut regions = self.readback.regions.iter();
        let depth = regions.next()?;
        let scene_depth = depth.depths(&bytes, depth.size());
        let mut color = || regions.next().map(|region| region.colors(&bytes, 0, region.size()));
        let behind = color()?;
        let front = color()?;
        let mut system = |target: &CapturedTarget| {
            let mut accumulation = AccumulatedTextures::default();
            for role in target.roles.iter() {
                accumulation[role as usize] = Some(regions.next()?.colors(&bytes, 0, target.size));
            }
            let reduced_depth = if target.has_depth {
                let mut depth = regions.next()?.depths(&bytes, target.size);
                depth.texels.iter_mut().for_each(|depth| *depth *= target.depth_limit);
                Some(depth)
            } else {
                None
            };
            let mut baked = Vec::new();
            if target.faces > 0 {
                let region = regions.next()?;
                baked = (0..target.faces as u32).map(|face| rgb(&region.colors(&bytes, face, region.size()))).collect();
            }
            Some(ProbeTextures { accumulation, reduced_depth, baked })
        };
        let systems = self.systems.iter().map(|target| target.as_ref().and_then(&mut system)).collect();
        Some(CapturedFrame { scene_depth, behind, front, systems })
    }
}

fn rgb(image: &Image<Vec4>) -> Image<Vec3> {
    Image { size: image.size, texels: image.texels.iter().map(|texel| texel.xyz()).collect() }
}

impl CapturedFrame {
    /// Combines the targets with the captured shot. Evaluates the shot's particles once for all pixels.
    pub fn with_shot(self, shot: Shot) -> ProbeInputs {
        let shot = shot.at_its_time().into_owned();
        ProbeInputs { captured: self, systems: shot.systems(), shot }
    }
}

/// Captured targets with the shot's particles: the inputs of the pixel probe.
#[derive(Clone, Debug)]
pub struct ProbeInputs {
    captured: CapturedFrame,
    shot: Shot,
    systems: Vec<(Vec<Particle>, Settings)>,
}

impl ProbeInputs {
    /// Returns the captured shot.
    pub fn shot(&self) -> &Shot {
        &self.shot
    }

    /// Returns the fraction of a pixel that an object in front covers at its outline, 0 to 1. A probe explains the rest.
    pub fn front_fraction(&self, pixel: UVec2) -> f32 {
        self.captured.front.load(pixel.as_ivec2()).w
    }

    /// Explains how some pixels were shaded; at the outline of an object, the surfaces behind it.
    ///
    /// # Errors
    /// As [`probe`], if the targets belong to another shot.
    pub fn probe(&self, pixels: &[UVec2]) -> Result<Vec<Probe>, Error> {
        let CapturedFrame { scene_depth, behind, systems: texels, .. } = &self.captured;
        let systems = self.shot.reference_systems(&self.systems);
        let maps = ShadowLayers::of_shot(&self.shot);
        let shadow_maps = maps.maps();
        let lights = self.shot.lights();
        let frame = self.shot.reference_frame(scene_depth, &systems, &shadow_maps, &lights);
        Ok(probe(&frame, texels, behind, pixels)?)
    }
}
