//! Frames as their files store them, and the scales of their values, which files do not name.
//!
//! A color of 0.5 is linear light, one of 127 an sRGB code. All frames of a simulation have one scale: it is decided
//! from the largest value of any frame.

use std::ops::RangeInclusive;

use glam::Vec3;
use haze_core::formula::color::linear_from_srgb;

use super::column_role::{Attribute, plain_name};
use super::columns::ColumnMap;
use super::particle_frame::{FileParticle, ParticleFrame};

/// Temperatures of heat 0 and heat 1, kelvin. Bodies begin to glow visibly near 800 K (Draper, 1847); soot in a flame
/// has up to about 2000 K.
pub const KELVIN: RangeInclusive<f32> = 800.0..=2000.0;

/// Larger temperatures are kelvin: no smoke is colder than 200 K.
pub const MIN_KELVIN: f32 = 200.0;

/// Name of heat that two conventions share: 0 to 1 in Blender and Houdini, kelvin in physical simulations.
const TEMPERATURE: &str = "temperature";

/// Largest temperature that is a rounded 1.
const MAX_HEAT: f32 = 1.001;

/// Largest value that may be a fraction above 1. Codes of 255 that are all below it would be almost black.
const MAX_FRACTION: f32 = 16.0;

/// Largest code of 8 bits.
const MAX_CODE: f32 = 255.0;

/// A frame as read, with values on the scales of its file.
pub struct FileFrame {
    pub frame: ParticleFrame,
    pub columns: ColumnMap,
}

/// Scale of an attribute's values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Scale {
    /// 0 to 1.
    #[default]
    Fraction,
    /// 0 to 255; colors are sRGB.
    Codes,
    Kelvin,
}

/// Scales of a simulation's values.
pub struct Scales {
    color: ValueRange,
    amount: ValueRange,
    heat: ValueRange,
    /// True if all values of an integer alpha are full: programs write such a column beside every color.
    is_alpha_unset: bool,
}

/// Values of an attribute in all frames, except in those whose columns have the scale in their type.
#[derive(Clone, Copy)]
struct ValueRange {
    least: f32,
    largest: f32,
    is_whole: bool,
    /// Index of the frame with the largest value.
    frame: usize,
    scale: Scale,
}

/// Attributes that the columns of a file were read as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnUse {
    /// Attributes with their columns and scales.
    pub read: String,
    /// Names of the columns of a color; empty without one.
    pub color: String,
    /// Names of the columns of heat; empty without one.
    pub heat: String,
    /// Columns that are not read, with the reason.
    pub unread: Vec<String>,
}

/// A value that fits no scale.
pub struct UnknownScale {
    /// Index of its frame.
    pub frame: usize,
    pub reason: String,
}

impl Scales {
    /// Decides the scales of all frames of a simulation.
    pub fn of_frames(frames: &[FileFrame]) -> Result<Self, UnknownScale> {
        let color = ValueRange::of_frames(frames, Attribute::Color)?;
        let amount = ValueRange::of_frames(frames, Attribute::Amount)?;
        let heat = ValueRange::of_frames(frames, Attribute::Heat)?;
        let mut with_amount = frames.iter().filter(|frame| frame.frame.provided().amount).peekable();
        let is_alpha_unset =
            with_amount.peek().is_some() && with_amount.all(|frame| frame.has_full_alpha(amount.scale));
        Ok(Self { color, amount, heat, is_alpha_unset })
    }

