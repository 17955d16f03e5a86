//! Textures of the accumulation target by role: formats, blend states and shader constants. Every texture is cleared to
//! zero.

use haze_core::error::FieldError;
use haze_core::settings::{AccumulationFormat, BlendOrder, Settings};
use haze_core::view_setup::{AttachmentRole, AttachmentSet, MAX_TARGET_ATTACHMENTS};

use crate::renderer::gpu::pipeline::{ADD_ALL, Constant, PREMULTIPLIED_OVER, WEIGHTED_SUM};

/// Properties of a texture of the accumulation target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attachment {
    pub role: AttachmentRole,
    pub label: &'static str,
    /// Override constant of `shaders/lib/attachments.wgsl` that has the texture's index; `None` for the first texture,
    /// whose index is always 0.
    slot_constant: Option<&'static str>,
    /// Format if the hardware blends into it. Must be renderable and blendable on every device.
    raster: Format,
    /// Format if compute shaders write it. Must be a storage format on every device: not `R16Float`.
    tiled: Format,
    /// Blend states by order.
    sorted: wgpu::BlendState,
    weighted: wgpu::BlendState,
}

#[derive(Clone, Copy, Debug)]
enum Format {
    /// `accumulate.format` of the settings.
    OfSettings,
    Fixed(wgpu::TextureFormat),
}

/// The table: one row per role, in the order of [`AttachmentRole::ALL`].
const ATTACHMENTS: [Attachment; AttachmentRole::ALL.len()] = [
    Attachment {
        role: AttachmentRole::NormalAndAmount,
        label: "haze accumulation: normal + amount",
        slot_constant: None,
        raster: Format::OfSettings,
        tiled: Format::OfSettings,
        sorted: PREMULTIPLIED_OVER,
        weighted: WEIGHTED_SUM,
    },
    Attachment {
        role: AttachmentRole::SixWay,
        label: "haze accumulation: six-way",
        slot_constant: Some("SIX_WAY_SLOT"),
        raster: Format::OfSettings,
        tiled: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        sorted: PREMULTIPLIED_OVER,
        // The alpha is a sum of weights too.
        weighted: ADD_ALL,
    },
    Attachment {
        role: AttachmentRole::Weights,
        label: "haze accumulation: weights",
        slot_constant: Some("WEIGHTS_SLOT"),
        // WebGPU guarantees neither blending into `R32Float` nor storage writes to `R16Float`.
        raster: Format::Fixed(wgpu::TextureFormat::R16Float),
        tiled: Format::Fixed(wgpu::TextureFormat::R32Float),
        sorted: PREMULTIPLIED_OVER,
        weighted: ADD_ALL,
    },
    Attachment {
        role: AttachmentRole::OpticalDepths,
        label: "haze accumulation: optical depths",
        slot_constant: Some("OPTICAL_DEPTHS_SLOT"),
        raster: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        tiled: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        sorted: PREMULTIPLIED_OVER,
        weighted: ADD_ALL,
    },
    Attachment {
        role: AttachmentRole::Depth,
        label: "haze accumulation: depth",
        slot_constant: Some("DEPTH_SLOT"),
        raster: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        tiled: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        sorted: PREMULTIPLIED_OVER,
        weighted: ADD_ALL,
    },
    Attachment {
        role: AttachmentRole::Heat,
        label: "haze accumulation: heat",
        slot_constant: Some("HEAT_SLOT"),
        raster: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        tiled: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        sorted: PREMULTIPLIED_OVER,
        weighted: ADD_ALL,
    },
    Attachment {
        role: AttachmentRole::Tint,
        label: "haze accumulation: tint",
        slot_constant: Some("TINT_SLOT"),
        raster: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        tiled: Format::Fixed(wgpu::TextureFormat::Rgba16Float),
        sorted: PREMULTIPLIED_OVER,
        weighted: ADD_ALL,
    },
];

/// WebGPU's default limit on the color attachments of a pass, bytes per sample.
const MAX_BYTES_PER_SAMPLE: u32 = 32;

/// Formats of the textures that tile_accumulate writes, by slot. Slots that a system does not use have the placeholders'
/// format.
pub(crate) type TiledFormats = [wgpu::TextureFormat; MAX_TARGET_ATTACHMENTS];

