//! Names of fields and choices as panels, undo steps and the search show them.

pub use egui_gradient::sentence_case;

/// Fields, groups and choices whose names in files are abbreviations, or terms of programmers.
const SPELLED_OUT: [(&str, &str); 18] = [
    ("accumulate", "Smoke buffer"),
    ("particle_files", "Particles from files"),
    ("downscale", "Scale"),
    ("environment", "Sky and scene"),
    ("fbm", "Fractal noise"),
    ("fov", "Field of view"),
    ("fps", "Frames per second"),
    ("hsv_far", "HSV, far hue"),
    ("hsv_near", "HSV, near hue"),
    ("material", "Sprite and ramps"),
    ("max_error", "Largest error"),
    ("max_side", "Longest side"),
    ("oklab", "OKLab"),
    ("other_tint", "Second tint"),
    ("rgba16float", "RGBA 16-bit float"),
    ("rgba8unorm", "RGBA 8-bit"),
    ("six_way", "Six-way"),
    ("srgb", "sRGB"),
];

/// Returns the name of a field or a choice in sentence case: "Soft scatter" for `soft_scatter`.
pub fn display_name(name: &str) -> String {
    if let Some((_, shown)) = SPELLED_OUT.into_iter().find(|(field, _)| *field == name) {
        return shown.into();
    }
    sentence_case(&name.replace('_', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_sentence_case_and_without_abbreviations() {
        for (name, shown) in
            [("soft_scatter", "Soft scatter"), ("fov", "Field of view"), ("size at birth", "Size at birth"), ("", "")]
        {
            assert_eq!(display_name(name), shown);
        }
    }
}