    /// Returns the attributes that the columns of a frame are read as.
    pub fn column_use(&self, columns: &ColumnMap) -> ColumnUse {
        let mut read = Vec::new();
        let mut unread = Vec::new();
        for (attribute, names) in columns.read_names() {
            if attribute == Attribute::Amount && self.is_alpha_unset {
                unread.push(format!(
                    "{names} is not read: it is full in every particle, as programs write it beside colors; \
                     expected an alpha that varies, or a column named amount"
                ));
            } else {
                read.push(format!("{} from {names}{}", attribute.name(), self.scale_name(attribute, columns)));
            }
        }
        for (attribute, names) in columns.replaced_names() {
            let others = columns.names(attribute);
            unread.push(format!("{names} is not read: the {} is read from {others}", attribute.name()));
        }
        let unknown = columns.unknown_names();
        if !unknown.is_empty() {
            unread.push(format!("{unknown}: not read; expected names that docs/particles.md lists"));
        }
        let color = columns.names(Attribute::Color);
        let heat = columns.names(Attribute::Heat);
        ColumnUse { read: read.join("; "), color, heat, unread }
    }

    fn scale_name(&self, attribute: Attribute, columns: &ColumnMap) -> String {
        let range = match attribute {
            Attribute::Color => &self.color,
            Attribute::Amount => &self.amount,
            Attribute::Heat => &self.heat,
            _ => return String::new(),
        };
        let is_color = attribute == Attribute::Color;
        match range.scale {
            _ if columns.is_code(attribute) && is_color => " as sRGB codes".into(),
            _ if columns.is_code(attribute) => String::new(),
            Scale::Codes if is_color => " as sRGB codes of 0 to 255".into(),
            Scale::Codes => " of 0 to 255".into(),
            Scale::Kelvin => format!(" in kelvin: {} is 0, {} is 1", KELVIN.start(), KELVIN.end()),
            Scale::Fraction if range.largest > 1.0 || range.least < 0.0 => {
                format!(", {} to {}, clamped to 0 to 1", range.least, range.largest)
            }
            Scale::Fraction if is_color => " as linear light".into(),
            Scale::Fraction => String::new(),
        }
    }
}

impl FileFrame {
    /// Converts the values to the scales of [`FileParticle`].
    pub fn decode(mut self, scales: &Scales) -> ParticleFrame {
        let is_stored = |attribute| !self.columns.is_code(attribute);
        let color_is_code = scales.color.scale == Scale::Codes && is_stored(Attribute::Color);
        let amount_is_code = scales.amount.scale == Scale::Codes && is_stored(Attribute::Amount);
        let heat_is_kelvin = scales.heat.scale == Scale::Kelvin && is_stored(Attribute::Heat);
        for particle in self.frame.particles_mut() {
            if color_is_code {
                particle.color = (particle.color / MAX_CODE).map(linear_from_srgb);
            }
            if amount_is_code {
                particle.amount /= MAX_CODE;
            }
            if heat_is_kelvin {
                let heat = (particle.heat - KELVIN.start()) / (KELVIN.end() - KELVIN.start());
                particle.heat = heat.clamp(0.0, 1.0);
            }
        }
        if scales.is_alpha_unset {
            self.frame.unset_amount();
        }
        self.frame
    }

    /// True if the amount is an integer alpha that is full in every particle.
    fn has_full_alpha(&self, scale: Scale) -> bool {
        let is_alpha = plain_name(&self.columns.names(Attribute::Amount)) == "alpha";
        let full = match scale {
            _ if self.columns.is_code(Attribute::Amount) => 1.0,
            Scale::Codes => MAX_CODE,
            _ => return false,
        };
        is_alpha && self.frame.particles().iter().all(|particle| particle.amount >= full)
    }
}

impl ValueRange {
    fn of_frames(frames: &[FileFrame], attribute: Attribute) -> Result<Self, UnknownScale> {
        let mut range = Self { least: 0.0, largest: 0.0, is_whole: true, frame: 0, scale: Scale::Fraction };
        for (index, FileFrame { frame, columns }) in frames.iter().enumerate() {
            if columns.is_code(attribute) {
                continue;
            }
            for particle in frame.particles() {
                range.include(values(particle, attribute), index);
            }
        }
        let name = frames.get(range.frame).map(|frame| frame.columns.names(attribute)).unwrap_or_default();
        range.scale = range.scale(attribute, &name).map_err(|expected| {
            let reason = format!("{name}: the largest value, {}, is not valid; expected {expected}", range.largest);
            UnknownScale { frame: range.frame, reason }
        })?;
        Ok(range)
    }

