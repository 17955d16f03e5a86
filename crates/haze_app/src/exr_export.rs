//! OpenEXR files of a shot: linear half floats, with the smoke's layers if it is alone.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, SmallVec, WritableImage as _,
};
use glam::{Vec3, Vec4, Vec4Swizzles};
use half::f16;
use haze::Error;
use haze::image::{Image, write_file};
use haze::settings::DebugView;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::exposure;

use crate::backend::Backend;
use crate::image_export::Background;
use crate::smoke_alone::{before_two_skies, separated};

/// Renders a shot and writes it. With the scene: `R`, `G` and `B`. Alone: premultiplied, with `A`, the accumulated amount
/// `amount.Y`, and the mean normal of the smoke in view space `normal.X`, `normal.Y` and `normal.Z`.
pub fn write(backend: &Backend, shot: &Shot, background: Background, path: &Path) -> Result<(), Error> {
    let shot = &*shot.at_its_time();
    let exposure = exposure(shot);
    let lit = |texel: Vec4| (texel.xyz() * if exposure > 0.0 { exposure } else { 1.0 }).extend(texel.w);
    let mut channels = Vec::new();
    match background {
        Background::Scene => {
            let picture = backend.render(shot)?;
            add(&mut channels, &["R", "G", "B"], &picture, lit);
        }
        Background::Transparent => {
            let [dark, bright] = before_two_skies(shot);
            let smoke = separated([&backend.render(&dark)?, &backend.render(&bright)?]);
            add(&mut channels, &["R", "G", "B", "A"], &smoke, lit);
            let view = |debug_view| backend.render(&Shot { debug_view, ..dark.clone() });
            let amount = view(DebugView::Amount)?;
            add(&mut channels, &["amount.Y"], &amount, |texel| texel);
            let mut normals = view(DebugView::Normals)?;
            // The view has n/2 + 1/2, and black where there is no smoke.
            normals.for_each(|at, texel| {
                let is_smoke = amount.load(at.as_ivec2()).x > 0.0;
                let normal = if is_smoke { texel.xyz() * 2.0 - 1.0 } else { Vec3::ZERO };
                *texel = normal.extend(0.0);
            });
            add(&mut channels, &["normal.X", "normal.Y", "normal.Z"], &normals, |texel| texel);
        }
    }
    let size = (shot.size.x as usize, shot.size.y as usize);
    let attributes = LayerAttributes::default();
    let layer =
        Layer::new(size, attributes, Encoding::SMALL_FAST_LOSSLESS, AnyChannels::sort(SmallVec::from_vec(channels)));
    let mut bytes = Vec::new();
    let written = exr::prelude::Image::from_layer(layer).write().to_buffered(Cursor::new(&mut bytes));
    written.map_err(|error| Error::Image {
        path: path.into(),
        reason: format!("{error}; expected an image that OpenEXR can hold"),
    })?;
    write_file(path, &bytes)
}

/// Adds channels with these names, of the first components of an image.
fn add(
    channels: &mut Vec<AnyChannel<FlatSamples>>,
    names: &[&str],
    image: &Image<Vec4>,
    change: impl Fn(Vec4) -> Vec4,
) {
    for (component, name) in names.iter().enumerate() {
        let samples = image.texels.iter().map(|texel| f16::from_f32(change(*texel)[component])).collect();
        channels.push(AnyChannel::new(*name, FlatSamples::F16(samples)));
    }
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels as _, ReadLayers as _};
    use glam::UVec2;

    use super::*;

    #[test]
    fn layers_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("smoke.exr");
        let shot = Shot::load("column", UVec2::new(48, 48)).unwrap();
        write(&Backend::Cpu, &shot, Background::Transparent, &path).unwrap();
        let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = read.all_attributes().from_file(&path).unwrap();
        let channels = &image.layer_data.channel_data.list;
        let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "amount.Y", "normal.X", "normal.Y", "normal.Z"]);
        let values = |index: usize| channels[index].sample_data.values_as_f32().collect::<Vec<_>>();
        let (alpha, normal_z) = (values(0), values(7));
        assert!(alpha.iter().any(|a| *a > 0.9) && alpha.contains(&0.0));
        // Clear pixels have no normal, and most of the smoke faces the viewer.
        assert!(alpha.iter().zip(&normal_z).all(|(a, z)| *a > 0.0 || *z == 0.0));
        assert!(normal_z.iter().sum::<f32>() > 0.0);
    }
}
