//! Frames of `color.png` by name: the "hash" form of TexturePacker's JSON, which PixiJS and Phaser read.

use serde_json::{Map, Value, json};

use super::numbers::FlipbookNumbers;
use super::sheets::COLOR;

/// Returns the JSON. Names are `<title>_0000` and so on; PixiJS finds them as the animation `<title>`.
pub fn sprite_sheet(title: &str, numbers: &FlipbookNumbers) -> String {
    let FlipbookNumbers { frame_width: width, frame_height: height, columns, rows, frames, .. } = *numbers;
    let plain = |letter: char| if letter.is_alphanumeric() { letter.to_ascii_lowercase() } else { '_' };
    let title: String = title.chars().map(plain).collect();
    let names: Vec<_> = (0..frames).map(|index| format!("{title}_{index:04}")).collect();
    let frame = |index: u32| {
        json!({
            "frame": { "x": index % columns * width, "y": index / columns * height, "w": width, "h": height },
            "rotated": false,
            "trimmed": false,
            "spriteSourceSize": { "x": 0, "y": 0, "w": width, "h": height },
            "sourceSize": { "w": width, "h": height },
        })
    };
    let by_name: Map<_, _> = names.iter().cloned().zip((0..).map(frame)).collect();
    let animations: Map<_, _> = [(title, Value::from(names))].into_iter().collect();
    let sheet = json!({
        "frames": by_name,
        "animations": animations,
        "meta": {
            "image": COLOR,
            "format": "RGBA8888",
            "size": { "w": width * columns, "h": height * rows },
            "scale": "1",
        },
    });
    format!("{sheet:#}\n")
}
