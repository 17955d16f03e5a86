//! Header of an OpenEXR file: its color space, and why it cannot be read. The decoder tells neither.
//!
//! Source: OpenEXR File Layout; "An ID for Color Interop" of the ASWF Color Interop Forum.

use std::collections::BTreeSet;

use glam::DMat3;
use haze_core::assets::image::primaries::{
    ACES_WHITE, BT2020, D65, DISPLAY_P3, Primaries, SRGB, is_srgb, srgb_from_linear_of,
};
use haze_core::error::one_line;

use super::name_list::listed;

/// First bytes of a file.
pub const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Names of the compressions that the decoder does not have, by their code.
const UNREAD_COMPRESSIONS: [(u8, &str); 3] = [(10, "HTJ2K"), (11, "HTJ2K"), (13, "ZSTD")];
/// Highest code of a compression that the decoder has: DWAB.
const LAST_COMPRESSION: u8 = 9;
/// Flag of the version field: several parts, each with a header.
const MULTIPART: u32 = 0x1000;

/// Linear color spaces by their interop ID, without `_scene` or `_display`.
const LINEAR_SPACES: [(&str, Primaries); 6] = [
    ("lin_rec709", SRGB),
    ("lin_ap1", [ACES_WHITE, [0.713, 0.293], [0.165, 0.83], [0.128, 0.044]]),
    ("lin_ap0", [ACES_WHITE, [0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]]),
    ("lin_rec2020", BT2020),
    ("lin_p3d65", DISPLAY_P3),
    ("lin_adobergb", [D65, [0.64, 0.33], [0.21, 0.71], [0.15, 0.06]]),
];

/// Checks that a file can be decoded. Returns the matrix from its colors to linear Rec.709; `None` if they are that.
///
/// # Errors
/// The reason, and the file that would be right.
pub fn check(bytes: &[u8]) -> Result<Option<DMat3>, String> {
    let parts = parts(bytes).ok_or("its header is damaged; expected a whole OpenEXR image")?;
    let has_color = |part: &&Part| !part.is_deep && ["R", "G", "B"].iter().all(|name| part.channel(name).is_some());
    let Some(part) = parts.iter().find(has_color) else { return Err(reason_without_color(&parts)) };
    if parts.iter().any(|part| part.compression > LAST_COMPRESSION) {
        let code = parts.iter().map(|part| part.compression).max().unwrap_or_default();
        let name = UNREAD_COMPRESSIONS.iter().find(|(known, _)| *known == code).map(|(_, name)| (*name).to_owned());
        let name = name.unwrap_or_else(|| format!("method {code}"));
        return Err(format!("compressed by {name}, which haze does not read; expected ZIP, PIZ, DWAA or none"));
    }
    if ["R", "G", "B"].iter().any(|name| part.channel(name).is_some_and(|channel| channel.is_subsampled)) {
        return Err("its color has fewer texels than the image; expected R, G and B at each texel".into());
    }
    part.conversion()
}

/// Header of a part.
#[derive(Default)]
struct Part {
    channels: Vec<Channel>,
    compression: u8,
    is_deep: bool,
    /// xy of red, green, blue and white.
    chromaticities: Option<[[f64; 2]; 4]>,
    interop_id: Option<String>,
}

struct Channel {
    name: String,
    is_subsampled: bool,
}

impl Part {
    fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    fn conversion(&self) -> Result<Option<DMat3>, String> {
        let id = self.interop_id.as_deref().filter(|id| !["", "unknown", "data"].contains(id));
        let space = id.map(|id| id.strip_suffix("_scene").or_else(|| id.strip_suffix("_display")).unwrap_or(id));
        let known = LINEAR_SPACES.iter().find(|(name, _)| Some(*name) == space);
        let of_file = self.chromaticities.map(|[red, green, blue, white]| [white, red, green, blue]);
        let primaries = match (known, id) {
            (Some((_, primaries)), _) => *primaries,
            // An encoding, or a name of a studio's own without its primaries.
            (None, Some(id)) if of_file.is_none() || id.ends_with("_scene") || id.ends_with("_display") => {
                let names: Vec<_> = LINEAR_SPACES.iter().map(|(name, _)| format!("{name}_scene")).collect();
                return Err(format!("its colors are {}; expected one of {}", one_line(id), names.join(", ")));
            }
            (None, _) => match of_file {
                Some(primaries) => primaries,
                None => return Ok(None),
            },
        };
        if is_srgb(&primaries) {
            return Ok(None);
        }
        let refused = || "its chromaticities span no colors; expected those of Rec.709 or another space".to_owned();
        srgb_from_linear_of(primaries).map(Some).ok_or_else(refused)
    }
}

