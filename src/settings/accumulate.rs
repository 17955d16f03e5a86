//! The accumulation pass and the way back to full resolution.

use glam::UVec2;

use super::choice::choice;
use super::table::settings;

/// The coarsest scale of the target, pixels per texel.
pub(super) const COARSEST: u32 = 16;

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
    /// What the blended normals take their order from; the amount needs none. `docs/order.md` compares them.
    Order {
        /// Sprites are blended back to front, as OTEE has it. A sprite that overtakes another in depth changes the picture at
        /// once, and the edges of the nearest show.
        #[default]
        Sorted = "sorted",
        /// Normals are added up, the less the more smoke is in front of their sprite: no sorting, no pops, no layers. Needs
        /// `rgba16float`.
        Weighted = "weighted",
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
        /// Bilinear where depth hardly changes; elsewhere a fit to the sixteen texels around, by place and by depth. Smooth
        /// on both sides of an edge and on surfaces seen at a grazing angle. `docs/upsampling.md` compares them.
        #[default]
        Guided = "guided",
        /// Bilinear weights times a falloff over the depth difference. Smooth on both sides of an edge; teeth show on
        /// surfaces seen at a grazing angle.
        JointBilateral = "joint_bilateral",
        /// Bilinear where the four depths agree, else the texel whose depth is closest: a row of dots can show where an
        /// edge crosses a steep gradient of smoke.
        NearestDepth = "nearest_depth",
        /// Ignores depth. Halos at edges; the baseline.
        Bilinear = "bilinear",
    }
}

choice! {
    /// How finely diffuse light and soft scatter are worked out. `docs/upsampling.md` has what each costs and loses.
    LightingResolution {
        /// Once per pixel of the picture, from the upsampled normal and amount.
        #[default]
        Full = "full",
        /// Once per texel of the target, and upsampled: a light costs `scale`² times less. Hard steps in a
        /// diffuse ramp turn soft.
        Target = "target",
    }
}

choice! {
    /// How far the path `tiled` goes down the layers. `docs/tiled.md` has what it loses.
    Layers {
        /// As far as there is something to see: until a texel lets less than a thousandth through. All of them where normals are
        /// weighted, for they count whatever is in front.
        #[default]
        Visible = "visible",
        /// All of them, as the path `raster`.
        All = "all",
    }
}

settings! {
    /// The accumulation pass: how sprites become normal + amount.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Accumulate {
        /// Texel format of the target: half the memory, or smooth thin smoke.
        format: AccumulationFormat = AccumulationFormat::default(), choice;
        /// How normals are written.
        encoding: NormalEncoding = NormalEncoding::default(), choice;
        /// How normals are read. The wrong way turns thin smoke away from the light.
        decode: NormalDecode = NormalDecode::default(), choice;
        /// What the normals take their order from: crisp layers that pop, or none.
        order: Order = Order::default(), choice;
        /// For the order `weighted`: a normal counts e^(-depth_weight · the optical depth in front of its sprite). 0: all alike.
        depth_weight: f32 = 0.4, number(0.0..=4.0, "");
        /// How far the path `tiled` goes down the layers.
        layers: Layers = Layers::default(), choice;
        /// Pixels of the picture per texel of the target, along each side. Cost falls with its square.
        scale: u32 = 2, integer(1..=COARSEST, "pixels");
        /// Most texels along the picture's longer side; raises `scale` on large pictures.
        max_side: u32 = 4096, integer(16..=16384, "texels");
        /// Which scene depth sprites are compared with.
        depth_source: DepthSource = DepthSource::default(), choice;
        /// Which depth a reduced texel keeps: whether thin things in front stay clear of smoke.
        depth_downsample: DepthDownsample = DepthDownsample::default(), choice;
        /// How the target is brought to full resolution: what edges of things in the smoke look like.
        upsample: Upsample = Upsample::default(), choice;
        /// How finely the smoke is lit; its coverage and the glow of lights are those of pixels.
        lighting_resolution: LightingResolution = LightingResolution::default(), choice;
        /// Multiplies the amount of every sprite: thinner, or thicker smoke.
        opacity: f32 = 1.0, number(0.0..=1.0, "");
    }
}

impl Order {
    /// True if normals in this order and encoding need the sum of their weights.
    pub fn sums_weights(self, encoding: NormalEncoding) -> bool {
        (self, encoding) == (Self::Weighted, NormalEncoding::Biased)
    }
}

impl Accumulate {
    /// True if the target holds the sum of the weights of normals, too: biased ones cannot be read without it.
    pub fn sums_weights(&self) -> bool {
        self.order.sums_weights(self.encoding)
    }

    /// True if the smoke in a picture of this size is lit once per texel, and that is not once per pixel.
    pub fn lights_target(&self, picture: UVec2) -> bool {
        self.lighting_resolution == LightingResolution::Target && self.effective_scale(picture) > 1
    }

    /// The divisor in use: `scale`, raised until the picture's longer side has at most `max_side` texels.
    pub fn effective_scale(&self, picture: UVec2) -> u32 {
        self.scale.max(picture.max_element().div_ceil(self.max_side.max(1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clamp_raises_the_scale() {
        let scale =
            |scale, max_side, picture| Accumulate { scale, max_side, ..Accumulate::default() }.effective_scale(picture);
        assert_eq!(scale(2, 4096, UVec2::new(1920, 1080)), 2);
        assert_eq!(scale(2, 480, UVec2::new(1920, 1080)), 4);
        assert_eq!(scale(1, 1, UVec2::new(7, 3)), 7);
    }
}
