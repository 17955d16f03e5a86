//! Cost model of both accumulation paths.

use haze_core::error::FieldError;
use haze_core::glam::UVec2;
use haze_core::settings::Technique;

use super::workload::PathWorkload;

/// Side of the squares that [`PathCosts::entry`] counts, texels.
const BIN: f64 = 32.0;
/// Side of the squares that a CPU's cores rasterize, one core per square, texels.
const RASTER_SQUARE: u32 = 64;
/// Optical depth at which a traversal stops: `OPAQUE` in `shaders/tile_accumulate.wgsl`, doubled because texels that
/// are traversed together wait for the last texel.
const STOP_OPTICAL_DEPTH: f64 = 2.0 * 10.0 * std::f64::consts::LN_2;
/// Fraction of the traversals that never stop: those at the borders of the smoke. With this value and
/// `STOP_OPTICAL_DEPTH`, the model is within 5 % of an H200 for large sprites.
const NEVER_OPAQUE_FRACTION: f64 = 0.5;
/// Tolerance of a probe on a CPU: if the measured ratio of the two paths differs from the class's by less than this
/// factor, it is ignored; otherwise only the excess counts. Reason: other load on the machine slows the traversal 1.5
/// times more than `raster`, for seconds.
const CPU_PROBE_TOLERANCE: f32 = 1.6;

/// Least ratio of the time of a drawn texel to that of a computed one at which pixels are computed: between llvmpipe's, 1.4,
/// and an NVIDIA H200's, 26; devices in between were not measured. A computed pixel is written and read once more, 8 bytes
/// each.
const COMPUTED_PIXELS_RATIO: f32 = 8.0;

/// Cost model by which the path `auto` chooses. It also decides whether lit smoke is upsampled by a compute shader before it
/// is drawn: if the model is not the default, and [`fragment`](PathCosts::fragment) of `raster` is at least 8 times that of
/// `tiled`. Measure it with [`Context::measure_paths`](crate::Context::measure_paths), or set it with
/// [`Context::set_path_model`](crate::Context::set_path_model). To make one of your own, change the fields of
/// [`for_device_type`](Self::for_device_type).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PathModel {
    /// Costs of the path `raster`.
    pub raster: PathCosts,
    /// Costs of the path `tiled`.
    pub tiled: PathCosts,
    /// CPU cores that rasterize, each one square of 64 by 64 texels at a time; 1 or more. On a small target some of
    /// them are idle. 1 on GPUs, where it has no effect.
    pub cores: u32,
    /// Origin of the figures.
    pub source: PathModelSource,
}

/// Costs of one accumulation path, nanoseconds where nothing else is said, each 0 or more and finite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PathCosts {
    /// Per system.
    pub frame: f32,
    /// Per texel of the system's target.
    pub texel: f32,
    /// Per pixel of the image that the target covers, whose depth is reduced. 0 on CPUs, where both paths take as long.
    pub pixel: f32,
    /// Per sprite.
    pub sprite: f32,
    /// Per square of 32 by 32 texels that a sprite touches, summed over all sprites.
    pub entry: f32,
    /// Per layer of mean overdraw: the pass waits for the longest traversal, however few texels need it.
    pub layer: f32,
    /// Per texel that a flat sprite covers.
    pub fragment: f32,
    /// Per texel that a sprite of the technique `spherical_billboard` covers.
    pub sphere: f32,
    /// Per texel that a volumetric sprite covers, for each noise octave of each march step.
    pub march: f32,
    /// Of each texture that is blended behind the first, as a fraction of `fragment`.
    pub attachment: f32,
    /// Of each octave of grain, as a fraction of `fragment`.
    pub octave: f32,
    /// Width and height of the blocks that are shaded whole if a sprite covers any part of one, texels; 0 if only
    /// covered texels cost time.
    pub block: [u32; 2],
}

/// Origin of the figures of a [`PathModel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathModelSource {
    /// Defaults, measured on a GPU.
    Gpu,
    /// Defaults, measured on a CPU that renders (software adapter).
    Cpu,
    /// Measured on this device: [`Context::measure_paths`](crate::Context::measure_paths).
    Probe,
    /// Set by the host.
    Host,
}

impl PathModelSource {
    /// Returns a short description.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gpu => "GPU defaults",
            Self::Cpu => "CPU defaults",
            Self::Probe => "probe",
            Self::Host => "set by the host",
        }
    }
}

