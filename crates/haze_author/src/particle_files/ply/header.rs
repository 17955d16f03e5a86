//! Header of a PLY file.

use haze_core::error::one_line;

use crate::particle_files::columns::MAX_COLUMNS;
use crate::particle_files::parse_error::ParseError;

/// Size limit of the header, bytes.
const MAX_HEADER_BYTES: usize = 1 << 16;

pub struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
    /// Length of the header in bytes, and in lines below.
    pub length: usize,
    pub lines: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Ascii,
    Binary {
        /// True for big-endian.
        is_big_endian: bool,
    },
}

/// An element declaration: a list of records with the same properties.
pub struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

pub struct Property {
    pub name: String,
    pub kind: PropertyKind,
}

#[derive(Clone, Copy)]
pub enum PropertyKind {
    Scalar(ScalarType),
    List { count: ScalarType, item: ScalarType },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl ScalarType {
    fn of(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => {
                let types = "char, uchar, short, ushort, int, uint, float, double, or int8 to float64";
                return Err(format!("type {:?} is not known; expected one of {types}", one_line(name)));
            }
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Element {
    /// Returns the minimum size of one record in a binary file, bytes: lists may be empty.
    pub fn min_bytes(&self) -> usize {
        let bytes = |property: &Property| match property.kind {
            PropertyKind::Scalar(scalar) => scalar.bytes(),
            PropertyKind::List { count, .. } => count.bytes(),
        };
        self.properties.iter().map(bytes).sum()
    }

    pub fn has_lists(&self) -> bool {
        self.properties.iter().any(|property| matches!(property.kind, PropertyKind::List { .. }))
    }
}

impl Header {
    /// Parses the header and checks that the declared counts fit in the file.
    pub fn parse(content: &[u8]) -> Result<Self, ParseError> {
        let mut format = None;
        let mut elements = Vec::<Element>::new();
        let mut length = 0;
        let mut properties = 0;
        for number in 1.. {
            let rest = &content[length..content.len().min(MAX_HEADER_BYTES)];
            let Some(end) = rest.iter().position(|byte| *byte == b'\n') else {
                let reason = format!("no end_header in the first {MAX_HEADER_BYTES} bytes; expected a PLY file");
                return Err(ParseError::WholeFile(reason));
            };
            length += end + 1;
            let line = String::from_utf8_lossy(&rest[..end]);
            let refuse = |reason: String| ParseError::after_text(number, "", reason);
            let words: Vec<_> = line.split_ascii_whitespace().collect();
            match words[..] {
                ["ply"] if number == 1 => {}
                _ if number == 1 => return Err(refuse("not a PLY file; expected \"ply\"".into())),
                ["comment" | "obj_info", ..] | [] => {}
                ["format", name, "1.0"] => format = Some(parse_format(name).map_err(refuse)?),
                ["element", name, count] => {
                    let refused = || refuse(format!("{:?} is not a count; expected a whole number", one_line(count)));
                    let count = count.parse().map_err(|_| refused())?;
                    elements.push(Element { name: one_line(name), count, properties: Vec::new() });
                }
                ["property", ref words @ ..] => {
                    let Some(element) = elements.last_mut() else {
                        return Err(refuse("property before any element; expected an element line first".into()));
                    };
                    properties += 1;
                    if properties > MAX_COLUMNS {
                        return Err(refuse(format!(
                            "more than {MAX_COLUMNS} properties; expected at most {MAX_COLUMNS}"
                        )));
                    }
                    element.properties.push(parse_property(words).map_err(refuse)?);
                }
                ["end_header"] => {
                    let format = format.ok_or_else(|| {
                        refuse("no format line in the header; expected for example \"format ascii 1.0\"".into())
                    })?;
                    let header = Self { format, elements, length, lines: number };
                    return header.check_counts(content.len() - length).map(|()| header);
                }
                _ => {
                    let expected = "format, element, property, comment, obj_info or end_header";
                    return Err(refuse(format!("{:?} is not known; expected {expected}", one_line(line.trim()))));
                }
            }
        }
        Err(ParseError::WholeFile("no end_header; expected a PLY file".into()))
    }

    /// Returns an error if the counts need more than the `left` bytes of the file, before memory is allocated for them.
    fn check_counts(&self, left: usize) -> Result<(), ParseError> {
        let mut needed = 0_usize;
        for element in &self.elements {
            let least = match self.format {
                Format::Binary { .. } => element.min_bytes(),
                // A digit and a separator.
                Format::Ascii => 2 * element.properties.len(),
            };
            needed = needed.saturating_add(element.count.saturating_mul(least));
            // The last number of a text file needs no separator.
            if needed > left.saturating_add(1) || needed > left && self.format != Format::Ascii {
                let Element { name, count, .. } = element;
                let reason = format!(
                    "{count} {name} elements of at least {least} bytes each do not fit in the {left} bytes after the header; \
                     expected the complete file"
                );
                return Err(ParseError::WholeFile(reason));
            }
        }
        Ok(())
    }
}

fn parse_format(name: &str) -> Result<Format, String> {
    match name {
        "ascii" => Ok(Format::Ascii),
        "binary_little_endian" => Ok(Format::Binary { is_big_endian: false }),
        "binary_big_endian" => Ok(Format::Binary { is_big_endian: true }),
        _ => {
            let expected = "ascii, binary_little_endian or binary_big_endian";
            Err(format!("format {:?} is not known; expected {expected}", one_line(name)))
        }
    }
}

fn parse_property(words: &[&str]) -> Result<Property, String> {
    let (name, kind) = match *words {
        ["list", count, item, name] => {
            (name, PropertyKind::List { count: ScalarType::of(count)?, item: ScalarType::of(item)? })
        }
        [scalar, name] => (name, PropertyKind::Scalar(ScalarType::of(scalar)?)),
        _ => return Err("malformed property; expected for example \"property float x\"".into()),
    };
    if let PropertyKind::List { count: ScalarType::F32 | ScalarType::F64, .. } = kind {
        return Err(format!("the length of list {:?} has a float type; expected an integer type", one_line(name)));
    }
    Ok(Property { name: name.into(), kind })
}
