//! Image metrics: PSNR of two images as displayed.

use glam::{IVec2, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::tonemap::DisplayTransform;

use super::texture_readback::TextureReadback;

/// Peak signal-to-noise ratio of two images in sRGB code, dB. Infinite if the images are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PsnrReport {
    /// PSNR over all pixels.
    pub psnr: f32,
    /// PSNR over the pixels near discontinuities of the scene's depth, where upsampling of a reduced target is most
    /// difficult. `None` if there are no discontinuities or the depth is unknown.
    pub edge_psnr: Option<f32>,
}

/// Minimum jump of an edge, relative to the smaller depth.
const MIN_EDGE_JUMP: f32 = 0.1;
/// Distance from an edge up to which pixels count, pixels.
const EDGE_RADIUS: i32 = 2;

impl PsnrReport {
    /// Compares two linear HDR images of equal size, by the transform of each. `depth` is the scene's view depth, metres.
    pub fn compare(images: [&Image<Vec4>; 2], transforms: [DisplayTransform; 2], depth: Option<&Image<f32>>) -> Self {
        let [first, second] = images;
        let code = |image: &Image<Vec4>, at: IVec2, transform: DisplayTransform| {
            transform.code(image.load(at).xyz()).saturate()
        };
        let mut errors = Image::new(first.size, (0.0, false));
        errors.for_each(|at, error| {
            let at = at.as_ivec2();
            let difference = code(first, at, transforms[0]) - code(second, at, transforms[1]);
            *error = (difference.length_squared() / 3.0, depth.is_some_and(|depth| is_near_edge(depth, at)));
        });
        let psnr = |errors: &mut dyn Iterator<Item = f32>| {
            let (count, sum) = errors.fold((0_u32, 0.0), |(count, sum), error| (count + 1, sum + f64::from(error)));
            (count > 0).then(|| (-10.0 * (sum / f64::from(count)).log10()) as f32)
        };
        let all = &errors.texels;
        Self {
            psnr: psnr(&mut all.iter().map(|error| error.0)).unwrap_or(f32::INFINITY),
            edge_psnr: psnr(&mut all.iter().filter(|error| error.1).map(|error| error.0)),
        }
    }
}

/// True if the depth jumps between two neighbours within [`EDGE_RADIUS`] pixels, horizontally or vertically.
fn is_near_edge(depth: &Image<f32>, at: IVec2) -> bool {
    let inside = |at: IVec2| at.clamp(IVec2::ZERO, depth.size.as_ivec2() - 1);
    let jumps = |a: IVec2, b: IVec2| {
        let a = depth.load(inside(a));
        let b = depth.load(inside(b));
        (a - b).abs() > MIN_EDGE_JUMP * a.min(b)
    };
    (-EDGE_RADIUS..EDGE_RADIUS).any(|step| {
        let x = at + IVec2::X * step;
        let y = at + IVec2::Y * step;
        jumps(x, x + IVec2::X) || jumps(y, y + IVec2::Y)
    })
}

/// Pending readback of two images for comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    readback: TextureReadback,
    transforms: [DisplayTransform; 2],
}

impl Comparison {
    /// Records copies of two `Rgba16Float` textures and of the scene's linear depth. `None` if the textures differ in
    /// size; the depth is ignored if its size differs.
    pub fn record(
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        images: [&wgpu::Texture; 2],
        transforms: [DisplayTransform; 2],
        depth: Option<&wgpu::Texture>,
    ) -> Option<Self> {
        let [first, second] = images;
        let depth = depth.filter(|depth| depth.size() == first.size());
        let textures: Vec<_> = images.into_iter().chain(depth).collect();
        let have_same_size = first.size() == second.size();
        have_same_size.then(|| Self { readback: TextureReadback::record(device, encoder, &textures), transforms })
    }

    /// True once the readback has finished or failed.
    pub fn is_finished(&self) -> bool {
        self.readback.is_finished()
    }

    /// Compares the images. Returns `None` if the readback has not finished or has failed, and on every call after the
    /// first. Slow for large images.
    pub fn read(&self) -> Option<PsnrReport> {
        let bytes = self.readback.take()?;
        let [first, second, depth @ ..] = self.readback.regions.as_slice() else { return None };
        let size = first.size();
        let depth = depth.first().map(|region| region.depths(&bytes, size));
        let images = [first, second].map(|region| region.colors(&bytes, 0, size));
        Some(PsnrReport::compare(images.each_ref(), self.transforms, depth.as_ref()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn psnr_matches_its_definition() {
        let size = UVec2::new(20, 10);
        let black = Image::new(size, Vec4::W);
        let mut gray = Image::new(size, Vec4::splat(0.1));
        // In data, an error of 0.1 is 20 dB.
        fn report(a: &Image<Vec4>, b: &Image<Vec4>, depth: Option<&Image<f32>>) -> PsnrReport {
            PsnrReport::compare([a, b], [DisplayTransform::DATA; 2], depth)
        }
        assert!((report(&black, &gray, None).psnr - 20.0).abs() < 1e-3);
        assert_eq!(report(&gray, &gray, None), PsnrReport { psnr: f32::INFINITY, edge_psnr: None });
        // Errors only near the edge.
        let mut depth = Image::new(size, 5.0);
        depth.for_each(|at, depth| *depth = if at.x < 10 { 5.0 } else { 9.0 });
        gray.for_each(|at, gray| *gray = if (8..12).contains(&at.x) { Vec4::splat(0.1) } else { Vec4::W });
        let found = report(&black, &gray, Some(&depth));
        assert!((found.edge_psnr.unwrap() - 20.0).abs() < 1e-3, "{found:?}");
        assert!((found.psnr - 20.0 - 10.0 * 5.0_f32.log10()).abs() < 1e-3, "{found:?}");
        // Without an edge there is no edge PSNR.
        depth.texels.fill(5.0);
        assert_eq!(report(&black, &gray, Some(&depth)).edge_psnr, None);
    }
}