/// Reason why no part has color.
fn reason_without_color(parts: &[Part]) -> String {
    if parts.iter().all(|part| part.is_deep) {
        return "its data is deep; expected a flat image with the channels R, G, B".into();
    }
    let channels = || parts.iter().flat_map(|part| &part.channels);
    let layers: BTreeSet<_> = channels().filter_map(|channel| Some(channel.name.rsplit_once('.')?.0)).collect();
    if !layers.is_empty() {
        let cure = "one image with the channels R, G, B: from Blender as OpenEXR, not OpenEXR MultiLayer";
        return format!("its color lies in the layers {}; expected {cure}", listed(&layers));
    }
    let names: BTreeSet<_> = channels().map(|channel| channel.name.as_str()).collect();
    if names.is_empty() {
        return "it has no channels; expected R, G, B: export it as RGB".into();
    }
    let kind = match (names.contains("Y"), names.contains("RY")) {
        (true, true) => " (luminance and chroma)",
        (true, false) => " (luminance alone)",
        _ => "",
    };
    format!("its channels are {}{kind}; expected R, G, B: export it as RGB", listed(&names))
}

/// Headers of all parts; `None` if they are damaged.
fn parts(bytes: &[u8]) -> Option<Vec<Part>> {
    let mut rest = bytes.strip_prefix(&MAGIC)?;
    let version = u32::from_le_bytes(take(&mut rest, 4)?.try_into().ok()?);
    let mut parts = Vec::new();
    // Headers of a file with several parts end with an empty one.
    while parts.is_empty() || version & MULTIPART != 0 && rest.first()? != &0 {
        let mut part = Part::default();
        loop {
            let name = text(&mut rest)?;
            if name.is_empty() {
                break;
            }
            let kind = text(&mut rest)?;
            let length = u32::from_le_bytes(take(&mut rest, 4)?.try_into().ok()?);
            part.read(&name, &kind, take(&mut rest, usize::try_from(length).ok()?)?)?;
        }
        parts.push(part);
    }
    Some(parts)
}

impl Part {
    fn read(&mut self, name: &str, kind: &str, value: &[u8]) -> Option<()> {
        match (name, kind) {
            ("channels", "chlist") => self.channels = channels(value)?,
            ("compression", "compression") => self.compression = *value.first()?,
            ("type", "string") => self.is_deep = value.starts_with(b"deep"),
            ("colorInteropID", "string") => {
                self.interop_id = Some(String::from_utf8_lossy(value).into_owned());
            }
            ("chromaticities", "chromaticities") => {
                let numbers = value.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
                let numbers: Vec<_> = numbers.collect();
                self.chromaticities = numbers.as_chunks::<2>().0.try_into().ok();
            }
            _ => {}
        }
        Some(())
    }
}

fn channels(mut value: &[u8]) -> Option<Vec<Channel>> {
    let mut channels = Vec::new();
    loop {
        let name = text(&mut value)?;
        if name.is_empty() {
            return Some(channels);
        }
        // Type of its numbers, its perception, and its steps across and down.
        let numbers = take(&mut value, 16)?;
        let is_subsampled = numbers.get(8..16)? != [1, 0, 0, 0, 1, 0, 0, 0];
        channels.push(Channel { name, is_subsampled });
    }
}

fn take<'a>(rest: &mut &'a [u8], length: usize) -> Option<&'a [u8]> {
    let (taken, after) = rest.split_at_checked(length)?;
    *rest = after;
    Some(taken)
}

