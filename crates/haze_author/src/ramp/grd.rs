//! Reads gradients of Photoshop, `*.grd` of version 5, as Krita does: straight pieces between stops, without smoothness.
//! (tonton-pixel, "Photoshop Gradients File Format"; Adobe, "Photoshop File Formats", descriptor structure)

use glam::{Vec3, Vec4};
use haze_core::error::one_line;

use super::blend_space::rgb_from_hsv;
use super::gradient_text::{ChosenGradient, GradientName, choose_gradient};
use super::photoshop_descriptor::{Descriptor, Value, read_descriptor};
use super::ramp_recipe::Blend;
use super::source_gradient::{Interpolation, NotedGradient, SourceGradient, SourcePoint};

const SIGNATURE: &[u8] = b"8BGR";
const VERSION: u8 = 5;

/// Value of a location at the end.
const END: f32 = 4096.0;

/// Reads the gradient of a name; without a name, the first.
pub fn read(bytes: &[u8], name: Option<&str>) -> Result<NotedGradient, String> {
    let Some(rest) = bytes.strip_prefix(SIGNATURE) else {
        return Err("not a gradient of Photoshop; expected \"8BGR\" at the start".into());
    };
    let rest = match rest {
        [0, VERSION, rest @ ..] => rest,
        &[high, low, ..] => {
            let found = u16::from_be_bytes([high, low]);
            let cure = "open it in Photoshop 6 or later, and export the gradients again";
            return Err(format!("version {found} of the format; expected version {VERSION}: {cure}"));
        }
        _ => return Err("the file is incomplete; expected a version after \"8BGR\"".into()),
    };
    let file = read_descriptor(rest)?;
    let gradients: Vec<_> = file.list("GrdL").iter().filter_map(gradient_of).collect();
    if gradients.is_empty() {
        return Err("no gradient; expected gradients that Photoshop has exported".into());
    }
    let shown: Vec<_> = gradients.iter().map(|gradient| shown_name(gradient.text("Nm"))).collect();
    let names: Vec<_> = shown.iter().map(|name| GradientName { name, line: None }).collect();
    let ChosenGradient { index, note } = choose_gradient(&names, name).map_err(|error| error.reason)?;
    let gradient = gradients[index];
    let refused = |reason| format!("gradient {}: {reason}", one_line(shown[index]));
    let mut notes: Vec<_> = note.into_iter().collect();
    let read = solid(gradient, &mut notes).map_err(refused)?;
    Ok(NotedGradient { gradient: read, note: (!notes.is_empty()).then(|| notes.join("; ")) })
}

/// Returns the gradient in an object of the list: it may stand in one that has only it.
fn gradient_of(value: &Value) -> Option<&Descriptor> {
    let object = value.object()?;
    object.object("Grad").or(Some(object).filter(|object| object.has("GrdF")))
}

/// Names that Photoshop translates: `$$$/DefaultGradient/BlackWhite=Black, White`.
fn shown_name(name: &str) -> &str {
    match name.strip_prefix("$$$/").and_then(|rest| rest.split_once('=')) {
        Some((_, shown)) => shown,
        None => name,
    }
}

/// Reads a gradient of stops. `notes` gets what differs from Photoshop.
fn solid(gradient: &Descriptor, notes: &mut Vec<String>) -> Result<SourceGradient, String> {
    if gradient.choice("GrdF") != "CstS" {
        return Err("it is a noise gradient; expected a solid one: choose Solid as its type in Photoshop".into());
    }
    let colors = track(gradient.list("Clrs"), |stop| Ok(color(stop)?.extend(1.0)))?;
    let mut alphas = track(gradient.list("Trns"), |stop| Ok(Vec4::splat(stop.number("Opct", 0.0..=100.0)? / 100.0)))?;
    if colors.is_empty() {
        return Err("no color stops; expected one or more".into());
    }
    if alphas.is_empty() {
        alphas.push((0.0, Vec4::ONE));
    }
    let mut is_of_tool =
        |stop: &Value| stop.object().is_some_and(|stop| ["FrgC", "BckC"].contains(&stop.choice("Type")));
    if gradient.list("Clrs").iter().any(&mut is_of_tool) {
        notes.push("its foreground and background colors are read as black and white".into());
    }
    let smoothness = gradient.number("Intr", 0.0..=END)? / END;
    if smoothness > 0.0 {
        notes.push(format!("its smoothness of {:.0} % is read as none", smoothness * 100.0));
    }
    // Both tracks are straight between the positions of all stops and midpoints.
    let mut positions: Vec<f32> = colors.iter().chain(&alphas).map(|(at, _)| *at).collect();
    positions.sort_by(f32::total_cmp);
    positions.dedup();
    let mut points = Vec::new();
    for at in positions {
        // Values before and after an edge.
        let [before, after] = [true, false].map(|is_before| {
            let alpha = value(&alphas, at, is_before).w;
            value(&colors, at, is_before).truncate().extend(alpha)
        });
        points.push(SourcePoint { at, code: before });
        if after != before {
            points.push(SourcePoint { at, code: after });
        }
    }
    Ok(SourceGradient::new(Blend::Srgb, Interpolation::Linear, points))
}

