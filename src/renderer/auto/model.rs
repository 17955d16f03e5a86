//! What either way to accumulate takes, from what there is to accumulate.

use glam::UVec2;

use super::load::PathLoad;
use crate::error::FieldError;
use crate::settings::Technique;

/// Texels along the side of what [`PathCosts::entry`] counts.
const BIN: f64 = 32.0;
/// Texels along the side of the squares that a CPU's cores rasterize, one at a time.
const SQUARE: u32 = 64;
/// Where a walk stops, as optical depth: `OPAQUE` in `shaders/tile_accumulate.wgsl`, and twice that, as texels that walk together
/// wait for the last of them.
const OPAQUE_DEPTH: f64 = 2.0 * 10.0 * std::f64::consts::LN_2;
/// Share of the walks that never stop: those round the borders of the smoke. With both an H200 is met within 5 % where sprites are
/// large.
const CLEAR_SHARE: f64 = 0.5;
/// Where a CPU draws, a path is believed to be dearer against the other than its class has it by as much as it looks more than so many
/// times dearer: what else runs on the machine slows the walk down 1.5 times more than `raster`, for seconds.
const CPU_DOUBT: f32 = 1.6;

/// What accumulating takes on a device, by which the path `auto` chooses. Set it with
/// [`Context::set_path_model`](crate::Context::set_path_model).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathModel {
    /// Of the path `raster`.
    pub raster: PathCosts,
    /// Of the path `tiled`.
    pub tiled: PathCosts,
    /// Cores that rasterize, square by square of 64 texels, 1 or more: on a small target some of them have nothing to do. 1 on GPUs,
    /// where it makes no difference.
    pub cores: u32,
    /// Where the figures are from.
    pub source: PathModelSource,
}

/// What one way to accumulate takes, nanoseconds, each 0 or more and finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathCosts {
    /// Each system.
    pub frame: f32,
    /// Each texel of its target.
    pub texel: f32,
    /// Each sprite.
    pub sprite: f32,
    /// Each square of 32 texels that a sprite touches, sprite by sprite.
    pub entry: f32,
    /// Each layer that lies over a texel, in the mean: the longest walk is waited for, however few there are.
    pub layer: f32,
    /// Each texel that a flat sprite covers.
    pub fragment: f32,
    /// The same of the technique `spherical_billboard`.
    pub sphere: f32,
    /// The same of volumetric ones, for each octave of each step.
    pub march: f32,
    /// Sides of the blocks that are drawn whole where a sprite covers some of one, texels; 0 where only what it covers takes time.
    pub block: [u32; 2],
}

/// Where the figures of a [`PathModel`] are from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathModelSource {
    /// What GPUs were measured at.
    Gpu,
    /// What CPUs that draw were measured at.
    Cpu,
    /// Measured on this device: [`Context::measure_paths`](crate::Context::measure_paths).
    Probe,
    /// The host's own.
    Host,
}

impl PathModelSource {
    /// In a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gpu => "as GPUs have it",
            Self::Cpu => "as CPUs have it",
            Self::Probe => "probe",
            Self::Host => "set by the host",
        }
    }
}

impl PathModel {
    /// An NVIDIA H200, `bench/results/h200_auto.json`; the walk in `h200.json`.
    const GPU: Self = Self {
        raster: PathCosts {
            frame: 10.0e3,
            texel: 0.06,
            sprite: 0.0,
            entry: 0.0,
            layer: 0.0,
            fragment: 0.085,
            sphere: 0.16,
            march: 0.086,
            block: [0; 2],
        },
        tiled: PathCosts {
            frame: 48.0e3,
            texel: 0.01,
            sprite: 5.0,
            entry: 0.15,
            layer: 1200.0,
            fragment: 0.0033,
            sphere: 0.0035,
            march: 0.0032,
            block: [0; 2],
        },
        cores: 1,
        source: PathModelSource::Gpu,
    };

    /// llvmpipe on two cores.
    const CPU: Self = Self {
        raster: PathCosts {
            frame: 0.6e6,
            texel: 13.0,
            sprite: 3000.0,
            entry: 0.0,
            layer: 0.0,
            fragment: 10.0,
            sphere: 15.0,
            march: 11.0,
            block: [4, 4],
        },
        tiled: PathCosts {
            frame: 0.92e6,
            texel: 34.0,
            sprite: 400.0,
            entry: 1900.0,
            layer: 0.0,
            fragment: 7.4,
            sphere: 10.7,
            march: 12.7,
            block: [8, 4],
        },
        cores: 2,
        source: PathModelSource::Cpu,
    };

