//! The accumulation pass and the way back to full resolution.

use crate::fields::{FieldVisitor, Fields};

choice! {
    /// Texel format of the accumulation target.
    AccumulationFormat {
        /// 8 bytes. The default.
        #[default]
        Rgba16Float = "rgba16float",
        /// 4 bytes, half the bandwidth. Amounts below about 0.02 are lost to rounding, and the sum stalls near 0.9.
        Rgba8Unorm = "rgba8unorm",
    }
}

choice! {
    /// How a normal is written into the accumulation target.
    NormalEncoding {
        /// -1..1 as it is. Needs `rgba16float`.
        #[default]
        Signed = "signed",
        /// n/2 + 1/2, as OTEE's 8-bit target needs.
        Biased = "biased",
    }
}

choice! {
    /// How the accumulated normal is read back.
    NormalDecode {
        /// Takes the amount into account: right at every amount.
        #[default]
        Exact = "exact",
        /// `normalize(rgb * 2 - 1)`, as printed in OTEE. Wrong wherever the amount is below 1; kept for comparison.
        Literal = "literal",
    }
}

choice! {
    /// Which scene depth the sprites are compared with.
    DepthSource {
        /// A copy at the resolution of the accumulation target. Works everywhere.
        #[default]
        Reduced = "reduced",
        /// The host's own depth buffer, attached read-only; the hardware rejects hidden sprites. Needs scale 1, a
        /// depth-only format, and a backend with read-only depth attachments (not OpenGL).
        Host = "host",
    }
}

choice! {
    /// Which of the depths under a reduced texel is kept.
    DepthDownsample {
        /// Farthest and nearest in alternating texels: an upsampler finds both sides of an edge close by.
        #[default]
        Checkerboard = "checkerboard",
        /// The farthest: smoke covers thin things, and never leaves a halo round them.
        Max = "max",
        /// The nearest: thin things stay clear of smoke, with a halo.
        Min = "min",
        /// The texel's middle pixel: cheapest, shimmers on thin things.
        Point = "point",
    }
}

choice! {
    /// How the reduced target is brought to full resolution.
    Upsample {
        /// Bilinear where the four depths agree, else the texel whose depth is closest: a row of dots can show where an
        /// edge crosses a steep gradient of smoke.
        NearestDepth = "nearest_depth",
        /// Bilinear weights times a falloff over the depth difference. Smooth on both sides of an edge.
        #[default]
        JointBilateral = "joint_bilateral",
        /// Ignores depth. Halos at edges; the baseline.
        Bilinear = "bilinear",
    }
}

/// The accumulation pass: how sprites become normal + amount.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Accumulate {
    /// Texel format of the target.
    pub format: AccumulationFormat,
    /// How normals are written.
    pub encoding: NormalEncoding,
    /// How normals are read.
    pub decode: NormalDecode,
    /// Pixels of the picture per texel of the target, along each side. Cost falls with its square.
    pub scale: u32,
    /// Most texels along the picture's longer side; raises `scale` on large pictures.
    pub max_side: u32,
    /// Which scene depth sprites are compared with.
    pub depth_source: DepthSource,
    /// Which depth a reduced texel keeps.
    pub depth_downsample: DepthDownsample,
    /// How the target is brought to full resolution.
    pub upsample: Upsample,
    /// Multiplies the amount of every sprite.
    pub opacity: f32,
}

impl Default for Accumulate {
    fn default() -> Self {
        Self {
            format: AccumulationFormat::default(),
            encoding: NormalEncoding::default(),
            decode: NormalDecode::default(),
            scale: 2,
            max_side: 4096,
            depth_source: DepthSource::default(),
            depth_downsample: DepthDownsample::default(),
            upsample: Upsample::default(),
            opacity: 1.0,
        }
    }
}

impl Fields for Accumulate {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("scale", &mut self.scale, 1..=16, "pixels");
        visitor.integer("max_side", &mut self.max_side, 16..=16384, "texels");
        visitor.number("opacity", &mut self.opacity, 0.0..=1.0, "");
    }
}