/// Reads stops: their positions and values, and those of the midpoints between them.
fn track(stops: &[Value], value: impl Fn(&Descriptor) -> Result<Vec4, String>) -> Result<Vec<(f32, Vec4)>, String> {
    let read = |stop: &Value| {
        let stop = stop.object().ok_or("a stop that is no object; expected one")?;
        let at = stop.number("Lctn", 0.0..=END)? / END;
        Ok((at, stop.number("Mdpn", 0.0..=100.0)? / 100.0, value(stop)?))
    };
    let mut stops = stops.iter().map(read).collect::<Result<Vec<_>, String>>()?;
    stops.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let mut track = Vec::new();
    for (index, (at, middle, value)) in stops.iter().enumerate() {
        track.push((*at, *value));
        if let Some((next, _, other)) = stops.get(index + 1) {
            track.push((at + (next - at) * middle, value.midpoint(*other)));
        }
    }
    Ok(track)
}

/// Returns the value of a track at a position, before or after an edge there.
fn value(track: &[(f32, Vec4)], at: f32, is_before: bool) -> Vec4 {
    let next = track.partition_point(|(position, _)| *position < at || !is_before && *position <= at);
    match (track.get(next.wrapping_sub(1)), track.get(next)) {
        (Some((from, start)), Some((to, end))) => start.lerp(*end, (at - from) / (to - from).max(f32::MIN_POSITIVE)),
        (Some((_, end)), None) | (None, Some((_, end))) => *end,
        (None, None) => Vec4::ZERO,
    }
}

/// Returns the sRGB code of a stop, 0 to 1.
fn color(stop: &Descriptor) -> Result<Vec3, String> {
    match stop.choice("Type") {
        "FrgC" => return Ok(Vec3::ZERO),
        "BckC" => return Ok(Vec3::ONE),
        _ => {}
    }
    let color = stop.object("Clr").ok_or("a stop without a color; expected one of RGB, HSB or gray")?;
    let channels = |keys: [&str; 3], max: f32| -> Result<Vec3, String> {
        let [x, y, z] = keys.map(|key| color.number(key, 0.0..=max));
        Ok(Vec3::new(x?, y?, z?) / max)
    };
    let cure = "expected RGB, HSB or gray: choose the color of the stop as RGB in Photoshop";
    match color.class() {
        "RGBC" => channels(["Rd", "Grn", "Bl"], 255.0),
        "HSBC" => {
            let hue = color.number("H", 0.0..=360.0)? / 360.0;
            let [saturation, brightness] = ["Strt", "Brgh"].map(|key| color.number(key, 0.0..=100.0));
            Ok(rgb_from_hsv(Vec3::new(hue, saturation? / 100.0, brightness? / 100.0)))
        }
        "Grsc" => Ok(Vec3::splat(color.number("Gry", 0.0..=100.0)? / 100.0)),
        "CMYC" => Err(format!("a stop has a color of CMYK; {cure}")),
        "LbCl" => Err(format!("a stop has a color of Lab; {cure}")),
        "BkCl" => Err(format!("a stop has a color of a color book; {cure}")),
        other => Err(format!("a stop has a color of the kind {}; {cure}", one_line(other))),
    }
}

#[cfg(test)]
mod tests;