/// Format of the placeholders that tile_accumulate binds instead of textures that a system does not have, and the
/// format of all targets in `shaders/tile_accumulate.wgsl`.
pub(crate) const PLACEHOLDER_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Returns the rows of a set, in the order of the textures.
pub(crate) fn attachments(set: AttachmentSet) -> impl Iterator<Item = &'static Attachment> {
    ATTACHMENTS.iter().filter(move |attachment| set.contains(attachment.role))
}

/// Returns the formats that tile_accumulate writes.
pub(crate) fn tiled_formats(set: AttachmentSet, format: AccumulationFormat) -> TiledFormats {
    let mut used = attachments(set).map(|attachment| attachment.tiled_format(format));
    std::array::from_fn(|_| used.next().unwrap_or(PLACEHOLDER_FORMAT))
}

/// Returns the override constants of `shaders/lib/attachments.wgsl`.
pub(crate) fn attachment_constants(set: AttachmentSet) -> impl Iterator<Item = Constant> {
    let count = ("ATTACHMENT_COUNT", attachments(set).count() as f64);
    let slot = move |attachment: &Attachment| {
        Some((attachment.slot_constant?, set.slot(attachment.role).unwrap_or_default() as f64))
    };
    std::iter::once(count).chain(ATTACHMENTS.iter().filter_map(slot))
}

impl Format {
    fn resolve(self, of_settings: AccumulationFormat) -> wgpu::TextureFormat {
        match (self, of_settings) {
            (Self::Fixed(format), _) => format,
            (Self::OfSettings, AccumulationFormat::Rgba16Float) => wgpu::TextureFormat::Rgba16Float,
            (Self::OfSettings, AccumulationFormat::Rgba8Unorm) => wgpu::TextureFormat::Rgba8Unorm,
        }
    }
}

impl Attachment {
    /// Returns the texture's format if the hardware blends into it. `format`: that of the settings.
    pub fn raster_format(&self, format: AccumulationFormat) -> wgpu::TextureFormat {
        self.raster.resolve(format)
    }

    /// Returns the texture's format if compute shaders write it. `format`: that of the settings.
    pub fn tiled_format(&self, format: AccumulationFormat) -> wgpu::TextureFormat {
        self.tiled.resolve(format)
    }

    /// Returns the texture's blend state.
    pub fn blend(&self, order: BlendOrder) -> wgpu::BlendState {
        match order {
            BlendOrder::Sorted => self.sorted,
            BlendOrder::Weighted => self.weighted,
        }
    }
}

/// Refuses sets that need more textures, or more bytes per sample, than every WebGPU device has.
///
/// # Errors
/// Names the setting of system `index` that adds the first texture that does not fit.
pub(crate) fn validate_attachments(index: usize, settings: &Settings) -> Result<(), FieldError> {
    let format = settings.accumulate.format;
    let rows =
        attachments(AttachmentSet::of(settings)).map(|attachment| (attachment.role, attachment.raster_format(format)));
    validate_rows(index, settings, rows)
}

fn validate_rows(
    index: usize,
    settings: &Settings,
    rows: impl Iterator<Item = (AttachmentRole, wgpu::TextureFormat)>,
) -> Result<(), FieldError> {
    let mut count = 0;
    let mut bytes = 0;
    for (role, format) in rows {
        count += 1;
        bytes = bytes_with(bytes, format);
        if count > MAX_TARGET_ATTACHMENTS || bytes > MAX_BYTES_PER_SAMPLE {
            let (setting, value) = role.setting(settings);
            let expected = format!(
                "another value, or fewer settings that add textures to the accumulation target: this is its texture \
                 {count} of at most {MAX_TARGET_ATTACHMENTS}, and takes it to {bytes} bytes per sample of at most \
                 {MAX_BYTES_PER_SAMPLE}"
            );
            let field = format!("systems[{index}].settings.{setting}");
            return Err(FieldError::new(field, format!("{value:?}"), expected));
        }
    }
    Ok(())
}

