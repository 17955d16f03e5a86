use std::io::Cursor;

use image::ImageFormat;

use super::super::decode_png;
use super::super::icc_profile::tests as profiles;
use super::*;

type Chunk = (&'static [u8; 4], Vec<u8>);

/// Encodes a PNG with extra chunks between its header and its pixels.
fn png(image: &DynamicImage, chunks: &[Chunk]) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
    // Signature and header have 33 bytes.
    let pixels = bytes.split_off(33);
    for (kind, data) in chunks {
        let checked = [&kind[..], data].concat();
        bytes.extend((data.len() as u32).to_be_bytes());
        bytes.extend(&checked);
        bytes.extend(crc(&checked).to_be_bytes());
    }
    [bytes, pixels].concat()
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1))))
}

/// Builds an iCCP chunk: the profile's name, and the profile as an uncompressed zlib stream.
fn iccp(profile: &[u8]) -> Chunk {
    let length = profile.len() as u16;
    let (a, b) = profile.iter().fold((1, 0), |(a, b), &byte| {
        let a = (a + u32::from(byte)) % 65521;
        (a, (a + b) % 65521)
    });
    let head = [&b"mine\0\0\x78\x01\x01"[..], &length.to_le_bytes(), &(!length).to_le_bytes()].concat();
    (b"iCCP", [&head, profile, &(b << 16 | a).to_be_bytes()].concat())
}

fn gama(gamma: u32) -> Chunk {
    (b"gAMA", gamma.to_be_bytes().to_vec())
}

fn cicp(code: [u8; 4]) -> Chunk {
    (b"cICP", code.to_vec())
}

fn chrm(primaries: Primaries) -> Chunk {
    let number = |x: &f64| ((x * 100_000.0).round() as u32).to_be_bytes();
    (b"cHRM", primaries.as_flattened().iter().flat_map(number).collect())
}

fn srgb() -> Chunk {
    (b"sRGB", vec![0])
}

const CODE: [u8; 3] = [180, 90, 40];

/// Decodes an image of color [`CODE`] with the given chunks and returns its sRGB code.
fn decoded(chunks: &[Chunk]) -> Result<[u8; 3], String> {
    let image = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(3, 1, image::Rgb(CODE)));
    let decoded = decode_color_png(Path::new("a.png"), &png(&image, chunks));
    decoded.map(|image| image.to_rgb8().get_pixel(1, 0).0).map_err(|error| error.to_string())
}

fn of_power(power: f32) -> [u8; 3] {
    CODE.map(|code| (srgb_from_linear((f32::from(code) / 255.0).powf(power)) * 255.0).round() as u8)
}

#[test]
fn every_color_tag_is_applied() {
    let refused =
        |found: &str| Err(format!("a.png: {found}; expected sRGB: convert the image to sRGB when exporting it"));
    for chunks in [vec![], vec![srgb()], vec![cicp([1, 13, 0, 1])], vec![gama(0)], vec![chrm(SRGB)]] {
        assert_eq!(decoded(&chunks), Ok(CODE), "{chunks:?}");
    }
    for chunks in [vec![gama(100_000)], vec![cicp([1, 8, 0, 1])]] {
        assert_eq!(decoded(&chunks), Ok(of_power(1.0)));
    }
    for chunks in [vec![gama(45_455)], vec![cicp([1, 4, 0, 1])], vec![gama(45_455), chrm(SRGB)]] {
        assert_eq!(decoded(&chunks), Ok(of_power(2.2)));
    }
    // Expected values follow from the matrices in CSS Color 4.
    for chunks in [vec![cicp([12, 13, 0, 1])], vec![chrm(DISPLAY_P3)]] {
        assert_eq!(decoded(&chunks), Ok([193, 83, 19]));
    }
    assert_eq!(decoded(&[cicp([9, 13, 0, 1])]), Ok([217, 69, 16]));
    for code in [[1, 16, 0, 1], [9, 18, 0, 1], [2, 13, 0, 1], [1, 13, 1, 1], [1, 13, 0, 0], [1, 1, 0, 1]] {
        let [a, b, c, d] = code;
        assert_eq!(decoded(&[cicp(code)]), refused(&format!("colors of the cICP code points {a}-{b}-{c}-{d}")));
    }
    let warm = [[0.3457, 0.3585], SRGB[1], SRGB[2], SRGB[3]];
    assert_eq!(decoded(&[chrm(warm)]), refused("colors with the white point 0.3457, 0.3585"));
    assert_eq!(decoded(&[chrm([D65; 4])]), refused("degenerate primaries"));
    let curve = profiles::table(256);
    assert_eq!(decoded(&[iccp(&profiles::profile(profiles::SRGB, &curve))]), Ok(CODE));
    for profile in [&profiles::profile(profiles::P3, &curve)[..], b"", b"no profile"] {
        assert_eq!(decoded(&[iccp(profile)]), refused("the color profile \"mine\""));
    }
}