impl PathModel {
    /// Measured on an NVIDIA H200: `bench/results/h200_auto.json`; the traversal in `h200.json`; further textures and grain
    /// by the suite `sprites`; pixels, and the cost per frame of `tiled`, by the suite `frame` (`h100_frame.json`,
    /// `h200_frame.json`): `raster` draws depth_downsample, `tiled` computes it.
    const GPU: Self = Self {
        raster: PathCosts {
            frame: 10.0e3,
            texel: 0.06,
            pixel: 0.07,
            sprite: 0.0,
            entry: 0.0,
            layer: 0.0,
            fragment: 0.085,
            sphere: 0.16,
            march: 0.086,
            attachment: 1.0,
            octave: 0.35,
            block: [0; 2],
        },
        tiled: PathCosts {
            frame: 28.0e3,
            texel: 0.01,
            pixel: 0.008,
            sprite: 5.0,
            entry: 0.15,
            layer: 1200.0,
            fragment: 0.0033,
            sphere: 0.0035,
            march: 0.0032,
            attachment: 0.05,
            octave: 0.2,
            block: [0; 2],
        },
        cores: 1,
        source: PathModelSource::Gpu,
    };

    /// Measured on llvmpipe with two cores.
    const CPU: Self = Self {
        raster: PathCosts {
            frame: 0.6e6,
            texel: 13.0,
            pixel: 0.0,
            sprite: 3000.0,
            entry: 0.0,
            layer: 0.0,
            fragment: 10.0,
            sphere: 15.0,
            march: 11.0,
            attachment: 0.17,
            octave: 0.3,
            block: [4, 4],
        },
        tiled: PathCosts {
            frame: 0.92e6,
            texel: 34.0,
            pixel: 0.0,
            sprite: 400.0,
            entry: 1900.0,
            layer: 0.0,
            fragment: 7.4,
            sphere: 10.7,
            march: 12.7,
            attachment: 0.13,
            octave: 0.4,
            block: [8, 4],
        },
        cores: 2,
        source: PathModelSource::Cpu,
    };

    /// Returns the factors by which the probe exceeds this model, for `raster` and `tiled`, on the very device on which
    /// the class was measured. The scene hides part of the sprites in the class's measurement, which saves more time in
    /// `raster`, and none in the probe. The probe's few sprites stay in caches, so that a traversal waits less for
    /// each.
    fn probe_bias(&self) -> [f32; 2] {
        if self.source == PathModelSource::Cpu { [1.24, 0.74] } else { [1.75, 0.35] }
    }

    /// Scales this class's model to a device. `times`: the probe's time divided by this model's expectation, for
    /// `raster` and `tiled`.
    pub(crate) fn scaled_by_probe(self, times: [f32; 2]) -> Self {
        let bias = self.probe_bias();
        let [raster, tiled] = [times[0] / bias[0], times[1] / bias[1]];
        let tolerance = if self.source == PathModelSource::Cpu { CPU_PROBE_TOLERANCE } else { 1.0 };
        let apart = tiled / raster;
        let both = (raster * tiled).sqrt();
        let apart = (apart / apart.clamp(tolerance.recip(), tolerance)).sqrt();
        Self {
            raster: self.raster.scaled(both / apart),
            tiled: self.tiled.scaled(both * apart),
            source: PathModelSource::Probe,
            ..self
        }
    }

    /// Returns the default model of a device type.
    pub fn for_device_type(device_type: wgpu::DeviceType) -> Self {
        if device_type != wgpu::DeviceType::Cpu {
            return Self::GPU;
        }
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u32);
        Self { cores, ..Self::CPU }
    }

    /// Returns true if the device computes so much faster than it draws that pixels which are computed, stored and drawn
    /// take less time than pixels which are shaded as they are drawn. Server GPUs draw with a few of their processors only.
    /// The defaults are a server GPU's, so they tell nothing of others.
    pub(crate) fn computes_pixels(&self) -> bool {
        self.source != PathModelSource::Gpu && self.raster.fragment >= COMPUTED_PIXELS_RATIO * self.tiled.fragment
    }

    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        if self.cores == 0 {
            return Err(FieldError::new("cores", self.cores, "1 or more"));
        }
        for (path, costs) in [("raster", self.raster), ("tiled", self.tiled)] {
            let PathCosts {
                frame,
                texel,
                pixel,
                sprite,
                entry,
                layer,
                fragment,
                sphere,
                march,
                attachment,
                octave,
                block: _,
            } = costs;
            let named = [
                ("frame", frame),
                ("texel", texel),
                ("pixel", pixel),
                ("sprite", sprite),
                ("entry", entry),
                ("layer", layer),
                ("fragment", fragment),
                ("sphere", sphere),
                ("march", march),
                ("attachment", attachment),
                ("octave", octave),
            ];
            if let Some((name, value)) = named.into_iter().find(|(_, cost)| !(0.0..f32::INFINITY).contains(cost)) {
                return Err(FieldError::new(format!("{path}.{name}"), value, "0 or more"));
            }
        }
        Ok(())
    }

    /// Returns the expected milliseconds of `raster` and of `tiled`.
    pub fn milliseconds(&self, workload: &PathWorkload) -> [f32; 2] {
        let fraction = workload.visited_fraction();
        [(&self.raster, workload.busiest_core_fraction(self.cores)), (&self.tiled, fraction)]
            .map(|(costs, fraction)| costs.milliseconds(workload, fraction))
    }
}

