//! Binary PLY files of either byte order.

use super::header::{Element, PropertyKind, ScalarType};
use crate::particle_files::columns::{ColumnMap, RowValues};
use crate::particle_files::parse_error::ParseError;
use crate::particle_files::particle_frame::FileParticle;

/// Reads the vertices of the body that follows a header of `start` bytes.
pub fn read(
    body: &[u8],
    start: usize,
    is_big_endian: bool,
    before: &[Element],
    vertices: &Element,
    columns: &ColumnMap,
) -> Result<Vec<FileParticle>, ParseError> {
    let mut reader = Reader { body, at: 0, is_big_endian };
    for element in before {
        if element.has_lists() {
            for row in 0..element.count {
                let skipped = element.properties.iter().try_for_each(|property| reader.skip(property.kind));
                skipped.ok_or_else(|| truncated(element, row, start + reader.at))?;
            }
        } else {
            // Cannot overflow: `Header::parse` checked that the counts fit in the file.
            reader.at += element.count * element.min_bytes();
        }
    }
    let mut particles = Vec::with_capacity(vertices.count);
    for row in 0..vertices.count {
        let mut values = RowValues::default();
        for (column, property) in vertices.properties.iter().enumerate() {
            let at = start + reader.at;
            match property.kind {
                PropertyKind::Scalar(scalar) if columns.is_read(column) => {
                    let value = reader.scalar(scalar).ok_or_else(|| truncated(vertices, row, at))?;
                    let result = columns.set(column, value, &mut values);
                    result.map_err(|reason| ParseError::WholeFile(format!("vertex {row} at byte {at}: {reason}")))?;
                }
                kind => reader.skip(kind).ok_or_else(|| truncated(vertices, row, at))?,
            }
        }
        particles.push(columns.particle(row, &values));
    }
    Ok(particles)
}

fn truncated(element: &Element, row: usize, at: usize) -> ParseError {
    let Element { name, count, .. } = element;
    ParseError::WholeFile(format!(
        "the file ends within {name} {row} at byte {at}; expected {count}, as the header says"
    ))
}

struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    is_big_endian: bool,
}

impl Reader<'_> {
    /// Returns the next `N` bytes, or `None` at the end of the file.
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let bytes = *self.body.get(self.at..)?.first_chunk::<N>()?;
        self.at += N;
        Some(bytes)
    }

    fn scalar(&mut self, scalar: ScalarType) -> Option<f64> {
        /// Reads a number of a type in the file's byte order.
        macro_rules! number {
            ($type:ty) => {{
                let bytes = self.take()?;
                (if self.is_big_endian { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }).into()
            }};
        }
        Some(match scalar {
            ScalarType::I8 => number!(i8),
            ScalarType::U8 => number!(u8),
            ScalarType::I16 => number!(i16),
            ScalarType::U16 => number!(u16),
            ScalarType::I32 => number!(i32),
            ScalarType::U32 => number!(u32),
            ScalarType::F32 => number!(f32),
            ScalarType::F64 => number!(f64),
        })
    }

    /// Skips a property. Returns `None` if it reaches beyond the end of the file or a list has a negative length.
    fn skip(&mut self, kind: PropertyKind) -> Option<()> {
        let bytes = match kind {
            PropertyKind::Scalar(scalar) => scalar.bytes(),
            PropertyKind::List { count, item } => {
                let count = self.scalar(count).filter(|count| *count >= 0.0)?;
                (count as usize).checked_mul(item.bytes())?
            }
        };
        self.at = self.at.checked_add(bytes).filter(|at| *at <= self.body.len())?;
        Some(())
    }
}
