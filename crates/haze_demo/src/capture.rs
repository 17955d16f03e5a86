//! What a stage drew, on its way back from the GPU: the texels that tell what became of every pixel.

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};

use super::arriving::Arriving;
use super::shot::Shot;
use haze::TargetViews;
use haze::assets::picture::Picture;
use haze::error::Error;
use haze::frame::Particle;
use haze::settings::Settings;
use haze_reference::{Probe, Texels, probe};

/// A copy of a frame's targets, once it has arrived.
#[derive(Clone, Debug)]
pub struct Capture {
    arriving: Arriving,
    /// What its parts are: of every system, nothing where it is out of sight or forward.
    systems: Vec<Option<Target>>,
}

/// The part in use of a system's textures.
#[derive(Clone, Copy, Debug)]
struct Target {
    size: UVec2,
    depth_limit: f32,
    has_beside: bool,
    has_depth: bool,
    /// Faces of baked light.
    faces: usize,
}

/// What came back of a frame.
#[derive(Clone, Debug)]
pub struct Captured {
    /// The scene's depth buffer.
    pub scene_depth: Picture<f32>,
    /// The scene without smoke, linear HDR.
    pub behind: Picture<Vec4>,
    /// The systems' targets, nothing for those out of sight or forward.
    pub systems: Vec<Option<Texels>>,
}

impl Capture {
    /// Records copies of all that a frame was drawn from.
    pub(super) fn record(
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        scene: [&wgpu::Texture; 2],
        systems: &[Option<TargetViews<'_>>],
    ) -> Self {
        let mut textures = scene.to_vec();
        for views in systems.iter().flatten() {
            textures.extend(views.accumulation.iter().map(wgpu::TextureView::texture));
            textures.extend(views.reduced_depth.map(wgpu::TextureView::texture));
            textures.extend(views.baked_diffuse.first().map(wgpu::TextureView::texture));
        }
        let target = |views: &TargetViews<'_>| Target {
            size: views.size,
            depth_limit: views.depth_limit,
            has_beside: views.accumulation.len() > 1,
            has_depth: views.reduced_depth.is_some(),
            faces: views.baked_diffuse.len(),
        };
        let arriving = Arriving::record(device, encoder, &textures);
        Self { arriving, systems: systems.iter().map(|views| views.as_ref().map(target)).collect() }
    }

    /// True once it is here, or is known not to come: whichever submission or poll finds the GPU done brings it.
    pub fn has_arrived(&self) -> bool {
        self.arriving.has_arrived()
    }

    /// Reads what has arrived, once; `None` where it did not.
    pub fn read(&self) -> Option<Captured> {
        let bytes = self.arriving.take()?;
        let mut parts = self.arriving.parts.iter();
        let (depth, behind) = (parts.next()?, parts.next()?);
        let scene_depth = depth.depths(&bytes, depth.size());
        let behind = behind.colours(&bytes, 0, behind.size());
        let mut system = |target: &Target| {
            let mut colours = || Some(parts.next()?.colours(&bytes, 0, target.size));
            let accumulation = colours()?;
            let beside = if target.has_beside { Some(colours()?) } else { None };
            let reduced_depth = if target.has_depth {
                let mut depth = parts.next()?.depths(&bytes, target.size);
                depth.texels.iter_mut().for_each(|depth| *depth *= target.depth_limit);
                Some(depth)
            } else {
                None
            };
            let mut baked = Vec::new();
            if target.faces > 0 {
                let part = parts.next()?;
                baked = (0..target.faces as u32).map(|face| rgb(&part.colours(&bytes, face, part.size()))).collect();
            }
            Some(Texels { accumulation, beside, reduced_depth, baked })
        };
        let systems = self.systems.iter().map(|target| target.as_ref().and_then(&mut system)).collect();
        Some(Captured { scene_depth, behind, systems })
    }
}

fn rgb(picture: &Picture<Vec4>) -> Picture<Vec3> {
    Picture { size: picture.size, texels: picture.texels.iter().map(|texel| texel.xyz()).collect() }
}

impl Captured {
    /// With the shot that was captured: its particles are evaluated here, once for all pixels.
    pub fn of(self, shot: Shot) -> Witness {
        Witness { captured: self, systems: shot.systems(), shot }
    }
}

/// What came back of a shot, and all else that it takes to tell of its pixels.
#[derive(Clone, Debug)]
pub struct Witness {
    captured: Captured,
    shot: Shot,
    systems: Vec<(Vec<Particle>, Settings)>,
}

impl Witness {
    /// The shot that it is of.
    pub fn shot(&self) -> &Shot {
        &self.shot
    }

    /// Tells what became of some pixels.
    ///
    /// # Errors
    /// As [`probe`]: when another shot was captured.
    pub fn probe(&self, pixels: &[UVec2]) -> Result<Vec<Probe>, Error> {
        let Captured { scene_depth, behind, systems: texels } = &self.captured;
        let systems = self.shot.reference_systems(&self.systems);
        let frame = self.shot.reference_frame(scene_depth, &systems);
        Ok(probe(&frame, texels, behind, pixels)?)
    }
}
