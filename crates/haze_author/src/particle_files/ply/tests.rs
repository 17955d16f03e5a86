//! Tests with PLY files as other programs write them, intact and damaged.

use glam::Vec3;

use super::*;

fn read(content: &[u8]) -> Result<ParticleFrame, ParseError> {
    super::read(content, 4).map(|read| read.frame)
}

const NAMES: &str = "property float x\nproperty double y\nproperty short z\nproperty uchar Alpha\nproperty int id\n\
                     property list uchar ushort near\nproperty float pscale\n";

/// Builds a file with a list element before the vertices, a list property in the vertices, and faces after them.
fn binary(is_big_endian: bool) -> Vec<u8> {
    let order = if is_big_endian { "big" } else { "little" };
    let mut file = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\ncomment made by h\u{fc}nd\r\nelement strip 2\r\n\
         property list int char i\r\nelement vertex 2\r\n{}element face 1\r\nproperty list uchar int vertex_indices\r\n\
         end_header\r\n",
        NAMES.replace('\n', "\r\n")
    )
    .into_bytes();
    let mut put = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        if is_big_endian {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    put(&3_i32.to_le_bytes());
    (0..3).for_each(|_| put(b"\n"));
    put(&0_i32.to_le_bytes());
    for (x, alpha, id, near) in [(1.5_f32, 255_u8, 9_i32, 2_u8), (-2.0, 51, -3, 0)] {
        put(&x.to_le_bytes());
        put(&0.25_f64.to_le_bytes());
        put(&(-7_i16).to_le_bytes());
        put(&[alpha]);
        put(&id.to_le_bytes());
        put(&[near]);
        (0..near).for_each(|_| put(&500_u16.to_le_bytes()));
        put(&0.75_f32.to_le_bytes());
    }
    put(&[3]);
    (0..3_i32).for_each(|index| put(&index.to_le_bytes()));
    file
}

fn ascii() -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\nobj_info from a simulation\nelement strip 2\nproperty list int char i\nelement vertex 2\n{NAMES}\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n3 10 10 10\n0\n\
         1.5 .25 -7 255 9 2 500 500 0.75\n\n-2 2.5e-1 -7 51 -3 0 0.75 \n3 0 1 2\n"
    )
    .into_bytes()
}

#[test]
fn the_three_formats_give_equal_particles_and_lists_are_skipped() {
    let frame = read(&ascii()).unwrap();
    let [first, second] = frame.particles() else { panic!("two particles") };
    assert_eq!((first.id, first.position), (-3, Vec3::new(-2.0, 0.25, -7.0)));
    assert_eq!((first.amount, second.amount), (0.2, 1.0));
    assert_eq!((first.radius, second.radius), (0.75, 0.75));
    assert!(frame.provided().id && frame.provided().amount && !frame.provided().rotation);
    assert_eq!(read(&binary(false)).unwrap(), frame);
    assert_eq!(read(&binary(true)).unwrap(), frame);
}

#[test]
fn a_truncated_file_is_refused_or_has_all_its_particles() {
    for file in [ascii(), binary(false), binary(true)] {
        let whole = read(&file).unwrap();
        for length in 0..file.len() {
            if let Ok(frame) = read(&file[..length]) {
                // Elements after the vertices are not read, so they may be missing.
                assert_eq!(frame.particles().len(), whole.particles().len(), "{length}");
            }
        }
    }
}

#[test]
fn a_file_with_one_byte_changed_neither_panics_nor_exceeds_the_limit() {
    for file in [ascii(), binary(false), binary(true)] {
        for at in 0..file.len() {
            for byte in [0, b'-', b'9', b'\n', 0x7f, 0xff] {
                let mut file = file.clone();
                file[at] = byte;
                if let Ok(frame) = read(&file) {
                    assert!(frame.particles().len() <= 4);
                }
            }
        }
    }
}

