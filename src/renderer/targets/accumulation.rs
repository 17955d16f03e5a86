//! What sprites are accumulated into, and the depth that they are compared with.

use std::sync::Arc;

use glam::UVec2;

use super::textures::Textures;
use crate::renderer::gpu::spare::Spare;
use crate::settings::{AccumulationFormat, DepthSource, Settings};

/// One texture of the accumulation target. All share one blend and are cleared to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct AccumulationAttachment {
    pub label: &'static str,
    pub format: wgpu::TextureFormat,
}

/// What the target holds beside its first texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Beside {
    Nothing,
    /// What the weights of the normals sum to.
    Weights,
    /// Light from left, bottom and back, and the sum of weights: the first texture has light from right, top and front, and the
    /// amount.
    SixWay,
}

impl Beside {
    pub fn of(settings: &Settings) -> Self {
        match (settings.is_six_way(), settings.accumulate.sums_weights()) {
            (true, _) => Self::SixWay,
            (false, true) => Self::Weights,
            (false, false) => Self::Nothing,
        }
    }
}

/// The accumulation target's layout. `tiled`: compute shaders write it.
pub(crate) fn accumulation_layout(
    format: AccumulationFormat,
    beside: Beside,
    tiled: bool,
) -> Vec<AccumulationAttachment> {
    let format = texture_format(format);
    let [weights, six_way] =
        if tiled { [TILED_WEIGHTS_FORMAT, TILED_SIX_WAY_FORMAT] } else { [wgpu::TextureFormat::R16Float, format] };
    let first = AccumulationAttachment { label: "haze accumulation: normal + amount", format };
    let beside = match beside {
        Beside::Nothing => None,
        Beside::Weights => Some(AccumulationAttachment { label: "haze accumulation: weights", format: weights }),
        Beside::SixWay => Some(AccumulationAttachment { label: "haze accumulation: six-way", format: six_way }),
    };
    std::iter::once(first).chain(beside).collect()
}

/// No device need let compute shaders write `R16Float`, or blend to this.
const TILED_WEIGHTS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Whatever the first texture is: no device need let a compute shader write to more than four, whose formats it names.
const TILED_SIX_WAY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The formats of targets that compute shaders write: the first texture in either accumulation format, and beside it the sum of
/// weights, or six-way light.
pub(crate) fn tiled_formats() -> [wgpu::TextureFormat; 4] {
    let [float, byte] = [AccumulationFormat::Rgba16Float, AccumulationFormat::Rgba8Unorm].map(texture_format);
    [float, byte, TILED_WEIGHTS_FORMAT, TILED_SIX_WAY_FORMAT]
}

fn texture_format(format: AccumulationFormat) -> wgpu::TextureFormat {
    match format {
        AccumulationFormat::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        AccumulationFormat::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
    }
}

/// A depth format: it can be attached, so that the hardware rejects hidden sprites, and every backend can draw to it,
/// which is not so of `R32Float`.
pub(crate) const REDUCED_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The copy that OpenGL tests against: half the size, so that a system stays within its memory.
pub(crate) const DEPTH_COPY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// Lit smoke: light is HDR, whatever normals are kept in.
pub(crate) const LIT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What decides, beside the size, whether a system's textures can be used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AccumulationKey {
    pub format: AccumulationFormat,
    pub beside: Beside,
    pub depth_source: DepthSource,
    /// Layers are counted as well.
    pub overdraw: bool,
    /// Smoke is lit at this resolution.
    pub lit: bool,
    /// A copy of the reduced depth is needed: the backend cannot test what it samples.
    pub depth_copy: bool,
    /// Compute shaders write it.
    pub tiled: bool,
}

/// The textures of one system. The part in use is the rectangle from (0, 0) of the size of its screen rectangle.
#[derive(Debug)]
pub(crate) struct AccumulationTarget {
    key: AccumulationKey,
    size: UVec2,
    spare: Spare,
    pub attachments: Arc<[wgpu::TextureView]>,
    /// The first attachment once more, for counted layers.
    pub overdraw: Option<Arc<[wgpu::TextureView]>>,
    /// Light times amount, and amount, where smoke is lit at this resolution.
    pub lit: Option<wgpu::TextureView>,
    /// `None` where sprites are compared with the host's own depth.
    pub reduced_depth: Option<wgpu::TextureView>,
    /// The reduced depth once more, coarser, where the backend cannot test what it samples.
    pub depth_copy: Option<wgpu::TextureView>,
    pub bytes: u64,
}

