//! Checks images against their role: files that load, but were probably made for another purpose.

use glam::{UVec2, Vec2, Vec3Swizzles as _};
use haze_core::assets::material_assets::MaterialAssets;
use haze_core::assets::ramp::Ramp;
use haze_preset::MaterialSources;

use crate::sprite::lint::{EMPTY_MESSAGE, describe_non_normals, is_clear};

/// Largest difference between channels of linear colors that count as equal.
const SAME: f32 = 1.0 / 64.0;

/// Warnings about images that do not seem to fit their role: the field, and the warning.
pub fn role_warnings(names: &MaterialSources, loaded: &MaterialAssets) -> Vec<(&'static str, String)> {
    let ramps = [
        ("soft_scatter_ramp", &names.soft_scatter_ramp, &loaded.soft_scatter_ramp),
        ("age_ramp", &names.age_ramp, &loaded.age_ramp),
        ("coverage_ramp", &names.coverage_ramp, &loaded.coverage_ramp),
        ("heat_ramp", &names.heat_ramp, &loaded.heat_ramp),
    ];
    let of_ramps = ramps.iter().map(|(field, name, ramp)| (*field, *name, check_single_row_ramp(ramp)));
    let others = [
        ("diffuse_ramp", &names.diffuse_ramp, check_diffuse_ramp(&loaded.diffuse_ramp)),
        ("backlight_ramp", &names.backlight_ramp, check_diffuse_ramp(&loaded.backlight_ramp)),
        ("shadow_ramp", &names.shadow_ramp, check_shadow_ramp(&loaded.shadow_ramp)),
        ("fire_ramp", &names.fire_ramp, check_fire_ramp(&loaded.fire_ramp)),
        ("specular_ramp", &names.specular_ramp, check_specular_ramp(&loaded.specular_ramp)),
        ("motif", &names.motif, check_motif(&loaded.motif)),
    ];
    let of_sprite = if is_clear(&loaded.sprite) { Some(EMPTY_MESSAGE) } else { describe_non_normals(&loaded.sprite) };
    let sprite = [("sprite", &names.sprite, of_sprite.map(String::from))];
    let warnings = sprite.into_iter().chain(of_ramps).chain(others);
    warnings.filter_map(|(field, name, warning)| Some((field, format!("{name}: {}", warning?)))).collect()
}

/// Checks a ramp whose rows are looked up by amount.
fn check_diffuse_ramp(ramp: &Ramp) -> Option<String> {
    let size = ramp.size();
    let is_black = |x: u32| (0..size.y).all(|y| ramp.texel(UVec2::new(x, y)).max_element() < SAME);
    let is_specular = size.y > 1 && is_black(size.x - 1) && !(0..size.x).all(is_black);
    let specular =
        || "black where it faces the light, as a specular ramp is; expected dot(n, l) across, amount up".into();
    check_rows(ramp).or_else(|| is_specular.then(specular))
}

/// Checks a ramp that is looked up by the smoke before a light.
fn check_shadow_ramp(ramp: &Ramp) -> Option<String> {
    let size = ramp.size();
    let sum = |x: u32| (0..size.y).map(|y| ramp.texel(UVec2::new(x, y)).element_sum()).sum::<f32>();
    let dark = || {
        let first = "darker in the first column, where no smoke is in front of the light, than in the last";
        format!("{first}; expected the lightest column there: thin smoke is lit by full light")
    };
    (sum(0) < sum(size.x - 1)).then(dark)
}

/// Checks a ramp that is looked up by heat.
fn check_fire_ramp(ramp: &Ramp) -> Option<String> {
    let lit = (0..ramp.size().y).map(|y| ramp.texel(UVec2::new(0, y)).max_element()).fold(0.0, f32::max);
    let glows =
        || "not black in the first column, at heat 0; expected black there: cold smoke gives no light".to_owned();
    (lit > SAME).then(glows).or_else(|| check_rows(ramp))
}

/// Checks a ramp that is looked up in one row.
fn check_single_row_ramp(ramp: &Ramp) -> Option<String> {
    let rows = ramp.size().y;
    let differ = || format!("its {rows} rows differ, and only the bottom one is looked up; expected a ramp of one row");
    check_rows(ramp).or_else(|| (!rows_are_equal(ramp)).then(differ))
}

fn rows_are_equal(ramp: &Ramp) -> bool {
    all_texels_equal(ramp, |x, _| UVec2::new(x, 0))
}

/// True if every texel equals the one at `as_at` of its position.
fn all_texels_equal(ramp: &Ramp, as_at: impl Fn(u32, u32) -> UVec2) -> bool {
    let size = ramp.size();
    let mut texels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y)));
    texels.all(|(x, y)| ramp.texel(UVec2::new(x, y)).abs_diff_eq(ramp.texel(as_at(x, y)), SAME))
}

/// Checks a ramp with different rows for the signs of another kind of image.
fn check_rows(ramp: &Ramp) -> Option<String> {
    if rows_are_equal(ramp) {
        return None;
    }
    if shows_normals(ramp) {
        return Some("looks like the normals of a sprite; expected a ramp from left to right".into());
    }
    all_texels_equal(ramp, |_, y| UVec2::new(0, y))
        .then(|| "painted from top to bottom; expected a ramp from left to right".into())
}