/// Returns the bytes per sample of a pass with one more attachment, as WebGPU counts them: aligned, and with 8 bytes
/// for `Rgba8Unorm`.
fn bytes_with(bytes: u32, format: wgpu::TextureFormat) -> u32 {
    let cost = format.target_pixel_byte_cost().unwrap_or(MAX_BYTES_PER_SAMPLE + 1);
    bytes.next_multiple_of(format.target_component_alignment().unwrap_or(1)) + cost
}

#[cfg(test)]
mod tests {
    use super::*;
    use AttachmentRole::{Heat, NormalAndAmount, SixWay, Tint, Weights};
    use wgpu::TextureFormat::{R16Float, R32Float, Rgba8Unorm, Rgba16Float, Rgba32Float};

    #[test]
    fn rows_have_the_order_of_the_roles() {
        assert_eq!(ATTACHMENTS.map(|attachment| attachment.role), AttachmentRole::ALL);
        assert!(ATTACHMENTS[1..].iter().all(|attachment| attachment.slot_constant.is_some()));
    }

    #[test]
    fn sets_beyond_four_textures_or_32_bytes_per_sample_are_refused_by_name() {
        let refused = |rows: &[(AttachmentRole, wgpu::TextureFormat)]| {
            validate_rows(2, &Settings::default(), rows.iter().copied()).map_err(|error| error.to_string())
        };
        let four = [(NormalAndAmount, Rgba16Float), (SixWay, Rgba16Float), (SixWay, Rgba8Unorm), (SixWay, Rgba16Float)];
        assert_eq!(refused(&four), Ok(()));
        let five: Vec<_> = [NormalAndAmount, SixWay, SixWay, SixWay, Weights].map(|role| (role, R16Float)).to_vec();
        let error = refused(&five).unwrap_err();
        assert!(error.starts_with("systems[2].settings.accumulate.order: \"weighted\""), "{error}");
        assert!(error.contains("texture 5 of at most 4, and takes it to 10 bytes"), "{error}");
        let error = refused(&[(NormalAndAmount, Rgba32Float), (Weights, R32Float), (SixWay, Rgba32Float)]).unwrap_err();
        assert!(
            error.starts_with("systems[2].settings.lighting: \"six_way\"") && error.contains("to 36 bytes"),
            "{error}"
        );
    }

    #[test]
    fn bytes_per_sample_are_aligned_as_webgpu_does() {
        assert_eq!(bytes_with(0, Rgba8Unorm), 8);
        assert_eq!(bytes_with(2, R32Float), 8);
        assert_eq!(bytes_with(8, R16Float), 10);
        // Known sets: normal and amount with six-way light, and with weights.
        assert_eq!(bytes_with(8, Rgba16Float), 16);
    }

    #[test]
    fn slots_and_formats_follow_the_set() {
        let set = [NormalAndAmount, Weights].into_iter().collect();
        let constants: Vec<_> = attachment_constants(set).collect();
        let slots = [
            ("SIX_WAY_SLOT", 0.0),
            ("WEIGHTS_SLOT", 1.0),
            ("OPTICAL_DEPTHS_SLOT", 0.0),
            ("DEPTH_SLOT", 0.0),
            ("HEAT_SLOT", 0.0),
            ("TINT_SLOT", 0.0),
        ];
        assert_eq!(constants, [&[("ATTACHMENT_COUNT", 2.0)], slots.as_slice()].concat());
        let formats = tiled_formats(set, AccumulationFormat::Rgba8Unorm);
        assert_eq!(formats, [Rgba8Unorm, R32Float, PLACEHOLDER_FORMAT, PLACEHOLDER_FORMAT]);
        // Six-way light has weights of its own: no system has both.
        let all = AttachmentRole::ALL.into_iter().filter(|role| ![SixWay, Heat, Tint].contains(role)).collect();
        let formats = tiled_formats(all, AccumulationFormat::Rgba16Float);
        assert_eq!(formats, [Rgba16Float, R32Float, Rgba16Float, Rgba16Float]);
        for format in [AccumulationFormat::Rgba16Float, AccumulationFormat::Rgba8Unorm] {
            let rows = attachments(all).map(|attachment| (attachment.role, attachment.raster_format(format)));
            validate_rows(0, &Settings::default(), rows).unwrap();
        }
    }
}