    /// By how much the probe finds more than this, by `raster` and by `tiled`, on the very device that the class was measured at:
    /// its sprites are hidden by nothing, and those of the class in part, which spares `raster` the more; and its few sprites stay in
    /// caches, so that a walk waits less for each.
    fn probe_finds(&self) -> [f32; 2] {
        if self.source == PathModelSource::Cpu { [1.24, 0.74] } else { [1.75, 0.35] }
    }

    /// Of a device of this class on which the probe took so many times as long as this has it, by `raster` and by `tiled`.
    pub(crate) fn probed(self, times: [f32; 2]) -> Self {
        let finds = self.probe_finds();
        let [raster, tiled] = [times[0] / finds[0], times[1] / finds[1]];
        let doubt = if self.source == PathModelSource::Cpu { CPU_DOUBT } else { 1.0 };
        let apart = tiled / raster;
        let (both, apart) = ((raster * tiled).sqrt(), (apart / apart.clamp(doubt.recip(), doubt)).sqrt());
        Self {
            raster: self.raster.times(both / apart),
            tiled: self.tiled.times(both * apart),
            source: PathModelSource::Probe,
            ..self
        }
    }

    /// What devices of this kind take.
    pub fn of_class(device_type: wgpu::DeviceType) -> Self {
        if device_type != wgpu::DeviceType::Cpu {
            return Self::GPU;
        }
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u32);
        Self { cores, ..Self::CPU }
    }

    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        if self.cores == 0 {
            return Err(FieldError::new("cores", self.cores, "1 or more"));
        }
        for (path, costs) in [("raster", self.raster), ("tiled", self.tiled)] {
            let PathCosts { frame, texel, sprite, entry, layer, fragment, sphere, march, block: _ } = costs;
            let named = [
                ("frame", frame),
                ("texel", texel),
                ("sprite", sprite),
                ("entry", entry),
                ("layer", layer),
                ("fragment", fragment),
                ("sphere", sphere),
                ("march", march),
            ];
            if let Some((name, value)) = named.into_iter().find(|(_, cost)| !(0.0..f32::INFINITY).contains(cost)) {
                return Err(FieldError::new(format!("{path}.{name}"), value, "nanoseconds, 0 or more"));
            }
        }
        Ok(())
    }

    /// Milliseconds by `raster` and by `tiled`.
    pub fn milliseconds(&self, load: &PathLoad) -> [f32; 2] {
        let share = load.seen_share();
        [(&self.raster, load.busiest(self.cores)), (&self.tiled, share)]
            .map(|(costs, share)| costs.milliseconds(load, share))
    }
}

impl PathCosts {
    /// `share`: of the sprites' texels, those that are worked out; more than all where some are waited for.
    pub(crate) fn milliseconds(&self, load: &PathLoad, share: f64) -> f32 {
        let of_fragment = match load.technique {
            Technique::SphericalBillboard => f64::from(self.sphere),
            technique if technique.is_volumetric() => f64::from(self.march) * load.lookups,
            _ => f64::from(self.fragment),
        };
        let nanoseconds = f64::from(self.frame)
            + f64::from(self.texel) * load.texels()
            + f64::from(self.sprite) * load.sprites
            + f64::from(self.layer) * load.layers()
            + (f64::from(self.entry) * load.entries() + of_fragment * load.drawn(self.block)) * share;
        (nanoseconds * 1.0e-6) as f32
    }

    /// All of them so many times as large.
    pub(crate) fn times(self, factor: f32) -> Self {
        Self {
            frame: self.frame * factor,
            texel: self.texel * factor,
            sprite: self.sprite * factor,
            entry: self.entry * factor,
            layer: self.layer * factor,
            fragment: self.fragment * factor,
            sphere: self.sphere * factor,
            march: self.march * factor,
            block: self.block,
        }
    }
}

impl PathLoad {
    /// Layers over a texel, in the mean.
    pub fn layers(&self) -> f64 {
        self.fragments / self.texels().max(1.0)
    }

    /// Texels of the target.
    pub fn texels(&self) -> f64 {
        self.size.as_dvec2().element_product()
    }

    /// What the core that has the largest square does, against its share of all: 1 where there are squares enough.
    fn busiest(&self, cores: u32) -> f64 {
        let largest = self.size.min(UVec2::splat(SQUARE)).as_dvec2().element_product();
        (f64::from(cores) * largest / self.texels().max(1.0)).max(1.0)
    }

    /// Squares of 32 texels that sprites touch, sprite by sprite.
    fn entries(&self) -> f64 {
        self.sprites * self.touched(BIN, BIN)
    }

    /// Rectangles of so many texels that a sprite touches, in the mean.
    pub(crate) fn touched(&self, width: f64, height: f64) -> f64 {
        let side = self.side();
        ((side / width + 1.0) * (side / height + 1.0)).min((self.texels() / (width * height)).max(1.0))
    }