    fn include(&mut self, values: Vec3, frame: usize) {
        self.least = self.least.min(values.min_element());
        self.is_whole &= values.fract() == Vec3::ZERO;
        if values.max_element() > self.largest {
            self.largest = values.max_element();
            self.frame = frame;
        }
    }

    /// `name`: that of the column. The error says what is expected.
    fn scale(&self, attribute: Attribute, name: &str) -> Result<Scale, &'static str> {
        let is_code = self.largest <= MAX_CODE && self.largest > MAX_FRACTION;
        let is_whole_code = self.largest <= MAX_CODE && self.largest > 1.0 && self.is_whole;
        match attribute {
            Attribute::Color if is_code || is_whole_code => Ok(Scale::Codes),
            Attribute::Amount if is_code => Ok(Scale::Codes),
            Attribute::Heat if self.largest > MIN_KELVIN => Ok(Scale::Kelvin),
            Attribute::Heat if self.largest > MAX_HEAT && plain_name(name) == TEMPERATURE => {
                Err("heat of 0 to 1, or kelvin, above 200; a column of another name is not read")
            }
            _ if self.largest <= MAX_FRACTION => Ok(Scale::Fraction),
            Attribute::Color => Err("linear light of 0 to 1, or sRGB codes of 0 to 255"),
            Attribute::Heat => Err("heat of 0 to 1, or kelvin, above 200"),
            _ => Err("0 to 1, or 0 to 255"),
        }
    }
}