impl PathCosts {
    /// Returns the expected milliseconds. `fraction`: fraction of the sprites' texels that are shaded; above 1 if the pass
    /// waits for the busiest core.
    pub(crate) fn milliseconds(&self, workload: &PathWorkload, fraction: f64) -> f32 {
        let of_fragment = match workload.technique {
            Technique::SphericalBillboard => f64::from(self.sphere),
            technique if technique.is_volumetric() => f64::from(self.march) * workload.lookups,
            _ => f64::from(self.fragment),
        };
        let attachments = f64::from(workload.attachments);
        let octaves = f64::from(workload.grain_octaves);
        let more = f64::from(self.attachment) * (attachments - 1.0).max(0.0) + f64::from(self.octave) * octaves;
        let of_fragment = of_fragment + f64::from(self.fragment) * more;
        let nanoseconds = f64::from(self.frame)
            + f64::from(self.texel) * workload.texels()
            + f64::from(self.pixel) * workload.texels() * f64::from(workload.scale * workload.scale)
            + f64::from(self.sprite) * workload.sprites
            + f64::from(self.layer) * workload.layers()
            + (f64::from(self.entry) * workload.entries() + of_fragment * workload.texels_shaded(self.block))
                * fraction;
        (nanoseconds * 1.0e-6) as f32
    }

    /// Returns all costs multiplied by a factor.
    pub(crate) fn scaled(self, factor: f32) -> Self {
        Self {
            frame: self.frame * factor,
            texel: self.texel * factor,
            pixel: self.pixel * factor,
            sprite: self.sprite * factor,
            entry: self.entry * factor,
            layer: self.layer * factor,
            fragment: self.fragment * factor,
            sphere: self.sphere * factor,
            march: self.march * factor,
            attachment: self.attachment,
            octave: self.octave,
            block: self.block,
        }
    }
}

impl PathWorkload {
    /// Returns the mean overdraw, layers per texel.
    pub fn layers(&self) -> f64 {
        self.fragments / self.texels().max(1.0)
    }

    /// Returns the number of texels of the target.
    pub fn texels(&self) -> f64 {
        self.size.as_dvec2().element_product()
    }

    /// Returns the work of the core with the largest square, relative to an even fraction: 1 if there are enough squares
    /// for all cores.
    fn busiest_core_fraction(&self, cores: u32) -> f64 {
        let largest = self.size.min(UVec2::splat(RASTER_SQUARE)).as_dvec2().element_product();
        (f64::from(cores) * largest / self.texels().max(1.0)).max(1.0)
    }

    /// Returns the number of squares of 32 by 32 texels that sprites touch, summed over all sprites.
    fn entries(&self) -> f64 {
        self.sprites * self.rectangles_touched(BIN, BIN)
    }

    /// Returns the mean number of rectangles of `width` by `height` texels that a sprite touches.
    pub(crate) fn rectangles_touched(&self, width: f64, height: f64) -> f64 {
        let side = self.mean_sprite_side();
        ((side / width + 1.0) * (side / height + 1.0)).min((self.texels() / (width * height)).max(1.0))
    }

    /// Returns the side of a mean sprite's screen box, texels; the factor 1.2 accounts for rotated squares.
    fn mean_sprite_side(&self) -> f64 {
        1.2 * (self.fragments / self.sprites.max(1.0)).sqrt()
    }

    /// Returns the number of texels that are shaded in blocks of these sides.
    fn texels_shaded(&self, [width, height]: [u32; 2]) -> f64 {
        let side = self.mean_sprite_side().max(1.0);
        self.fragments * (1.0 + f64::from(width) / side) * (1.0 + f64::from(height) / side)
    }

    /// Returns the mean fraction of the sprites that a traversal visits before it stops. Assumes that overdraw is
    /// distributed exponentially over the texels: most layers lie in few texels.
    fn visited_fraction(&self) -> f64 {
        let layers_seen = STOP_OPTICAL_DEPTH / self.optical_depth.max(1.0e-6);
        1.0 - (1.0 - NEVER_OPAQUE_FRACTION) * (-layers_seen / self.layers().max(1.0e-6)).exp()
    }
}

#[cfg(test)]
mod tests;
