//! Files that are written by the description of the format: no file of Photoshop is free to be kept here.

use super::*;

fn name(text: &str) -> Vec<u8> {
    let padded = format!("{text:<4}");
    match padded.len() {
        4 => [&[0; 4], padded.as_bytes()].concat(),
        length => [&(length as u32).to_be_bytes(), padded.as_bytes()].concat(),
    }
}

fn text(text: &str) -> Vec<u8> {
    let units: Vec<_> = text.encode_utf16().chain([0]).collect();
    let bytes = units.iter().flat_map(|unit| unit.to_be_bytes());
    (units.len() as u32).to_be_bytes().into_iter().chain(bytes).collect()
}

fn long(value: i32) -> Vec<u8> {
    [&b"long"[..], &value.to_be_bytes()].concat()
}

fn double(value: f64) -> Vec<u8> {
    [&b"doub"[..], &value.to_be_bytes()].concat()
}

fn unit(unit: &[u8; 4], value: f64) -> Vec<u8> {
    [&b"UntF"[..], unit, &value.to_be_bytes()].concat()
}

fn choice(kind: &str, value: &str) -> Vec<u8> {
    [&b"enum"[..], &name(kind), &name(value)].concat()
}

fn list(values: &[Vec<u8>]) -> Vec<u8> {
    [&b"VlLs"[..], &(values.len() as u32).to_be_bytes(), &values.concat()].concat()
}

fn descriptor(class: &str, items: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = [text(""), name(class), (items.len() as u32).to_be_bytes().into()].concat();
    items.iter().for_each(|(key, value)| bytes.extend([&name(key)[..], value].concat()));
    bytes
}

fn object(class: &str, items: &[(&str, Vec<u8>)]) -> Vec<u8> {
    [&b"Objc"[..], &descriptor(class, items)].concat()
}

fn file(gradients: &[Vec<u8>]) -> Vec<u8> {
    let list = list(gradients);
    [&b"8BGR"[..], &[0, 5], &16_u32.to_be_bytes(), &descriptor("null", &[("GrdL", list)])].concat()
}

fn rgb([r, g, b]: [f64; 3]) -> Vec<u8> {
    object("RGBC", &[("Rd", double(r)), ("Grn", double(g)), ("Bl", double(b))])
}

fn stop(color: Vec<u8>, at: i32, middle: i32) -> Vec<u8> {
    let kind = choice("Clry", "UsrS");
    object("Clrt", &[("Clr", color), ("Type", kind), ("Lctn", long(at)), ("Mdpn", long(middle))])
}

fn tool_stop(kind: &str, at: i32) -> Vec<u8> {
    object("Clrt", &[("Type", choice("Clry", kind)), ("Lctn", long(at)), ("Mdpn", long(50))])
}

fn opacity(percent: f64, at: i32, middle: i32) -> Vec<u8> {
    object("TrnS", &[("Opct", unit(b"#Prc", percent)), ("Lctn", long(at)), ("Mdpn", long(middle))])
}

fn gradient(title: &str, smoothness: f64, colors: &[Vec<u8>], opacities: &[Vec<u8>]) -> Vec<u8> {
    let title = [&b"TEXT"[..], &text(title)].concat();
    let form = choice("GrdF", "CstS");
    let stops = [("Clrs", list(colors)), ("Trns", list(opacities))];
    let items = [("Nm", title), ("GrdF", form), ("Intr", double(smoothness))];
    object("Grdn", &[("Grad", object("Grdn", &[&items[..], &stops].concat()))])
}

fn opaque() -> [Vec<u8>; 2] {
    [opacity(100.0, 0, 50), opacity(100.0, 4096, 50)]
}

/// A gradient of colors alone.
fn of_colors(colors: &[Vec<u8>]) -> Vec<u8> {
    gradient("A", 0.0, colors, &opaque())
}

