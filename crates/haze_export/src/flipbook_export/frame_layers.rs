//! Layers of one frame of a flipbook.

use glam::{Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::formula::color::luminance;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::display_transform;

use crate::backend::Backend;
use crate::smoke_layers::SmokeLayers;

/// Layers of one frame, all multiplied by the opacity of the smoke, which is in alpha.
pub struct FrameLayers {
    /// Exposed.
    pub light: Image<Vec4>,
    /// View space.
    pub normals: Image<Vec4>,
    /// Way until the next frame: x to the right, y up, fractions of the frame's width and height.
    pub motion: Image<Vec4>,
    /// Exposed.
    pub fire: Option<Image<Vec4>>,
    /// From right, top and front; from left, bottom and back.
    pub six_way: Option<[Image<Vec4>; 2]>,
    /// Luminance of fire in x, not exposed, as six-way light; if a system burns and there is six-way light.
    pub emission: Option<Image<Vec4>>,
}

/// Renders the light of a frame alone: exposed, multiplied by opacity.
pub async fn frame_light(backend: &Backend, shot: &Shot) -> Result<Image<Vec4>, Error> {
    Ok(exposed(SmokeLayers::new(backend, shot).await?.light, shot))
}

fn exposed(mut image: Image<Vec4>, shot: &Shot) -> Image<Vec4> {
    let exposure = Vec3::splat(display_transform(shot).exposure).extend(1.0);
    image.texels.iter_mut().for_each(|texel| *texel *= exposure);
    image
}

/// Mixes two layers. `fraction`: of `other`, 0 to 1.
pub fn mixed(mut image: Image<Vec4>, other: &Image<Vec4>, fraction: f32) -> Image<Vec4> {
    let pairs = image.texels.iter_mut().zip(&other.texels);
    pairs.for_each(|(texel, other)| *texel = texel.lerp(*other, fraction));
    image
}

impl FrameLayers {
    /// `seconds`: time to the next frame.
    pub async fn render(
        backend: &Backend,
        shot: &Shot,
        seconds: f32,
        burns: bool,
        has_six_way: bool,
    ) -> Result<Self, Error> {
        let layers = SmokeLayers::new(backend, shot).await?;
        let width = shot.size.x as f32;
        let height = shot.size.y as f32;
        let mut motion = layers.motion(seconds).await?;
        motion.texels.iter_mut().for_each(|texel| *texel /= Vec4::new(width, height, 1.0, 1.0));
        let fire = if burns { Some(layers.fire().await?) } else { None };
        let emission = |fire: &Image<Vec4>| {
            let texels = fire.texels.iter().map(|fire| Vec4::new(luminance(fire.xyz()), 0.0, 0.0, fire.w));
            Image { size: fire.size, texels: texels.collect() }
        };
        Ok(Self {
            normals: layers.normals().await?,
            motion,
            emission: fire.as_ref().filter(|_| has_six_way).map(emission),
            fire: fire.map(|fire| exposed(fire, shot)),
            six_way: if has_six_way { Some(layers.six_way().await?) } else { None },
            light: exposed(layers.light, shot),
        })
    }

    /// Mixes two frames. `fraction`: of `other`, 0 to 1.
    pub fn mixed(self, other: &Self, fraction: f32) -> Self {
        let mix = |image, other| mixed(image, other, fraction);
        Self {
            light: mix(self.light, &other.light),
            normals: mix(self.normals, &other.normals),
            motion: mix(self.motion, &other.motion),
            fire: self.fire.zip(other.fire.as_ref()).map(|(fire, other)| mix(fire, other)),
            six_way: self.six_way.zip(other.six_way.as_ref()).map(|([a, b], [c, d])| [mix(a, c), mix(b, d)]),
            emission: self.emission.zip(other.emission.as_ref()).map(|(emission, other)| mix(emission, other)),
        }
    }
}
