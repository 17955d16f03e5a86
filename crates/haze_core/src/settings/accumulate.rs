//! Settings of the accumulation pass and of the upsampling to full resolution.

use glam::UVec2;

use super::choice::choice;
use super::settings_macro::settings;

/// Largest divisor of the target's resolution, pixels per texel.
pub(super) const MAX_SCALE: u32 = 16;

/// Coarsest scale of the scale mode `auto`. Coarser ones save little more, and show texels at the edges of thin objects, which
/// the CPU does not know.
pub const COARSEST_AUTO_SCALE: u32 = 4;

choice! {
    /// Texel format of the accumulation target.
    AccumulationFormat {
        /// Half floats, 8 bytes a texel. The default.
        #[default]
        Rgba16Float = "rgba16float",
        /// 8 bits a channel, 4 bytes a texel: half the bandwidth. Amounts below about 0.02 are lost to rounding, and
        /// the sum stalls near 0.9.
        Rgba8Unorm = "rgba8unorm",
    }
}

choice! {
    /// Encoding of normals in the accumulation target.
    NormalEncoding {
        /// -1..1, stored unchanged. Needs `rgba16float`.
        #[default]
        Signed = "signed",
        /// n/2 + 1/2, as OTEE's 8-bit target needs.
        Biased = "biased",
    }
}

choice! {
    /// Decoding of the accumulated normals.
    NormalDecode {
        /// Takes the amount into account: correct at every amount.
        #[default]
        Exact = "exact",
        /// `normalize(rgb * 2 - 1)`, as printed in OTEE. Wrong wherever the amount is below 1; kept for comparison.
        Literal = "literal",
    }
}

choice! {
    /// Order in which normals are blended; the amount does not depend on it. `docs/order.md` compares them.
    BlendOrder {
        /// Sprites are blended back to front, as in OTEE. A sprite that passes another in depth changes the image
        /// abruptly, and the edges of the nearest sprites show.
        #[default]
        Sorted = "sorted",
        /// Normals are added up, with less weight the more smoke is in front of their sprite: no sorting, no pops, no
        /// visible layers. Needs `rgba16float`.
        Weighted = "weighted",
    }
}

choice! {
    /// Choice of the target's scale. `docs/upsampling.md` has the error of each scale.
    ScaleMode {
        /// `downscale`, as it is.
        #[default]
        Fixed = "fixed",
        /// The coarsest from 1 to 4 whose predicted error is at most `max_error`: coarse for large soft smoke, fine for small
        /// and detailed smoke. It changes with the view. Particles in a host's buffer keep `downscale`.
        Auto = "auto",
    }
}

choice! {
    /// Scene depth that the sprites are compared with.
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
    /// Depth that a reduced texel keeps of the pixels under it.
    DepthDownsample {
        /// Farthest and nearest in alternating texels: an upsampler finds both sides of an edge close by.
        #[default]
        Checkerboard = "checkerboard",
        /// The farthest: smoke covers thin objects, and never leaves a halo around them.
        Max = "max",
        /// The nearest: thin objects stay clear of smoke, with a halo around them.
        Min = "min",
        /// The texel's middle pixel: cheapest, but thin objects shimmer.
        Point = "point",
    }
}

choice! {
    /// Upsampling of the reduced target to full resolution.
    Upsample {
        /// Bilinear where depth hardly changes, elsewhere the surrounding texels, fitted to the pixel's depth. Smooth on
        /// both sides of an edge and on surfaces at a grazing angle. `docs/upsampling.md` compares them.
        #[default]
        Guided = "guided",
        /// Bilinear weights times a falloff over the depth difference. Smooth on both sides of an edge, jagged on
        /// surfaces at a grazing angle.
        JointBilateral = "joint_bilateral",
        /// Bilinear where the four depths agree, else the texel that is closest in depth. A row of dots can show where
        /// an edge crosses a steep gradient of smoke.
        NearestDepth = "nearest_depth",
        /// Bilinear, without depth: halos at edges. The baseline.
        Bilinear = "bilinear",
    }
}

choice! {
    /// Resolution at which diffuse light and soft scatter are computed. `docs/upsampling.md` has the cost and the error
    /// of each.
    LightingResolution {
        /// `target` where the ramps in use are smooth at this scale, else `full`.
        #[default]
        Auto = "auto",
        /// Once per pixel of the image, from the upsampled normal and amount.
        Full = "full",
        /// Once per texel of the target, then upsampled: a light costs `downscale`² times less. Hard steps in a diffuse
        /// ramp become soft.
        Target = "target",
    }
}

