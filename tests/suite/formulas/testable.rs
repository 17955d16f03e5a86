//! Rewrites composed shaders so that a test can set what their functions read: uniforms, storage buffers and override
//! constants become private variables; textures and samplers become those of the test.

/// Elements of an array that takes the place of a storage buffer.
pub const STORAGE_LENGTH: usize = 16;

/// Returns the rewritten shader, and the statements that copy the uniforms of the fixture to the private variables.
pub fn testable(source: &str) -> (String, String) {
    let mut text = String::new();
    let mut start = String::new();
    let mut replaced = Vec::new();
    for line in source.lines() {
        if let Some(rest) = line.strip_prefix("override ") {
            let rest = if rest.starts_with("EXACT_FILTERING") { "EXACT_FILTERING: bool = true;" } else { rest };
            text.push_str(&format!("var<private> {rest}\n"));
        } else if let Some((space, name, ty)) = binding(line) {
            match (space, test_texture(ty)) {
                ("uniform", _) if ["view", "system"].contains(&name) => {
                    let index = u32::from(name == "system");
                    text.push_str(&format!("@group(1) @binding({index}) var<uniform> fixture_{name}: {ty};\n"));
                    text.push_str(&format!("var<private> {name}: {ty};\n"));
                    start.push_str(&format!("{name} = fixture_{name}; "));
                }
                ("uniform", _) if name == "lights" => {
                    text.push_str(&format!("@group(1) @binding(2) var<uniform> lights: {ty};\n"));
                }
                // Only workgroup and storage variables may have atomics.
                (_, None) if ty == "TileCounters" => text.push_str(&format!("var<workgroup> {name}: {ty};\n")),
                ("", Some(texture)) => replaced.push((name.to_owned(), texture)),
                // Storage textures stay: no tested function writes to them.
                ("", None) => text.push_str(&format!("{line}\n")),
                _ => {
                    let element = ty.strip_prefix("array<").and_then(|rest| rest.strip_suffix('>'));
                    let ty = match element.filter(|element| !element.contains(',')) {
                        Some(element) => format!("array<{element}, {STORAGE_LENGTH}>"),
                        None => ty.to_owned(),
                    };
                    text.push_str(&format!("var<private> {name}: {ty};\n"));
                }
            }
        } else {
            text.push_str(line);
            text.push('\n');
        }
    }
    for (name, texture) in replaced {
        text = replace_word(&text, &name, texture);
    }
    (text, start)
}

/// Splits the declaration of a binding into address space, name and type.
fn binding(line: &str) -> Option<(&str, &str, &str)> {
    let declaration = line.strip_prefix("@group(")?.split_once(" var")?.1.strip_suffix(';')?;
    let (space, typed) = match declaration.strip_prefix('<') {
        Some(qualified) => qualified.split_once("> ")?,
        None => ("", declaration.trim_start()),
    };
    let (name, ty) = typed.split_once(": ")?;
    Some((space, name, ty))
}

/// Returns the test's texture or sampler of a type.
fn test_texture(ty: &str) -> Option<&'static str> {
    match ty {
        "texture_2d<f32>" => Some("test_ramp"),
        "texture_2d_array<f32>" => Some("test_sprite"),
        "texture_3d<f32>" => Some("test_noise"),
        "texture_2d<u32>" => Some("test_alpha_bounds"),
        "sampler" => Some("test_sampler"),
        _ => None,
    }
}

fn replace_word(text: &str, from: &str, to: &str) -> String {
    let is_part = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    let mut result = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(from) {
        let before = &rest[..at];
        let after = &rest[at + from.len()..];
        let is_word = !is_part(before.chars().next_back()) && !is_part(after.chars().next());
        result.push_str(before);
        result.push_str(if is_word { to } else { from });
        rest = after;
    }
    result + rest
}
