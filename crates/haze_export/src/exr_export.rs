//! OpenEXR files of a shot: linear half floats, with the smoke's layers if it is alone.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, SmallVec, WritableImage as _,
};
use glam::{UVec2, Vec4, Vec4Swizzles};
use half::f16;
use haze_core::assets::image::Image;
use haze_core::error::{AssetError, Error};
use haze_demo::particle_scalar::ParticleScalar;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::display_transform;
use haze_preset::write_file;

use crate::backend::Backend;
use crate::frame_range::FrameNames;
use crate::image_export::{ExportProgress, Frames, USUAL_RATE, burns};
use crate::image_format::{Background, straight};
use crate::smoke_layers::SmokeLayers;

/// Choices of an OpenEXR file.
#[derive(Clone, Copy, Debug)]
pub struct ExrOptions {
    /// Background of the smoke.
    pub background: Background,
    /// Time to the next frame, of `motion`.
    pub seconds: f32,
    /// True if it has the light of fire alone.
    pub has_fire: bool,
}

impl ExrOptions {
    /// Of a single image.
    pub fn of_image(shot: &Shot, background: Background) -> Self {
        Self { background, seconds: 1.0 / USUAL_RATE, has_fire: burns(&shot.at_its_time().preset) }
    }

    /// Of all frames of a sequence, so that their files have the same channels.
    fn of_sequence(shot: &Shot, frames: &Frames) -> Self {
        let Frames { format, rate, .. } = frames;
        let background = format.resolved(shot).background;
        Self { background, seconds: 1.0 / rate, has_fire: frames.burns(shot, frames.count()) }
    }
}

/// Renders a shot and writes it. With the scene: `R`, `G` and `B`. Alone: premultiplied, with `A`, and the layers of the
/// smoke, below.
///
/// | channels | content |
/// |---|---|
/// | `amount.Y` | accumulated amount |
/// | `normal.X`, `.Y`, `.Z` | mean normal in view space |
/// | `depth.Z` | mean view depth, metres |
/// | `motion.X`, `.Y`, `.Z` | mean way until the next frame, pixels: right, up; 0 |
/// | `emission.R`, `.G`, `.B` | light of fire alone, premultiplied; if a system burns, in one of the frames of a sequence |
pub async fn write(backend: &Backend, shot: &Shot, options: ExrOptions, path: &Path) -> Result<(), Error> {
    let channels = channels(backend, shot, options).await?;
    Ok(write_file(path, &encode(shot.size, channels, path)?)?)
}

/// Writes every frame to its own file. If it is stopped, the files written so far stay.
pub async fn write_sequence(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    names: &FrameNames,
    progress: &ExportProgress<'_>,
) -> Result<(), Error> {
    let options = ExrOptions::of_sequence(shot, frames);
    for (done, frame) in (0..).zip(frames.range.clone()) {
        if !progress.goes_on(done, frames.count()) {
            return Err(frames.stopped_sequence(names, done));
        }
        let shot = frames.shot(shot, frame);
        let path = names.of(frame);
        let written = write(backend, &shot, options, &path);
        progress.show(format!("haze: {}", path.display()), written).await?;
    }
    Ok(())
}