#[test]
fn color_tags_take_precedence_as_in_the_png_specification() {
    let wide = || iccp(&profiles::profile(profiles::P3, &profiles::table(256)));
    let all = [gama(100_000), chrm(DISPLAY_P3), srgb(), wide(), cicp([1, 4, 0, 1])];
    assert_eq!(decoded(&all), Ok(of_power(2.2)), "cICP");
    assert!(decoded(&all[..4]).unwrap_err().contains("the color profile"), "iCCP");
    assert_eq!(decoded(&all[..3]), Ok(CODE), "sRGB");
    assert_ne!(decoded(&all[..2]), Ok(of_power(1.0)), "cHRM beside gAMA");
    assert_eq!(decoded(&all[..1]), Ok(of_power(1.0)), "gAMA");
    // Precedence does not depend on the order in the file; of two equal chunks the first applies.
    assert_eq!(decoded(&[cicp([1, 4, 0, 1]), srgb(), gama(100_000)]), Ok(of_power(2.2)));
    assert_eq!(decoded(&[gama(45_455), gama(100_000)]), Ok(of_power(2.2)));
    // Chunks of the wrong length are ignored.
    assert_eq!(decoded(&[(b"cICP", vec![1, 4, 0])]), Ok(CODE));
    assert_eq!(decoded(&[(b"gAMA", vec![0; 5])]), Ok(CODE));
}

#[test]
fn transparent_pixels_are_composited_over_black_in_linear_light() {
    let pixel = |alpha| Rgba([CODE[0], CODE[1], CODE[2], alpha]);
    let alphas = [255, 128, 0];
    let image = DynamicImage::ImageRgba8(ImageBuffer::from_fn(3, 1, |x, _| pixel(alphas[x as usize])));
    let decoded = decode_color_png(Path::new("a.png"), &png(&image, &[])).unwrap().to_rgb8();
    for (x, alpha) in alphas.into_iter().enumerate() {
        let fraction = f32::from(alpha) / 255.0;
        let expected = CODE
            .map(|code| (srgb_from_linear(linear_from_srgb(f32::from(code) / 255.0) * fraction) * 255.0).round() as u8);
        assert_eq!(decoded.get_pixel(x as u32, 0).0, expected);
    }
    // An opaque image with an alpha channel stays unchanged.
    let image = DynamicImage::ImageRgba8(ImageBuffer::from_pixel(3, 1, pixel(255)));
    assert_eq!(decode_color_png(Path::new("a.png"), &png(&image, &[])).unwrap(), image);
}

#[test]
fn every_kind_of_png_is_read_and_refused_if_truncated() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/corpus/png");
    let mut count = 0;
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        if !path.file_name().unwrap().to_str().unwrap().starts_with("good") {
            continue;
        }
        count += 1;
        let bytes = std::fs::read(&path).unwrap();
        let image = decode_color_png(&path, &bytes).unwrap();
        assert!(image.width() > 0);
        let end = bytes.windows(4).rposition(|kind| kind == b"IEND").unwrap() + 8;
        for length in 0..end {
            let error = decode_png(&path, &bytes[..length]).unwrap_err().to_string();
            assert!(error.contains("not a PNG file") || error.contains("the file ends too early"), "{length}: {error}");
        }
    }
    assert!(count >= 10, "{count}");
}

#[test]
fn oversized_files_are_refused_before_they_are_read() {
    let small = DynamicImage::new_rgb8(2, 2);
    let message = |bytes: &[u8]| decode_png(Path::new("a.png"), bytes).unwrap_err().to_string();
    let mut huge = png(&small, &[]);
    huge[16..20].copy_from_slice(&65535_u32.to_be_bytes());
    huge[20..24].copy_from_slice(&65535_u32.to_be_bytes());
    assert_eq!(message(&huge), "a.png: 65535x65535 pixels; expected at most 4096x4096");
    let mut text = png(&small, &[(b"tEXt", b"a\0b".to_vec())]);
    text[33..37].copy_from_slice(&(1_u32 << 30).to_be_bytes());
    assert_eq!(message(&text), "a.png: the file ends too early; expected a whole PNG");
    text[33..37].copy_from_slice(&u32::MAX.to_be_bytes());
    assert_eq!(message(&text), "a.png: the file ends too early; expected a whole PNG");
    assert_eq!(message(b"GIF89a"), "a.png: not a PNG file; export it as PNG");

    let folder = tempfile::tempdir().unwrap();
    let error = |name: &str| read_color_png(&folder.path().join(name)).unwrap_err().to_string();
    std::fs::create_dir(folder.path().join("folder.png")).unwrap();
    assert!(error("folder.png").contains("a folder, not a file; expected a PNG file"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("gone/b.png", folder.path().join("link.png")).unwrap();
        assert!(
            error("link.png").ends_with("link.png: a link to gone/b.png, which is not there; expected a PNG file"),
            "{}",
            error("link.png")
        );
    }
    // A sparse file of 1 GiB.
    std::fs::File::create(folder.path().join("long.png")).unwrap().set_len(1 << 30).unwrap();
    assert!(error("long.png").contains("1073741824 bytes; expected a PNG file of at most 67108864 bytes"));
}
