//! Hints in the names of files: `smoke_tlr_8x8.png`.

use glam::UVec2;

use super::role::Role;
use super::side::Side;

/// Words that tell the contents of a file. Longer ones that begin so count too: `normals`.
const WORDS: [(&str, Role); 34] = [
    ("opacity", Role::Opacity),
    ("alpha", Role::Opacity),
    ("mask", Role::Opacity),
    ("density", Role::Opacity),
    ("transparency", Role::Opacity),
    ("normal", Role::Normals),
    ("nrm", Role::Normals),
    ("sixway", Role::SixWay),
    ("6way", Role::SixWay),
    ("sixpoint", Role::SixWay),
    ("6point", Role::SixWay),
    ("lightmap", Role::SixWay),
    ("positive", Role::SixWay),
    ("negative", Role::SixWay),
    ("motion", Role::Motion),
    ("velocity", Role::Motion),
    ("vector", Role::Motion),
    ("mv", Role::Motion),
    ("flow", Role::Motion),
    ("emission", Role::Emission),
    ("emissive", Role::Emission),
    ("fire", Role::Emission),
    ("flame", Role::Emission),
    ("glow", Role::Emission),
    ("heat", Role::Heat),
    ("temperature", Role::Heat),
    ("temp", Role::Heat),
    ("depth", Role::Depth),
    ("height", Role::Depth),
    ("color", Role::Color),
    ("colour", Role::Color),
    ("albedo", Role::Color),
    ("diffuse", Role::Color),
    ("beauty", Role::Color),
];

/// Parts of a name between signs and at changes from small to capital letters, in lower case.
fn words(stem: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for c in stem.chars() {
        if !c.is_alphanumeric() || (was_small && c.is_uppercase()) {
            words.push(String::new());
        }
        was_small = c.is_lowercase();
        if let Some(word) = words.last_mut().filter(|_| c.is_alphanumeric()) {
            word.extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Returns the contents that the last telling word of a name stands for.
pub(super) fn role_of(stem: &str) -> Option<Role> {
    let of_word = |word: &String| {
        if sides_of_word(word).is_some() {
            return Some(Role::SixWay);
        }
        let found = WORDS.iter().find(|(begin, _)| match begin.len() {
            // Short words begin many others.
            0..=2 => word == begin,
            _ => word.starts_with(begin),
        });
        found.map(|(_, role)| *role)
    };
    words(stem).iter().rev().find_map(of_word)
}

/// Returns the columns and rows that a name gives, as `_8x4`.
pub(super) fn grid_of(stem: &str) -> Option<UVec2> {
    let of_word = |word: &String| {
        let (columns, rows) = word.split_once('x')?;
        let count = |digits: &str| digits.parse().ok().filter(|count| (1..=64).contains(count));
        Some(UVec2::new(count(columns)?, count(rows)?))
    };
    words(stem).iter().rev().find_map(of_word)
}

/// Sides of the red, green and blue of a light map, as far as a name gives them.
pub(super) type NamedSides = [Vec<Side>; 3];

/// Returns the sides that a name gives as three letters: `tlr` for top, left and right. B is the bottom or the back.
pub(super) fn sides_of(stem: &str) -> Option<NamedSides> {
    words(stem).iter().rev().find_map(|word| sides_of_word(word))
}

fn sides_of_word(word: &str) -> Option<NamedSides> {
    let letters: [char; 3] = word.chars().collect::<Vec<_>>().try_into().ok()?;
    let sides = |letter| {
        Some(match letter {
            'r' => vec![Side::Right],
            'l' => vec![Side::Left],
            't' => vec![Side::Top],
            'f' => vec![Side::Front],
            'b' => vec![Side::Bottom, Side::Back],
            _ => return None,
        })
    };
    let [first, second, third] = letters.map(sides);
    let is_twice = |letter: char| letters.iter().filter(|other| **other == letter).count() > 1;
    if "rltf".chars().any(is_twice) || letters == ['b'; 3] {
        return None;
    }
    Some([first?, second?, third?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_contents_grid_and_sides() {
        for (stem, role) in [
            ("fire_8x8_normals", Some(Role::Normals)),
            ("SmokeOpacity", Some(Role::Opacity)),
            ("smoke_TLR", Some(Role::SixWay)),
            ("smoke_mv_01", Some(Role::Motion)),
            ("SmokeLoop_MotionVectors", Some(Role::Motion)),
            ("T_Explosion_Emissive", Some(Role::Emission)),
            ("mvp", None),
            ("smoke", None),
        ] {
            assert_eq!(role_of(stem), role, "{stem}");
        }
        assert_eq!(grid_of("puff_8x4_alpha"), Some(UVec2::new(8, 4)));
        assert_eq!([grid_of("puff_8x400"), grid_of("max"), grid_of("0x3")], [None; 3]);
        let [bottom, back, front] = sides_of("smoke_bbf").unwrap();
        assert_eq!((bottom.len(), back.len(), front), (2, 2, vec![Side::Front]));
        assert!(["smoke_rrt", "smoke_bbb", "smoke_fog"].iter().all(|stem| sides_of(stem).is_none()));
    }
}