/// Returns the values of an attribute; a single one three times.
fn values(particle: &FileParticle, attribute: Attribute) -> Vec3 {
    match attribute {
        Attribute::Color => particle.color,
        Attribute::Heat => Vec3::splat(particle.heat),
        _ => Vec3::splat(particle.amount),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::csv_reader;
    use super::super::particle_frames::parse;
    use super::*;

    fn first(text: &str) -> Result<FileParticle, String> {
        let frame = parse(Path::new("a.csv"), text.as_bytes(), 9);
        let frame = frame.map_err(|error| error.into_error(Path::new("a.csv")).to_string())?;
        Ok(frame.particles()[0])
    }

    fn color(text: &str) -> Vec3 {
        first(&format!("x,y,z,r,g,b\n{text}")).unwrap().color
    }

    fn ply(properties: &str, values: &str) -> ParticleFrame {
        let position = "property float x\nproperty float y\nproperty float z\n";
        let count = values.lines().count();
        let text = format!("ply\nformat ascii 1.0\nelement vertex {count}\n{position}{properties}end_header\n{values}");
        parse(Path::new("a.ply"), text.as_bytes(), 9).unwrap()
    }

    const RGB: &str = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

    /// 127 of 255 as sRGB, in linear light. (IEC 61966-2-1)
    const CODE_127: f32 = 0.212_231;

    #[test]
    fn integer_colors_are_srgb_codes() {
        let read = |properties: &str, values: &str| ply(properties, values).particles()[0].color;
        assert!(read(RGB, "0 0 0 127 0 255").distance(Vec3::new(CODE_127, 0.0, 1.0)) < 1e-5);
        assert!(
            read(&RGB.replace("uchar", "ushort"), "0 0 0 32639 0 65535").distance(Vec3::new(CODE_127, 0.0, 1.0)) < 1e-5
        );
        assert!(read(&RGB.replace("uchar", "int"), "0 0 0 127 0 255").distance(Vec3::new(CODE_127, 0.0, 1.0)) < 1e-5);
        assert_eq!(read(&RGB.replace("uchar", "float"), "0 0 0 0.25 0 1"), Vec3::new(0.25, 0.0, 1.0));
    }

    #[test]
    fn colors_above_1_are_srgb_codes_if_they_are_whole_or_large() {
        assert!(color("0,0,0,127,0,255").distance(Vec3::new(CODE_127, 0.0, 1.0)) < 1e-5);
        assert!(color("0,0,0,1,1,1\n0,0,0,2,2,2").max_element() < 1e-3);
        assert!(color("0,0,0,127.0,0.5,254.5").distance(Vec3::new(CODE_127, 0.0, 0.996)) < 1e-3);
        assert_eq!(color("0,0,0,0.25,0.5,1"), Vec3::new(0.25, 0.5, 1.0));
        // Light of fire, brighter than white.
        assert_eq!(color("0,0,0,3.5,0.5,1"), Vec3::new(3.5, 0.5, 1.0));
        let refused = first("x,y,z,r,g,b\n0,0,0,300,0,0").unwrap_err();
        assert_eq!(
            refused,
            "a.csv: r, g, b: the largest value, 300, is not valid; expected linear light of 0 to 1, or sRGB codes of 0 to 255"
        );
    }

    #[test]
    fn an_integer_alpha_is_no_amount_if_it_is_full_everywhere() {
        let alpha = "property uchar alpha\n";
        let provides = |properties: &str, values: &str| ply(properties, values).provided().amount;
        assert!(!provides(alpha, "0 0 0 255\n0 0 0 255"));
        assert!(provides(alpha, "0 0 0 255\n0 0 0 254"));
        assert!(provides("property float alpha\n", "0 0 0 1"));
        assert!(provides("property uchar amount\n", "0 0 0 255"));
        let csv = |text: &str| parse(Path::new("a.csv"), text.as_bytes(), 9).unwrap();
        assert!(!csv("x,y,z,alpha\n0,0,0,255\n0,0,0,255").provided().amount);
        let some = csv("x,y,z,alpha\n0,0,0,255\n0,0,0,51");
        assert_eq!((some.provided().amount, some.particles()[1].amount), (true, 0.2));
    }

    #[test]
    fn temperatures_in_kelvin_are_mapped_to_heat() {
        let heat = |text: &str| first(&format!("x,y,z,temperature\n{text}")).map(|particle| particle.heat);
        assert_eq!(heat("0,0,0,1400"), Ok(0.5));
        assert_eq!(heat("0,0,0,293"), Ok(0.0));
        assert_eq!(heat("0,0,0,5000"), Ok(1.0));
        assert_eq!(heat("0,0,0,0.5\n0,0,0,1.0001"), Ok(0.5));
        let expected = "heat of 0 to 1, or kelvin, above 200; a column of another name is not read";
        for (row, largest) in
            [("0,0,0,0.5\n0,0,0,1.5", "1.5"), ("0,0,0,3", "3"), ("0,0,0,20", "20"), ("0,0,0,150", "150")]
        {
            let refused =
                format!("a.csv: temperature: the largest value, {largest}, is not valid; expected {expected}");
            assert_eq!(heat(row), Err(refused));
        }
        // Names that mean nothing but heat.
        let flame = |text: &str| first(&format!("x,y,z,flame\n{text}")).map(|particle| particle.heat);
        assert_eq!(flame("0,0,0,0.5\n0,0,0,1.5"), Ok(0.5));
        assert_eq!(
            flame("0,0,0,20").unwrap_err(),
            "a.csv: flame: the largest value, 20, is not valid; expected heat of 0 to 1, or kelvin, above 200"
        );
    }

    #[test]
    fn all_frames_have_one_scale() {
        let read = |text: &str| csv_reader::read(text.as_bytes(), 9).unwrap();
        let frames = [read("x,y,z,r,g,b,alpha\n0,0,0,1,1,1,255"), read("x,y,z,r,g,b,alpha\n0,0,0,255,0,0,51")];
        let scales = Scales::of_frames(&frames).map_err(|error| error.reason).unwrap();
        let frames = frames.map(|frame| frame.decode(&scales));
        assert!(frames[0].particles()[0].color.max_element() < 1e-3);
        assert_eq!(
            frames.map(|frame| (frame.provided().amount, frame.particles()[0].amount)),
            [(true, 1.0), (true, 0.2)]
        );
    }
}