/// Renders the channels of a shot.
async fn channels(backend: &Backend, shot: &Shot, options: ExrOptions) -> Result<Vec<Channel>, Error> {
    let ExrOptions { background, seconds, has_fire } = options;
    let is_transparent = background.is_transparent(shot);
    let shot = &*shot.at_its_time();
    let exposure = display_transform(shot).exposure;
    let lit = |texel: Vec4| (texel.xyz() * if exposure > 0.0 { exposure } else { 1.0 }).extend(texel.w);
    let mut channels = Vec::new();
    if !is_transparent {
        add(&mut channels, &["R", "G", "B"], &backend.render_async(shot).await?, lit);
        return Ok(channels);
    }
    let layers = SmokeLayers::new(backend, shot).await?;
    add(&mut channels, &["R", "G", "B", "A"], &layers.light, lit);
    add(&mut channels, &["amount.Y"], &layers.amount().await?, |texel| texel);
    let normals = straight(&layers.normals().await?);
    add(&mut channels, &["normal.X", "normal.Y", "normal.Z"], &normals, |texel| texel);
    let scalars = [
        ("depth.Z", ParticleScalar::ViewDepth),
        ("motion.X", ParticleScalar::MotionRight(seconds)),
        ("motion.Y", ParticleScalar::MotionUp(seconds)),
    ];
    for (name, scalar) in scalars {
        add(&mut channels, &[name], &layers.scalar(scalar).await?, Vec4::splat);
    }
    // Blender reads a pass of two channels as 0.
    add(&mut channels, &["motion.Z"], &Image::new(shot.size, 0.0), Vec4::splat);
    if has_fire {
        add(&mut channels, &["emission.R", "emission.G", "emission.B"], &layers.fire().await?, lit);
    }
    Ok(channels)
}

/// Channel of half floats.
type Channel = AnyChannel<FlatSamples>;

/// Encodes channels as an OpenEXR file. `path` is only named in errors.
fn encode(size: UVec2, channels: Vec<Channel>, path: &Path) -> Result<Vec<u8>, Error> {
    let size = (size.x as usize, size.y as usize);
    let attributes = LayerAttributes::default();
    let layer =
        Layer::new(size, attributes, Encoding::SMALL_FAST_LOSSLESS, AnyChannels::sort(SmallVec::from_vec(channels)));
    let mut bytes = Vec::new();
    let written = exr::prelude::Image::from_layer(layer).write().to_buffered(Cursor::new(&mut bytes));
    written.map_err(|error| {
        Error::from(AssetError::Image {
            path: path.into(),
            reason: format!("{error}; expected an image that OpenEXR can hold"),
        })
    })?;
    Ok(bytes)
}

/// Adds channels with these names, of the first components of an image.
fn add<T: Copy>(channels: &mut Vec<Channel>, names: &[&str], image: &Image<T>, change: impl Fn(T) -> Vec4) {
    for (component, name) in names.iter().enumerate() {
        let samples = image.texels.iter().map(|texel| half_float(change(*texel)[component])).collect();
        channels.push(AnyChannel::new(*name, FlatSamples::F16(samples)));
    }
}