fn check_specular_ramp(ramp: &Ramp) -> Option<String> {
    if shows_normals(ramp) {
        return Some("looks like the normals of a sprite; expected distance² across and amount up".into());
    }
    let size = ramp.size();
    if size.y == 1 {
        return Some("its one row is the same for every amount; expected distance² across and amount up".into());
    }
    // A single color is not a mistake.
    (!rows_are_equal(ramp) && all_texels_equal(ramp, |_, y| UVec2::new(0, y)))
        .then(|| "the same at every distance; expected distance² across and amount up".into())
}

fn check_motif(motif: &Ramp) -> Option<String> {
    let size = motif.size();
    (size.x != size.y)
        .then(|| format!("{}x{} pixels; expected a square with a lit sphere that fills it", size.x, size.y))
}

/// True if the colors are those of normals on black: more blue than red and green, which vary independently. In a
/// gradient they vary together: the correlation of red and green is at least 0.4 in all ramps that come with haze, and
/// at most 0.2 in all sprites.
fn shows_normals(ramp: &Ramp) -> bool {
    /// Darker texels have no color to judge by.
    const DARK: f32 = 0.05;
    let size = ramp.size();
    let texels = || {
        let all = (0..size.y).flat_map(|y| (0..size.x).map(move |x| ramp.texel(UVec2::new(x, y))));
        all.filter(|light| light.max_element() >= DARK && light.z > 0.0)
    };
    let (sum, blue) = texels().fold((Vec2::ZERO, 0.0), |(sum, blue), light| (sum + light.xy(), blue + light.z));
    let mean = sum / blue;
    // Red and green as fractions of blue, so that half-transparent texels give the same. Blue is the weight.
    let mut squares = Vec2::ZERO;
    let mut product = 0.0;
    for light in texels() {
        let apart = light.xy() / light.z - mean;
        squares += apart * apart * light.z;
        product += apart.x * apart.y * light.z;
    }
    let is_blue = mean.cmpgt(Vec2::splat(0.1)).all() && mean.cmplt(Vec2::splat(0.75)).all();
    let differs = squares.cmpgt(Vec2::splat(1.0e-4 * blue)).all();
    is_blue && differs && product.abs() < 0.3 * (squares.x * squares.y).sqrt()
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};

    use super::*;
    use haze_preset::{ImageSource, builtin};

    #[test]
    fn images_in_the_wrong_role_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let save = |name: &str, size: (u32, u32), color: fn(u32, u32) -> [u8; 3]| {
            let image = RgbImage::from_fn(size.0, size.1, |x, y| Rgb(color(x, y)));
            image.save(folder.path().join(name)).unwrap();
        };
        save("across.png", (64, 4), |x, _| [4 * x as u8; 3]);
        save("down.png", (4, 64), |_, y| [4 * y as u8; 3]);
        save("both.png", (64, 64), |x, y| [(x * y / 16) as u8; 3]);
        save("normals.png", (32, 32), |x, y| [112 + x as u8, 112 + y as u8, 240]);
        let warnings = |change: fn(&mut MaterialSources)| {
            let mut names = MaterialSources::default();
            change(&mut names);
            role_warnings(&names, &names.load(ImageSource::folder(folder.path())).unwrap())
        };
        let one = |change: fn(&mut MaterialSources), field: &str, text: &str| {
            let found = warnings(change);
            let [(found_field, found)] = &found[..] else { panic!("{text}: {found:?}") };
            assert!(*found_field == field && found.contains(text), "{found_field}: {found}");
        };
        assert_eq!(warnings(|_| {}), []);
        assert_eq!(warnings(|names| names.diffuse_ramp = "across.png".into()), []);
        assert_eq!(warnings(|names| names.specular_ramp = "both.png".into()), []);
        one(|names| names.diffuse_ramp = "down.png".into(), "diffuse_ramp", "from top to bottom");
        one(|names| names.coverage_ramp = "both.png".into(), "coverage_ramp", "its 64 rows differ");
        one(|names| names.diffuse_ramp = "specular_halo".into(), "diffuse_ramp", "as a specular ramp is");
        assert_eq!(warnings(|names| names.diffuse_ramp = "both.png".into()), []);
        one(|names| names.fire_ramp = "shadow_neutral".into(), "fire_ramp", "not black in the first column");
        one(|names| names.shadow_ramp = "across.png".into(), "shadow_ramp", "darker in the first column");
        let ball = builtin::find(builtin::SPRITES, "ball").unwrap();
        std::fs::write(folder.path().join("ball.png"), ball.bytes).unwrap();
        one(|names| names.diffuse_ramp = "ball.png".into(), "diffuse_ramp", "normals of a sprite");
        one(|names| names.age_ramp = "normals.png".into(), "age_ramp", "normals of a sprite");
        one(|names| names.specular_ramp = "normals.png".into(), "specular_ramp", "normals of a sprite");
        let sheet = image::RgbaImage::from_fn(16, 16, |x, y| {
            let inside = (1..15).contains(&x) && (1..15).contains(&y);
            image::Rgba([240, 90 + 4 * x as u8, 30, if inside { 255 } else { 0 }])
        });
        sheet.save(folder.path().join("fire.png")).unwrap();
        one(|names| names.sprite = "fire.png".into(), "sprite", "colors, not normals");
        one(|names| names.specular_ramp = "down.png".into(), "specular_ramp", "the same at every distance");
        one(|names| names.motif = "across.png".into(), "motif", "64x4 pixels");
    }
}