choice! {
    /// Layers that the path `tiled` adds up. `docs/tiled.md` has the error.
    Traversal {
        /// Stops where a texel lets less than a thousandth through. With the order `weighted` all layers are added up,
        /// because normals count there regardless of the smoke in front.
        #[default]
        UntilOpaque = "visible",
        /// All layers, as the path `raster` does.
        All = "all",
    }
}

settings! {
    /// Accumulation pass: sprites to normal and amount.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Accumulate {
        /// Texel format of the target: smooth thin smoke, or half the memory.
        format: AccumulationFormat = AccumulationFormat::default(), choice;
        /// Encoding of normals in the target. The 8-bit format needs `biased`.
        encoding: NormalEncoding = NormalEncoding::default(), choice;
        /// Decoding of normals. The literal one turns thin smoke away from the light.
        decode: NormalDecode = NormalDecode::default(), choice;
        /// Order in which normals are blended: crisp layers that pop, or soft ones without pops.
        order: BlendOrder = BlendOrder::default(), choice;
        /// Weight of normals with the order `weighted`: e^(-depth_weight · optical depth in front of the sprite).
        /// Higher: the front of the smoke dominates. 0: all sprites count alike.
        depth_weight: f32 = 0.4, number(0.0..=4.0, "");
        /// Layers that the path `tiled` adds up: the visible ones, or all.
        layers: Traversal = Traversal::default(), choice;
        /// Pixels of the image per texel of the target, along each side. Higher: less sharp, and cheaper by the
        /// square.
        downscale: u32 = 2, integer(1..=MAX_SCALE, "pixels");
        /// Choice of the scale: `downscale`, or by the detail of the smoke.
        scale_mode: ScaleMode = ScaleMode::default(), choice;
        /// Largest predicted error with the scale mode `auto`: root mean square over the smoke, of the amount 1. Higher:
        /// coarser and cheaper.
        max_error: f32 = 0.005, number(0.001..=0.1, "");
        /// Most texels along the image's longer side. Lower raises `downscale` on large images.
        max_side: u32 = 4096, integer(16..=16384, "texels");
        /// Scene depth that sprites are compared with.
        depth_source: DepthSource = DepthSource::default(), choice;
        /// Depth that a reduced texel keeps: thin objects in front stay clear of smoke, or are covered.
        depth_downsample: DepthDownsample = DepthDownsample::default(), choice;
        /// Upsampling of the target to full resolution: the look of edges of objects in the smoke.
        upsample: Upsample = Upsample::default(), choice;
        /// Resolution at which the smoke is lit. Coverage and the glow of lights always have full resolution.
        lighting_resolution: LightingResolution = LightingResolution::default(), choice;
        /// Multiplies the amount of every sprite. Lower: thinner smoke.
        opacity: f32 = 1.0, number(0.0..=1.0, "");
    }
}

impl BlendOrder {
    /// True if this order and encoding need the sum of the normals' weights.
    pub fn sums_weights(self, encoding: NormalEncoding) -> bool {
        (self, encoding) == (Self::Weighted, NormalEncoding::Biased)
    }
}

impl Accumulate {
    /// True if the target also stores the sum of the normals' weights, without which biased normals cannot be decoded.
    pub fn sums_weights(&self) -> bool {
        self.order.sums_weights(self.encoding)
    }

    /// Sets a fixed scale, pixels per texel.
    pub fn fix_scale(&mut self, scale: u32) {
        self.downscale = scale;
        self.scale_mode = ScaleMode::Fixed;
    }

    /// Fixed divisor in use: `downscale`, raised until the image's longer side has at most `max_side` texels.
    pub fn effective_scale(&self, image: UVec2) -> u32 {
        self.downscale.max(self.finest_scale(image))
    }

    /// Smallest divisor at which the image's longer side has at most `max_side` texels.
    pub fn finest_scale(&self, image: UVec2) -> u32 {
        image.max_element().div_ceil(self.max_side.max(1)).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn max_side_raises_the_scale() {
        let scale = |scale, max_side, image| {
            Accumulate { downscale: scale, max_side, ..Accumulate::default() }.effective_scale(image)
        };
        assert_eq!(scale(2, 4096, UVec2::new(1920, 1080)), 2);
        assert_eq!(scale(2, 480, UVec2::new(1920, 1080)), 4);
        assert_eq!(scale(1, 1, UVec2::new(7, 3)), 7);
    }
}