    /// Of a sprite, texels: that of a square that lies askew.
    fn side(&self) -> f64 {
        1.2 * (self.fragments / self.sprites.max(1.0)).sqrt()
    }

    /// Texels that are drawn, in blocks of these sides.
    fn drawn(&self, [width, height]: [u32; 2]) -> f64 {
        let side = self.side().max(1.0);
        self.fragments * (1.0 + f64::from(width) / side) * (1.0 + f64::from(height) / side)
    }

    /// How much of the sprites a walk sees before it stops, in the mean. Layers are taken to be spread as chance has it, most of them
    /// in few places.
    fn seen_share(&self) -> f64 {
        let layers_seen = OPAQUE_DEPTH / self.optical_depth.max(1.0e-6);
        1.0 - (1.0 - CLEAR_SHARE) * (-layers_seen / self.layers().max(1.0e-6)).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(layers: f64) -> PathLoad {
        let size = UVec2::new(1280, 720);
        PathLoad {
            technique: Technique::Soft,
            sprites: 1000.0,
            fragments: layers * size.as_dvec2().element_product(),
            size,
            optical_depth: 0.05,
            lookups: 0.0,
            is_assumed: false,
        }
    }

    #[test]
    fn layers_cost_what_is_seen_of_them() {
        let model = PathModel::of_class(wgpu::DeviceType::Cpu);
        let [raster, tiled] = model.milliseconds(&load(4.0));
        assert!(raster < tiled, "{raster} {tiled}");
        let [deep_raster, deep_tiled] = model.milliseconds(&load(4000.0));
        assert!(deep_raster > 500.0 * raster && deep_tiled < 500.0 * tiled, "{deep_raster} {deep_tiled}");
        // A walk that does not stop sees all of it.
        let [_, all] = model.milliseconds(&PathLoad { optical_depth: 0.0, ..load(4000.0) });
        assert!(all > 1.7 * deep_tiled);
    }

    #[test]
    fn a_probe_on_a_cpu_is_doubted() {
        let apart = |class: PathModel, walk: f32| {
            let [raster, tiled] = class.probe_finds();
            let probed = class.probed([3.0 * raster, 3.0 * walk * tiled]);
            let [raster, tiled] = [probed.raster.march / class.raster.march, probed.tiled.march / class.tiled.march];
            assert!((raster * tiled / (9.0 * walk) - 1.0).abs() < 1.0e-4, "{raster} {tiled}");
            tiled / raster
        };
        let alike = |a: f32, b: f32| (a / b - 1.0).abs() < 1.0e-4;
        assert!(alike(apart(PathModel::CPU, 1.5), 1.0) && alike(apart(PathModel::CPU, 0.7), 1.0));
        assert!(
            alike(apart(PathModel::CPU, 2.0 * CPU_DOUBT), 2.0) && alike(apart(PathModel::CPU, 0.5 / CPU_DOUBT), 0.5)
        );
        assert!(alike(apart(PathModel::GPU, 1.5), 1.5), "a GPU is alone");
    }

    #[test]
    fn cores_without_a_square_do_nothing() {
        let model = PathModel { cores: 2, ..PathModel::CPU };
        let raster = |width, height| {
            let size = UVec2::new(width, height);
            let fragments = 100.0 * size.as_dvec2().element_product();
            let [raster, _] = model.milliseconds(&PathLoad { size, fragments, sprites: 0.0, ..load(1.0) });
            f64::from(raster - 1.0e-6 * model.raster.frame) / size.as_dvec2().element_product()
        };
        let alike = |a: f64, b: f64| (a / b - 1.0).abs() < 0.05;
        assert!(alike(raster(64, 64), 2.0 * raster(128, 64)) && alike(raster(128, 64), raster(640, 640)));
        assert!(alike(raster(96, 64), raster(128, 64) * 4.0 / 3.0), "one of two has two thirds");
    }

    #[test]
    fn a_gpu_walks_where_there_is_something_to_walk() {
        let model = PathModel::of_class(wgpu::DeviceType::DiscreteGpu);
        let small = UVec2::splat(128);
        let size = load(1.0).size;
        for (size, layers, walks) in [(small, 0.2, false), (size, 16.0, true), (size, 64.0, true), (size, 1024.0, true)]
        {
            let fragments = layers * size.as_dvec2().element_product();
            let [raster, tiled] = model.milliseconds(&PathLoad { size, fragments, ..load(layers) });
            assert_eq!(tiled < raster, walks, "{layers}: {tiled} {raster}");
        }
    }
}
