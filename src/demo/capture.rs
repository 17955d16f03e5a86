//! What a stage drew, on its way back from the GPU: the texels that tell what became of every pixel.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use half::f16;

use super::shot::Shot;
use crate::assets::picture::Picture;
use crate::error::Error;
use crate::reference::{Probe, Texels, probe};
use crate::renderer::TargetViews;

/// A copy of a frame's targets, once it has arrived.
#[derive(Clone, Debug)]
pub struct Capture {
    parts: Vec<Part>,
    /// What the parts are: of every system, nothing where it is out of sight or forward.
    systems: Vec<Option<Target>>,
    bytes: Arc<Mutex<Option<Vec<u8>>>>,
}

/// The part in use of a system's textures.
#[derive(Clone, Copy, Debug)]
struct Target {
    size: UVec2,
    depth_limit: f32,
    has_weights: bool,
    has_depth: bool,
    /// Faces of baked light.
    faces: usize,
}

/// A texture in the buffer.
#[derive(Clone, Copy, Debug)]
struct Part {
    format: wgpu::TextureFormat,
    size: wgpu::Extent3d,
    offset: u64,
}

impl Part {
    fn texel_size(&self) -> u32 {
        self.format.block_copy_size(None).unwrap_or(4)
    }

    fn bytes_per_row(&self) -> u32 {
        (self.size.width * self.texel_size()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
    }

    fn bytes(&self) -> u64 {
        u64::from(self.bytes_per_row()) * u64::from(self.size.height) * u64::from(self.size.depth_or_array_layers)
    }

    /// The texels of a layer in the upper left `size`.
    fn read<T: Copy + Send>(
        &self,
        bytes: &[u8],
        layer: u32,
        size: UVec2,
        zero: T,
        texel: impl Fn(&[u8]) -> T + Sync,
    ) -> Picture<T> {
        let (row, step) = (self.bytes_per_row() as usize, self.texel_size() as usize);
        let mut picture = Picture::new(size, zero);
        let first = self.offset as usize + layer as usize * row * self.size.height as usize;
        picture.for_each(|at, out| {
            let start = first + at.y as usize * row + at.x as usize * step;
            if let Some(bytes) = bytes.get(start..start + step) {
                *out = texel(bytes);
            }
        });
        picture
    }

    /// Of any of the colour formats that there are.
    fn colours(&self, bytes: &[u8], layer: u32, size: UVec2) -> Picture<Vec4> {
        let half = |bytes: &[u8], channel: usize| {
            bytes.get(2 * channel..2 * channel + 2).map_or(0.0, |b| f16::from_le_bytes([b[0], b[1]]).to_f32())
        };
        let is_bytes = self.format == wgpu::TextureFormat::Rgba8Unorm;
        self.read(bytes, layer, size, Vec4::ZERO, |texel| {
            Vec4::from(
                [0, 1, 2, 3].map(
                    |channel| {
                        if is_bytes { f32::from(texel[channel]) / 255.0 } else { half(texel, channel) }
                    },
                ),
            )
        })
    }

    fn depths(&self, bytes: &[u8], size: UVec2) -> Picture<f32> {
        self.read(bytes, 0, size, 0.0, |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }
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
        let mut parts = Vec::new();
        let mut offset = 0;
        for texture in &textures {
            let part = Part { format: texture.format(), size: texture.size(), offset };
            offset += part.bytes();
            parts.push(part);
        }
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("demo capture"),
            size: offset,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        for (texture, part) in textures.iter().zip(&parts) {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: part.offset,
                bytes_per_row: Some(part.bytes_per_row()),
                rows_per_image: Some(part.size.height),
            };
            let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), target, part.size);
        }
        let bytes = Arc::new(Mutex::new(None));
        let (arrived, mapped) = (bytes.clone(), buffer.clone());
        encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
            // Nothing, where it could not be had: nobody is to wait for it.
            let view = if result.is_ok() { mapped.get_mapped_range(..).ok() } else { None };
            let bytes = view.map(|view| view.to_vec()).unwrap_or_default();
            *arrived.lock().unwrap_or_else(PoisonError::into_inner) = Some(bytes);
            mapped.unmap();
        });
        let target = |views: &TargetViews<'_>| Target {
            size: views.size,
            depth_limit: views.depth_limit,
            has_weights: views.accumulation.len() > 1,
            has_depth: views.reduced_depth.is_some(),
            faces: views.baked_diffuse.len(),
        };
        Self { parts, systems: systems.iter().map(|views| views.as_ref().map(target)).collect(), bytes }
    }

    /// True once it is here, or is known not to come: whichever submission or poll finds the GPU done brings it.
    pub fn has_arrived(&self) -> bool {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Reads what has arrived, once; `None` where it did not.
    pub fn read(&self) -> Option<Captured> {
        let bytes = self.bytes.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        if (bytes.len() as u64) < self.parts.last().map_or(0, |part| part.offset + part.bytes()) {
            return None;
        }
        let mut parts = self.parts.iter();
        let (depth, behind) = (parts.next()?, parts.next()?);
        let whole = |part: &Part| UVec2::new(part.size.width, part.size.height);
        let scene_depth = depth.depths(&bytes, whole(depth));
        let behind = behind.colours(&bytes, 0, whole(behind));
        let mut system = |target: &Target| {
            let mut colours = || Some(parts.next()?.colours(&bytes, 0, target.size));
            let accumulation = colours()?;
            let weights = if target.has_weights { Some(colours()?) } else { None };
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
                baked = (0..target.faces as u32).map(|face| rgb(&part.colours(&bytes, face, whole(part)))).collect();
            }
            Some(Texels { accumulation, weights, reduced_depth, baked })
        };
        let systems = self.systems.iter().map(|target| target.as_ref().and_then(&mut system)).collect();
        Some(Captured { scene_depth, behind, systems })
    }
}

fn rgb(picture: &Picture<Vec4>) -> Picture<Vec3> {
    Picture { size: picture.size, texels: picture.texels.iter().map(|texel| texel.xyz()).collect() }
}

impl Captured {
    /// Tells what became of some pixels of the shot that was captured.
    ///
    /// # Errors
    /// As [`probe`]: when it was another shot.
    pub fn probe(&self, shot: &Shot, pixels: &[UVec2]) -> Result<Vec<Probe>, Error> {
        let particles = shot.systems();
        let systems = shot.reference_systems(&particles);
        let frame = shot.reference_frame(&self.scene_depth, &systems);
        Ok(probe(&frame, &self.systems, &self.behind, pixels)?)
    }
}