/// Returns the nearest half float that is finite: a compositor spreads an infinity over all that it filters.
fn half_float(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels as _, ReadLayers as _};
    use glam::UVec2;
    use haze_preset::{Ease, KeyValue, Keyframe, Preset, Track};

    use super::*;
    use crate::image_format::ImageFormat;

    #[test]
    fn light_beyond_half_floats_is_their_largest() {
        assert_eq!(half_float(1.0e9), f16::MAX);
        assert_eq!(half_float(-1.0e9), f16::MIN);
        assert_eq!(half_float(0.25), f16::from_f32(0.25));
    }

    /// Reads the channels of the smoke of a preset, by name.
    fn written(preset: &str) -> Vec<(String, Vec<f32>)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("smoke.exr");
        let shot = Shot::load(preset, UVec2::new(48, 48)).unwrap();
        let options = ExrOptions { seconds: 1.0 / 24.0, ..ExrOptions::of_image(&shot, Background::Transparent) };
        pollster::block_on(write(&Backend::Cpu, &shot, options, &path)).unwrap();
        read(&path)
    }

    /// Channels of a file, by name.
    fn read(path: &Path) -> Vec<(String, Vec<f32>)> {
        let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = read.all_attributes().from_file(path).unwrap();
        let channels = image.layer_data.channel_data.list;
        channels
            .iter()
            .map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect()))
            .collect()
    }

    #[test]
    fn layers_are_read_back() {
        let channels = written("column");
        let names: Vec<_> = channels.iter().map(|(name, _)| name.as_str()).collect();
        let expected = ["A", "B", "G", "R", "amount.Y", "depth.Z", "motion.X", "motion.Y", "motion.Z"];
        assert_eq!(names, [&expected[..], &["normal.X", "normal.Y", "normal.Z"]].concat());
        let values = |wanted: &str| &channels.iter().find(|(name, _)| name == wanted).unwrap().1;
        let alpha = values("A");
        let normal_z = values("normal.Z");
        let depth = values("depth.Z");
        assert!(alpha.iter().any(|a| *a > 0.9) && alpha.contains(&0.0));
        // Clear pixels have no normal and no depth, and most of the smoke faces the viewer.
        assert!(alpha.iter().zip(normal_z).all(|(a, z)| *a > 0.0 || *z == 0.0));
        assert!(normal_z.iter().sum::<f32>() > 0.0);
        let camera = Shot::load("column", UVec2::ONE).unwrap().preset.camera;
        let away = (camera.target - camera.position).length();
        for (a, depth) in alpha.iter().zip(depth) {
            assert!(if *a > 0.01 { (away * 0.5..away * 2.0).contains(depth) } else { *a > 0.0 || *depth == 0.0 });
        }
        assert!(values("motion.Z").iter().all(|way| *way == 0.0));
        // The smoke rises.
        let mean_rise =
            values("motion.Y").iter().sum::<f32>() / depth.iter().filter(|depth| **depth > 0.0).count() as f32;
        assert!(mean_rise > 0.05, "{mean_rise}");
    }

    #[test]
    fn all_files_of_a_sequence_have_the_same_channels() {
        let mut preset = Preset::load("campfire").unwrap();
        preset.systems.truncate(1);
        let key = |time, value| Keyframe { time, value, ease: Ease::Hold };
        let track = |setting: &str, keys| Track { setting: setting.into(), keys, ..Track::default() };
        let number = |time, number| key(time, KeyValue::Number(number));
        let scene = |time, name: &str| key(time, KeyValue::Choice(name.into()));
        let start = preset.time as f32;
        preset.animation = vec![
            track("systems[0].settings.fire.intensity", vec![number(start, 0.0), number(start + 0.5, 1.0)]),
            track("environment.scene", vec![scene(start, "empty"), scene(start + 0.5, "yard")]),
        ];
        let shot = Shot::new(preset, Path::new("campfire"), UVec2::splat(16)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let channels = |background| {
            let format = ImageFormat { background, ..ImageFormat::default() };
            let frames = Frames { range: 0..=1, rate: 1.0, format };
            let names = FrameNames::parse(&folder.path().join("f_%d.exr")).unwrap();
            let progress = ExportProgress::Callback(&|_, _| true);
            pollster::block_on(write_sequence(&Backend::Cpu, &shot, &frames, &names, &progress)).unwrap();
            [0, 1].map(|frame| read(&names.of(frame)).into_iter().map(|(name, _)| name).collect::<Vec<_>>())
        };
        let [out, lit] = channels(Background::Transparent);
        assert!(out == lit && lit.contains(&"emission.R".into()), "{out:?} {lit:?}");
        let [empty, yard] = channels(Background::Auto);
        assert!(empty == yard && yard == ["B", "G", "R"], "{empty:?} {yard:?}");
    }

    #[test]
    fn fire_is_a_part_of_the_light() {
        let channels = written("campfire");
        let values = |wanted: &str| &channels.iter().find(|(name, _)| name == wanted).unwrap().1;
        let fire = values("emission.R");
        let all = values("R");
        assert!(fire.iter().any(|fire| *fire > 1.0));
        // Half floats have steps of a thousandth.
        assert!(fire.iter().zip(all).all(|(fire, all)| *fire <= all * 1.002 + 1.0e-3));
        assert!(fire.iter().sum::<f32>() < 0.99 * all.iter().sum::<f32>());
    }
}