#[test]
fn counts_in_the_header_are_checked_against_the_file_length() {
    let said = |header: &str, body: &str| {
        let Err(ParseError::WholeFile(reason)) =
            super::read(format!("ply\n{header}end_header\n{body}").as_bytes(), usize::MAX)
        else {
            panic!("{header}")
        };
        reason
    };
    let max_particles = usize::MAX;
    let vertex =
        |count: usize| format!("element vertex {count}\nproperty float x\nproperty float y\nproperty float z\n");
    for format in ["binary_little_endian", "ascii"] {
        let reason = said(&format!("format {format} 1.0\n{}", vertex(max_particles)), "1 2 3\n");
        assert!(reason.starts_with(&format!("{max_particles} vertex elements of at least ")), "{reason}");
        let many = vertex(max_particles).replace("vertex", "face") + &vertex(1);
        assert!(said(&format!("format {format} 1.0\n{many}"), "1 2 3\n").contains(" face elements of at least "));
    }
    assert_eq!(
        said(&format!("format ascii 1.0\n{}", vertex(2)), "1000 2000 3000\n"),
        "the file ends after 1 vertex elements; expected 2, as the header says"
    );
    let lists = "format binary_big_endian 1.0\nelement face 2\nproperty list int double i\n".to_owned() + &vertex(0);
    assert_eq!(
        said(&lists, "\u{7f}aaaaaaaa"),
        "the file ends within face 0 at byte 158; expected 2, as the header says"
    );
    assert!(said(&lists, "aaaaaaa").contains("bytes after the header"));
}

#[test]
fn errors_name_their_position() {
    let said =
        |text: &str| read(text.as_bytes()).map_err(|error| error.into_error("a.ply".as_ref()).to_string()).unwrap_err();
    let file = |format: &str, body: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\nend_header\n{body}"
        )
    };
    let ascii = |body: &str| said(&file("ascii", body));
    assert_eq!(ascii("1 2 3 4\n1 2 inf 4"), "a.ply:10:5: z: inf is not valid; expected a number up to 1e9");
    assert_eq!(ascii("1 2 3 -1\n1 2 3 4"), "a.ply:9:7: radius: -1 is not valid; expected 0 or more, up to 1e9");
    assert_eq!(ascii("1 2 3\n1 2 3 444"), "a.ply:9:6: too few numbers; expected one for each of 4 properties");
    assert_eq!(ascii("1 2 3 4 5\n1 2 3 4"), "a.ply:9:9: more numbers than the 4 properties; expected one for each");
    let mut bytes = file("binary_little_endian", "").into_bytes();
    let start = bytes.len();
    [1.0_f32, 2.0, 3.0, 4.0, 1.0, f32::NAN, 3.0, 4.0].iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    let error = read(&bytes).map_err(|error| error.into_error("a.ply".as_ref()).to_string()).unwrap_err();
    assert_eq!(
        error,
        format!("a.ply: vertex 1 at byte {}: y: NaN is not valid; expected a number up to 1e9", start + 20)
    );
    for (text, wanted) in [
        ("", "a.ply: no end_header in the first 65536 bytes; expected a PLY file"),
        ("solid\n", "a.ply:1:1: not a PLY file; expected \"ply\""),
        (
            "ply\nformat utf8 1.0\n",
            "a.ply:2:1: format \"utf8\" is not known; expected ascii, binary_little_endian or binary_big_endian",
        ),
        ("ply\nproperty float x\n", "a.ply:2:1: property before any element; expected an element line first"),
        ("ply\nelement vertex -1\n", "a.ply:2:1: \"-1\" is not a count; expected a whole number"),
        ("ply\nelement vertex 1\nproperty half x\n", "a.ply:3:1: type \"half\" is not known; expected one of char, "),
        ("ply\nelement vertex 1\nproperty list float int x\n", "a.ply:3:1: the length of list \"x\" has a float type"),
        ("ply\nelement vertex 1\nproperty x\n", "a.ply:3:1: malformed property"),
        ("ply\nend_header\n", "a.ply:2:1: no format line in the header"),
        ("ply\nshape round\n", "a.ply:2:1: \"shape round\" is not known; expected format, element,"),
        ("ply\nformat ascii 1.0\nend_header\n", "a.ply: no element vertex in the header"),
        (
            "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n",
            "a.ply: no column for the x position among the columns \"\"; expected x",
        ),
        (
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float opacity\nproperty float scale_0\nend_header\n",
            "a.ply: properties scale_0 and opacity or rot_0 are those of a Gaussian splat",
        ),
        (
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty char x\nend_header\n1 2 3 4 5",
            "a.ply: 5 vertices; expected at most 4 particles in a frame",
        ),
    ] {
        let said = said(text);
        assert!(said.starts_with(wanted), "{said}");
    }
}