impl AccumulationTarget {
    /// Makes the target ready for `size` texels; `limit` is the size of the whole view at this scale, and the textures need
    /// never be larger. Gives the target, and whether it is new.
    pub fn fit<'a>(
        target: &'a mut Option<Self>,
        device: &wgpu::Device,
        key: AccumulationKey,
        size: UVec2,
        limit: UVec2,
    ) -> (&'a Self, bool) {
        let old = target.as_ref().filter(|target| target.key == key).map_or(UVec2::ZERO, |target| target.size);
        if !target.as_mut().is_some_and(|target| target.key == key && target.serves(size)) {
            // The old textures go before the new ones come.
            *target = None;
        }
        let is_new = target.is_none();
        let target = target.get_or_insert_with(|| {
            // Attachments of one pass are of one size: with the host's depth, of its.
            let is_host = key.depth_source == DepthSource::Host;
            Self::new(device, key, if is_host { size } else { grown(old, size).min(limit) })
        });
        (target, is_new)
    }

    /// True if these textures hold `size` texels, and are not too large for them for long.
    fn serves(&mut self, size: UVec2) -> bool {
        if self.key.depth_source == DepthSource::Host {
            return self.size == size;
        }
        let is_to_spare = self.size.element_product() > 4 * padded(size).element_product();
        let outlasts = self.spare.outlasts(is_to_spare);
        size.cmple(self.size).all() && !outlasts
    }

    fn new(device: &wgpu::Device, key: AccumulationKey, size: UVec2) -> Self {
        let mut textures = Textures { device, bytes: 0, storage: false };
        let mut create = |beside, tiled| -> Arc<[_]> {
            textures.storage = tiled;
            let layout = accumulation_layout(key.format, beside, tiled).into_iter();
            layout.map(|attachment| textures.create_whole(attachment.label, attachment.format, size)).collect()
        };
        let attachments = create(key.beside, key.tiled);
        // Layers are always counted by the blend unit.
        let overdraw = key.overdraw.then(|| create(Beside::Nothing, false));
        textures.storage = false;
        let lit = key.lit.then(|| textures.create_whole("haze lit smoke", LIT_FORMAT, size));
        let is_reduced = key.depth_source == DepthSource::Reduced;
        let reduced_depth = is_reduced.then(|| textures.create_whole("haze reduced depth", REDUCED_DEPTH_FORMAT, size));
        let depth_copy =
            (is_reduced && key.depth_copy).then(|| textures.create_whole("haze depth copy", DEPTH_COPY_FORMAT, size));
        let bytes = textures.bytes;
        Self { key, size, spare: Spare::default(), attachments, overdraw, lit, reduced_depth, depth_copy, bytes }
    }
}

/// Rounds up, so that a box that grows or drifts a little keeps its textures.
fn padded(size: UVec2) -> UVec2 {
    let step = |side: u32| side.next_multiple_of(64);
    UVec2::new(step(size.x), step(size.y))
}

/// A side that is too short becomes half as long again, so that a box which grows on is not followed texel by texel; one that
/// is long enough stays, unless the whole would be four times too large.
fn grown(old: UVec2, needed: UVec2) -> UVec2 {
    let side = |old: u32, needed: u32| if needed <= old { old } else { needed.max(old + old / 2) };
    let grown = padded(UVec2::new(side(old.x, needed.x), side(old.y, needed.y)));
    if grown.element_product() > 4 * padded(needed).element_product() { padded(needed) } else { grown }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_that_grows_steadily_is_given_new_textures_a_few_times_only() {
        let (mut size, mut renewals) = (UVec2::splat(64), 0);
        for side in 64..2000 {
            let needed = UVec2::new(side, 64 + side / 3);
            if needed.cmpgt(size).any() {
                size = grown(size, needed);
                renewals += 1;
            }
            assert!(needed.cmple(size).all() && size.element_product() <= 4 * padded(needed).element_product());
        }
        // log(2000 / 64) / log(1.5) = 8.5 for either side; step by step of 64 it would be 31.
        assert!(renewals <= 17, "{renewals}");
    }
}
