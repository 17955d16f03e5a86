use super::*;
use crate::formula::color::linear_from_srgb;

/// Builds a profile with the given primaries and curve.
pub fn profile(primaries: [[f32; 3]; 3], curve: &[u8]) -> Vec<u8> {
    let xyz = |color: [f32; 3]| {
        let numbers = color.map(|x| ((x * 65536.0) as i32).to_be_bytes());
        [&b"XYZ \0\0\0\0"[..], numbers.as_flattened()].concat()
    };
    let [red, green, blue] = primaries.map(xyz);
    let tags: [(&[u8], &[u8]); 6] =
        [(b"rXYZ", &red), (b"gXYZ", &green), (b"bXYZ", &blue), (b"rTRC", curve), (b"gTRC", curve), (b"bTRC", curve)];
    let mut table = (tags.len() as u32).to_be_bytes().to_vec();
    let mut data = Vec::new();
    for (name, bytes) in tags {
        let offset = 132 + 12 * tags.len() + data.len();
        table.extend([name, &(offset as u32).to_be_bytes(), &(bytes.len() as u32).to_be_bytes()].concat());
        data.extend(bytes);
    }
    let mut header = vec![0; 128];
    header[16..20].copy_from_slice(b"RGB ");
    [header, table, data].concat()
}

pub const SRGB: [[f32; 3]; 3] =
    [[0.436_07, 0.222_49, 0.013_92], [0.385_15, 0.716_87, 0.097_08], [0.143_07, 0.060_61, 0.7141]];
pub const P3: [[f32; 3]; 3] = [[0.515_1, 0.241_2, -0.001_1], [0.292, 0.692_2, 0.041_9], [0.157_1, 0.066_6, 0.784_1]];

/// Builds a table of sRGB's curve.
pub fn table(count: u32) -> Vec<u8> {
    let entry = |index: u32| (linear_from_srgb(index as f32 / (count - 1) as f32) * 65535.0).round() as u16;
    let head = [&b"curv\0\0\0\0"[..], &count.to_be_bytes()].concat();
    (0..count).map(entry).fold(head, |curve, entry| [curve, entry.to_be_bytes().to_vec()].concat())
}

#[test]
fn only_profiles_equivalent_to_srgb_are_accepted() {
    let formula = [2.4_f32, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045];
    let numbers = formula.map(|x| ((x * 65536.0).round() as i32).to_be_bytes());
    let formula = [&b"para\0\0\0\0\0\x03\0\0"[..], numbers.as_flattened()].concat();
    let exponent = b"curv\0\0\0\0\0\0\0\x01\x02\x33\0\0";
    let linear = b"curv\0\0\0\0\0\0\0\0";
    assert!(is_srgb(&profile(SRGB, &formula)) && is_srgb(&profile(SRGB, &table(1024))));
    assert!(!is_srgb(&profile(P3, &formula)), "other primaries");
    assert!(!is_srgb(&profile(SRGB, exponent)), "2.2");
    assert!(!is_srgb(&profile(SRGB, linear)), "linear");
    // A truncated or changed profile does not panic.
    let whole = profile(SRGB, &formula);
    for at in 0..whole.len() {
        assert!(!is_srgb(&whole[..at]));
        let mut changed = whole.clone();
        changed[at] = 0xff;
        is_srgb(&changed);
    }
}
