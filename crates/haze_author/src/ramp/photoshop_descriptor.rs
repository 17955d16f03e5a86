//! Descriptors of Photoshop: objects of named values, in which it stores its presets. (Adobe, "Photoshop File Formats",
//! descriptor structure; numbers are big-endian)

use std::ops::RangeInclusive;

use haze_core::error::one_line;

/// Version of the format of descriptors.
const VERSION: u32 = 16;
/// Most objects and lists inside each other. A stop's color is at a depth of 6.
const MAX_DEPTH: u32 = 32;

/// An object. Names have no spaces at their ends.
pub struct Descriptor {
    class: String,
    items: Vec<(String, Value)>,
}

/// A value; `Other` for kinds that no gradient needs.
pub enum Value {
    Object(Descriptor),
    List(Vec<Value>),
    Number(f64),
    Text(String),
    Choice(String),
    Other,
}

impl Value {
    pub fn object(&self) -> Option<&Descriptor> {
        match self {
            Self::Object(object) => Some(object),
            _ => None,
        }
    }
}

impl Descriptor {
    /// Returns the name of the object's class.
    pub fn class(&self) -> &str {
        &self.class
    }

    pub fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    fn find(&self, key: &str) -> Option<&Value> {
        self.items.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    pub fn object(&self, key: &str) -> Option<&Self> {
        self.find(key)?.object()
    }

    /// Returns a list; empty if there is none.
    pub fn list(&self, key: &str) -> &[Value] {
        match self.find(key) {
            Some(Value::List(values)) => values,
            _ => &[],
        }
    }

    /// Returns a text; empty if there is none.
    pub fn text(&self, key: &str) -> &str {
        match self.find(key) {
            Some(Value::Text(text)) => text,
            _ => "",
        }
    }

    /// Returns the name of a choice; empty if there is none.
    pub fn choice(&self, key: &str) -> &str {
        match self.find(key) {
            Some(Value::Choice(name)) => name,
            _ => "",
        }
    }

    /// Returns a number.
    ///
    /// # Errors
    /// If it is missing or out of range.
    pub fn number(&self, key: &str, range: RangeInclusive<f32>) -> Result<f32, String> {
        let Some(Value::Number(number)) = self.find(key) else {
            return Err(format!("no number {key:?}; expected {} to {}", range.start(), range.end()));
        };
        let number = *number as f32;
        if range.contains(&number) {
            return Ok(number);
        }
        Err(format!("{key}: {number} is out of range {} to {}", range.start(), range.end()))
    }
}

/// Reads the descriptor of a file, behind its version.
///
/// # Errors
/// For an incomplete file, an unknown version, a kind of value that is not known, and objects too deep inside each other.
pub fn read_descriptor(bytes: &[u8]) -> Result<Descriptor, String> {
    let mut reader = Reader { rest: bytes };
    let version = reader.u32()?;
    if version != VERSION {
        return Err(format!("version {version} of its descriptor; expected version {VERSION}"));
    }
    reader.descriptor(0)
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let missing = "the file is incomplete; expected all of it: export it again, or copy it again";
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(missing)?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        // Never the default: as many bytes are taken.
        Ok(self.take(N)?.try_into().unwrap_or([0; N]))
    }

    fn u32(&mut self) -> Result<u32, String> {
        Ok(u32::from_be_bytes(self.array()?))
    }

    fn f64(&mut self) -> Result<f64, String> {
        Ok(f64::from_be_bytes(self.array()?))
    }

    /// Reads a name: a length and as many bytes; four bytes if the length is 0.
    fn name(&mut self) -> Result<String, String> {
        let length = match self.u32()? {
            0 => 4,
            length => length as usize,
        };
        Ok(String::from_utf8_lossy(self.take(length)?).trim_end().to_owned())
    }

    /// Reads a text of UTF-16, which ends in 0.
    fn text(&mut self) -> Result<String, String> {
        let units = self.u32()? as usize;
        let bytes = self.take(units.saturating_mul(2))?;
        let (pairs, _) = bytes.as_chunks::<2>();
        let units: Vec<_> = pairs.iter().map(|pair| u16::from_be_bytes(*pair)).collect();
        Ok(String::from_utf16_lossy(&units).trim_end_matches('\0').to_owned())
    }

    fn descriptor(&mut self, depth: u32) -> Result<Descriptor, String> {
        // The name that is shown to nobody.
        self.text()?;
        let class = self.name()?;
        let count = self.u32()?;
        let mut items = Vec::new();
        for _ in 0..count {
            items.push((self.name()?, self.value(depth + 1)?));
        }
        Ok(Descriptor { class, items })
    }

    fn value(&mut self, depth: u32) -> Result<Value, String> {
        if depth > MAX_DEPTH {
            return Err(format!("objects are inside each other {depth} times; expected at most {MAX_DEPTH}"));
        }
        let kind: [u8; 4] = self.array()?;
        Ok(match &kind {
            b"Objc" | b"GlbO" => Value::Object(self.descriptor(depth)?),
            b"VlLs" => {
                let count = self.u32()?;
                let mut values = Vec::new();
                for _ in 0..count {
                    values.push(self.value(depth + 1)?);
                }
                Value::List(values)
            }
            b"doub" => Value::Number(self.f64()?),
            b"UntF" => {
                // The unit.
                self.take(4)?;
                Value::Number(self.f64()?)
            }
            b"long" => Value::Number(f64::from(i32::from_be_bytes(self.array()?))),
            b"TEXT" => Value::Text(self.text()?),
            b"enum" => {
                // The kind of choice.
                self.name()?;
                Value::Choice(self.name()?)
            }
            b"bool" => self.skip(1)?,
            b"comp" => self.skip(8)?,
            b"type" | b"GlbC" => {
                self.text()?;
                self.name()?;
                Value::Other
            }
            b"alis" | b"tdta" | b"Pth " => {
                let length = self.u32()? as usize;
                self.skip(length)?
            }
            other => {
                let other = one_line(String::from_utf8_lossy(other));
                return Err(format!(
                    "a value of the unknown kind {other}; expected a file that Photoshop has exported"
                ));
            }
        })
    }

    fn skip(&mut self, count: usize) -> Result<Value, String> {
        self.take(count)?;
        Ok(Value::Other)
    }
}