/// Text up to a zero byte.
fn text(rest: &mut &[u8]) -> Option<String> {
    let end = rest.iter().position(|byte| *byte == 0)?;
    let text = take(rest, end)?;
    take(rest, 1)?;
    Some(String::from_utf8_lossy(text).into_owned())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::load_sky;

    /// An image of one color, 8x4, without compression, with more attributes: name, type and value.
    fn exr(channels: &[(&str, f32)], compression: u8, more: &[(&str, &str, Vec<u8>)]) -> Vec<u8> {
        let mut list = Vec::new();
        for (name, _) in channels {
            list.extend(name.bytes().chain([0]));
            for number in [2_u32, 0, 1, 1] {
                list.extend(number.to_le_bytes());
            }
        }
        list.push(0);
        let window = [0_u32, 0, 7, 3].map(u32::to_le_bytes).concat();
        let one = 1.0_f32.to_le_bytes().to_vec();
        let mut attributes = vec![
            ("channels", "chlist", list),
            ("compression", "compression", vec![compression]),
            ("dataWindow", "box2i", window.clone()),
            ("displayWindow", "box2i", window),
            ("lineOrder", "lineOrder", vec![0]),
            ("pixelAspectRatio", "float", one.clone()),
            ("screenWindowCenter", "v2f", vec![0; 8]),
            ("screenWindowWidth", "float", one),
        ];
        attributes.extend(more.iter().cloned());
        let mut file = [super::MAGIC, 2_u32.to_le_bytes()].concat();
        for (name, kind, value) in attributes {
            file.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
            file.extend((value.len() as u32).to_le_bytes());
            file.extend(value);
        }
        file.push(0);
        let line: Vec<u8> = channels.iter().flat_map(|(_, value)| value.to_le_bytes().repeat(8)).collect();
        let first = file.len() + 4 * 8;
        (0..4).for_each(|y| file.extend(((first + y * (8 + line.len())) as u64).to_le_bytes()));
        for y in 0..4_u32 {
            file.extend(y.to_le_bytes());
            file.extend((line.len() as u32).to_le_bytes());
            file.extend(&line);
        }
        file
    }

    /// Color of a panorama at its middle.
    fn color(bytes: &[u8]) -> Result<Vec3, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        std::fs::write(&path, bytes).unwrap();
        let sky = load_sky(&path).map_err(|error| error.to_string());
        sky.map(|sky| sky.sample(Vec3::NEG_Z)).map_err(|said| said.split_once("sky.exr: ").unwrap().1.to_owned())
    }

    const COLOR: [(&str, f32); 3] = [("B", 0.05), ("G", 0.1), ("R", 1.0)];

    fn chromaticities(numbers: [f32; 8]) -> (&'static str, &'static str, Vec<u8>) {
        ("chromaticities", "chromaticities", numbers.map(f32::to_le_bytes).concat())
    }

    fn interop(id: &str) -> (&'static str, &'static str, Vec<u8>) {
        ("colorInteropID", "string", id.into())
    }

    #[test]
    fn colors_of_other_spaces_become_rec_709() {
        let plain = Vec3::new(1.0, 0.1, 0.05);
        // Without the part below 0, which no light has.
        let of_ap1 = Vec3::new(1.639, 0.0, 0.021);
        let of_ap0 = Vec3::new(2.389, 0.0, 0.028);
        let ap1 = [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767];
        let ap0 = [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767];
        let rec709 = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
        for (more, expected) in [
            (vec![], plain),
            (vec![chromaticities(rec709)], plain),
            (vec![chromaticities(ap1)], of_ap1),
            (vec![chromaticities(ap0)], of_ap0),
            (vec![interop("lin_ap1_scene")], of_ap1),
            (vec![interop("lin_ap0_scene")], of_ap0),
            (vec![interop("lin_rec709_scene"), chromaticities(rec709)], plain),
            // The name tells more than the primaries, unless it tells nothing.
            (vec![interop("lin_ap1_scene"), chromaticities(rec709)], of_ap1),
            (vec![interop("unknown"), chromaticities(ap1)], of_ap1),
            (vec![interop("studio:plates"), chromaticities(ap1)], of_ap1),
        ] {
            let found = color(&exr(&COLOR, 0, &more)).unwrap();
            assert!(found.abs_diff_eq(expected, 2e-3), "{more:?}: {found}");
        }
        let encoded = color(&exr(&COLOR, 0, &[interop("srgb_rec709_scene")])).unwrap_err();
        assert!(
            encoded.starts_with("its colors are srgb_rec709_scene; expected one of lin_rec709_scene,"),
            "{encoded}"
        );
        assert!(color(&exr(&COLOR, 0, &[interop("studio:plates")])).unwrap_err().starts_with("its colors are studio:"));
        let none = color(&exr(&COLOR, 0, &[chromaticities([0.3; 8])])).unwrap_err();
        assert!(none.starts_with("its chromaticities span no colors; expected"), "{none}");
    }

    #[test]
    fn refusals_name_what_the_file_has_and_the_cure() {
        let compressed = |code| color(&exr(&COLOR, code, &[])).unwrap_err();
        let cure = "which haze does not read; expected ZIP, PIZ, DWAA or none";
        assert_eq!(compressed(11), format!("compressed by HTJ2K, {cure}"));
        assert_eq!(compressed(13), format!("compressed by ZSTD, {cure}"));
        assert_eq!(compressed(77), format!("compressed by method 77, {cure}"));
        let of_channels = |names: &[&'static str]| {
            let channels: Vec<_> = names.iter().map(|name| (*name, 0.5)).collect();
            color(&exr(&channels, 0, &[])).unwrap_err()
        };
        let layers = ["V.Combined.B", "V.Combined.G", "V.Combined.R", "V.Depth.Z"];
        assert_eq!(
            of_channels(&layers),
            "its color lies in the layers V.Combined, V.Depth; expected one image with the channels R, G, B: from \
             Blender as OpenEXR, not OpenEXR MultiLayer"
        );
        assert_eq!(of_channels(&["Y"]), "its channels are Y (luminance alone); expected R, G, B: export it as RGB");
        assert_eq!(
            of_channels(&["BY", "RY", "Y"]),
            "its channels are BY, RY, Y (luminance and chroma); expected R, G, B: export it as RGB"
        );
        let whole = exr(&COLOR, 0, &[]);
        for length in [4, 8, 40, 200, whole.len() - 300, whole.len() - 1] {
            let said = color(&whole[..length]).unwrap_err();
            assert!(said.ends_with("; expected a whole OpenEXR image"), "{length}: {said}");
        }
    }
}
