//! Size-dependent textures and their bind groups, nothing else.

use glam::UVec2;

use crate::bounds::TargetRect;
use crate::pass::{Layouts, array_layers, diffuse_bake};
use crate::settings::{AccumulationFormat, DepthSource, DiffuseMode};

/// One texture of the accumulation target. All share the blend ONE, ONE_MINUS_SRC_ALPHA and are cleared to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct AccumulationAttachment {
    pub label: &'static str,
    pub format: wgpu::TextureFormat,
}

/// Textures of the accumulation target. One today; tint, emission and six-way light maps will be further ones.
pub(crate) const ATTACHMENTS: usize = 1;

/// The accumulation target's layout.
pub(crate) fn accumulation_layout(format: AccumulationFormat) -> [AccumulationAttachment; ATTACHMENTS] {
    let format = match format {
        AccumulationFormat::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        AccumulationFormat::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
    };
    [AccumulationAttachment { label: "haze accumulation: normal + amount", format }]
}

/// A depth format: it can be attached, so that the hardware rejects hidden sprites, and every backend can draw to it,
/// which is not so of `R32Float`.
pub(crate) const REDUCED_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The copy that OpenGL tests against: half the size, so that a system stays within its memory.
pub(crate) const DEPTH_COPY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// What decides whether a system's textures can be used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TargetsKey {
    pub format: AccumulationFormat,
    pub depth_source: DepthSource,
    pub diffuse_mode: DiffuseMode,
}

/// The textures of one system. The part in use is the rectangle from (0, 0) of the size of its screen rectangle.
#[derive(Debug)]
pub(crate) struct Targets {
    key: TargetsKey,
    size: UVec2,
    scene_depth: wgpu::TextureView,
    pub accumulation: [wgpu::TextureView; ATTACHMENTS],
    /// None where sprites are compared with the host's own depth.
    pub reduced_depth: Option<wgpu::TextureView>,
    /// The reduced depth once more, coarser, where the backend cannot test what it samples.
    pub depth_copy: Option<wgpu::TextureView>,
    /// One view per face of the cubemap, one for the motif, none for the other diffuse modes.
    pub baked_diffuse: Vec<wgpu::TextureView>,
    /// Group 3 of accumulate.
    pub accumulate_inputs: wgpu::BindGroup,
    /// Group 3 of transfer and specular_scatter.
    pub transfer_inputs: wgpu::BindGroup,
    pub bytes: u64,
}

impl Targets {
    /// True if these textures serve `rect` too: they hold it, and are not more than four times too large.
    pub fn fits(&self, key: TargetsKey, rect: &TargetRect, scene_depth: &wgpu::TextureView) -> bool {
        let holds = rect.size.cmple(self.size).all();
        let wasteful = self.size.element_product() > 4 * padded(rect.size).element_product();
        let exact = key.depth_source == DepthSource::Reduced || self.size == rect.size;
        // Only the host's own depth is bound with them.
        let same_depth = key.depth_source == DepthSource::Reduced || self.scene_depth == *scene_depth;
        self.key == key && holds && !wasteful && exact && same_depth
    }

    /// `limit`: size of the whole picture at this scale; the textures need never be larger.
    pub fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        key: TargetsKey,
        rect: &TargetRect,
        limit: UVec2,
        scene_depth: &wgpu::TextureView,
    ) -> Self {
        let size = match key.depth_source {
            DepthSource::Reduced => padded(rect.size).min(limit),
            DepthSource::Host => rect.size,
        };
        let mut bytes = 0;
        let mut texture = |label, format: wgpu::TextureFormat, size: UVec2, layers| {
            let texel = u64::from(format.block_copy_size(None).unwrap_or(16));
            bytes += texel * u64::from(size.x) * u64::from(size.y) * u64::from(layers);
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        let whole = |texture: wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());

        let accumulation = accumulation_layout(key.format)
            .map(|attachment| whole(texture(attachment.label, attachment.format, size, 1)));
        let reduced_depth = (key.depth_source == DepthSource::Reduced)
            .then(|| whole(texture("haze reduced depth", REDUCED_DEPTH_FORMAT, size, 1)));
        let needs_copy = key.depth_source == DepthSource::Reduced && !layouts.read_only_depth;
        let depth_copy = needs_copy.then(|| whole(texture("haze depth copy", DEPTH_COPY_FORMAT, size, 1)));

        let (side, layers) = diffuse_bake::size_and_layers(key.diffuse_mode).unwrap_or((1, 1));
        let baked = texture("haze baked diffuse", diffuse_bake::FORMAT, UVec2::splat(side), array_layers(layers));
        let baked_array = baked.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let baked_diffuse = if diffuse_bake::size_and_layers(key.diffuse_mode).is_some() {
            let layer = |layer| {
                baked.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            };
            (0..layers).map(layer).collect()
        } else {
            Vec::new()
        };

        let depth = reduced_depth.as_ref().unwrap_or(scene_depth);
        let entry =
            |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
        let accumulate_inputs = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze accumulate inputs"),
            layout: &layouts.accumulate,
            entries: &[entry(0, depth)],
        });
        let transfer_inputs = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze transfer inputs"),
            layout: &layouts.transfer,
            entries: &[entry(0, &accumulation[0]), entry(1, depth), entry(2, &baked_array)],
        });
        let scene_depth = scene_depth.clone();
        Self {
            key,
            size,
            scene_depth,
            accumulation,
            reduced_depth,
            depth_copy,
            baked_diffuse,
            accumulate_inputs,
            transfer_inputs,
            bytes,
        }
    }
}

/// Rounds up, so that a box that grows or drifts a little keeps its textures.
fn padded(size: UVec2) -> UVec2 {
    let step = |side: u32| side.next_multiple_of(64);
    UVec2::new(step(size.x), step(size.y))
}