fn found(bytes: &[u8], name: Option<&str>) -> NotedGradient {
    read(bytes, name).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(bytes: &[u8]) -> String {
    read(bytes, None).err().unwrap_or_default()
}

#[track_caller]
fn near(gradient: &SourceGradient, at: f32, code: [f32; 3]) {
    let found = gradient.code(at) * 255.0;
    assert!(found.distance(Vec3::from(code)) < 0.6, "{at}: {found} is not {code:?}");
}

#[test]
fn colors_of_each_kind_are_read() {
    let hsb = object("HSBC", &[("H", unit(b"#Ang", 120.0)), ("Strt", double(50.0)), ("Brgh", double(100.0))]);
    let gray = object("Grsc", &[("Gry", double(20.0))]);
    let colors = [stop(rgb([255.0, 128.0, 0.0]), 0, 50), stop(hsb, 2048, 50), stop(gray, 4096, 50)];
    let NotedGradient { gradient, note } = found(&file(&[of_colors(&colors)]), None);
    near(&gradient, 0.0, [255.0, 128.0, 0.0]);
    near(&gradient, 0.25, [191.25, 191.5, 63.75]);
    near(&gradient, 0.5, [127.5, 255.0, 127.5]);
    near(&gradient, 1.0, [51.0; 3]);
    assert_eq!(note, None);
    for (class, kind) in
        [("CMYC", "of CMYK"), ("LbCl", "of Lab"), ("BkCl", "of a color book"), ("Odd", "of the kind Odd")]
    {
        let said = refused(&file(&[of_colors(&[stop(object(class, &[]), 0, 50)])]));
        let expected = "expected RGB, HSB or gray: choose the color of the stop as RGB in Photoshop";
        assert_eq!(said, format!("gradient A: a stop has a color {kind}; {expected}"));
    }
}

#[test]
fn midpoints_bend_colors_and_alpha_on_their_own() {
    let black = rgb([0.0; 3]);
    let white = rgb([255.0; 3]);
    let colors = [stop(black, 0, 25), stop(white.clone(), 4096, 50)];
    let NotedGradient { gradient, .. } = found(&file(&[of_colors(&colors)]), None);
    near(&gradient, 0.25, [127.5; 3]);
    near(&gradient, 0.125, [63.75; 3]);
    near(&gradient, 0.625, [191.25; 3]);
    // White that fades from a quarter on: half of its light at the midpoint of alpha, code 187.5.
    let fading = gradient_of_alpha(&white, &[opacity(100.0, 1024, 75), opacity(0.0, 3072, 50)]);
    near(&fading, 0.2, [255.0; 3]);
    near(&fading, 0.625, [187.5; 3]);
    near(&fading, 0.8, [0.0; 3]);
    let edge = gradient_of_alpha(&white, &[opacity(100.0, 0, 50), opacity(100.0, 2048, 50), opacity(0.0, 2048, 50)]);
    near(&edge, 0.499, [255.0; 3]);
    near(&edge, 0.501, [0.0; 3]);
}

fn gradient_of_alpha(color: &[u8], opacities: &[Vec<u8>]) -> SourceGradient {
    let colors = [stop(color.to_vec(), 0, 50), stop(color.to_vec(), 4096, 50)];
    found(&file(&[gradient("A", 0.0, &colors, opacities)]), None).gradient
}

#[test]
fn one_of_several_is_chosen_and_what_differs_is_told() {
    let tool = [tool_stop("FrgC", 0), tool_stop("BckC", 4096)];
    let fire = [stop(rgb([255.0, 0.0, 0.0]), 0, 50)];
    let gradients =
        [gradient("$$$/Default/Tool=Tool, two", 4096.0, &tool, &opaque()), gradient("Fire \u{1f525}", 0.0, &fire, &[])];
    let first = found(&file(&gradients), None);
    near(&first.gradient, 0.5, [127.5; 3]);
    let note = first.note.unwrap_or_default();
    assert_eq!(
        note,
        "read gradient Tool, two, not Fire \u{1f525}; --gradient chooses one; its foreground and background colors are read as \
         black and white; its smoothness of 100 % is read as none"
    );
    let second = found(&file(&gradients), Some("Fire \u{1f525}"));
    near(&second.gradient, 0.5, [255.0, 0.0, 0.0]);
    assert_eq!(second.note, None);
    let unknown = read(&file(&gradients), Some("Ice")).err().unwrap_or_default();
    assert!(unknown.starts_with("no gradient \"Ice\"; expected one of Tool, two, Fire"), "{unknown}");
    let tool = found(&file(&gradients[..1]), None).note.unwrap_or_default();
    assert!(tool.starts_with("its foreground"), "{tool}");
}

#[test]
fn what_is_not_read_is_refused_by_name() {
    let noise = object("Grdn", &[("Grad", object("Grdn", &[("GrdF", choice("GrdF", "ClNs"))]))]);
    assert!(refused(&file(&[noise])).contains("it is a noise gradient; expected a solid one"));
    let old = [&b"8BGR"[..], &[0, 3], &[0; 40]].concat();
    assert!(refused(&old).starts_with("version 3 of the format; expected version 5: open it in Photoshop 6 or later"));
    assert!(refused(b"GIMP").starts_with("not a gradient of Photoshop; expected \"8BGR\""));
    assert!(refused(&file(&[])).starts_with("no gradient; expected"));
    assert!(refused(&file(&[of_colors(&[])])).contains("no color stops; expected one or more"));
    let far = of_colors(&[stop(rgb([0.0; 3]), 5000, 50)]);
    assert!(refused(&file(&[far])).contains("Lctn: 5000 is out of range 0 to 4096"));
    for wrong in [256.0, -1.0, f64::NAN, f64::INFINITY] {
        let bright = of_colors(&[stop(rgb([0.0, wrong, 0.0]), 0, 50)]);
        assert!(refused(&file(&[bright])).contains("is out of range 0 to 255"), "{wrong}");
    }
    let unknown = object("Grdn", &[("Nm", b"what".to_vec())]);
    assert!(refused(&file(&[unknown])).contains("a value of the unknown kind what"));
}

#[test]
fn files_that_end_early_and_deep_ones_are_refused() {
    let whole = file(&[of_colors(&[stop(rgb([1.0, 2.0, 3.0]), 0, 50)])]);
    for end in 0..whole.len() {
        let said = refused(&whole[..end]);
        assert!(said.contains("incomplete") || end < 4 && said.contains("8BGR"), "{end}: {said}");
    }
    // Any byte may be wrong: the file is read or refused.
    for at in 0..whole.len() {
        for wrong in [0x00, 0x7f, 0xff] {
            let mut damaged = whole.clone();
            damaged[at] = wrong;
            let _ = read(&damaged, None).map(|read| read.gradient.code(0.5));
        }
    }
    let huge = [&b"8BGR"[..], &[0, 5, 0, 0, 0, 16], &[0xff; 12]].concat();
    assert!(refused(&huge).contains("incomplete"));
    let mut deep = object("Grdn", &[]);
    for _ in 0..100 {
        deep = list(&[deep]);
    }
    assert!(refused(&file(&[deep])).contains("inside each other"));
}
