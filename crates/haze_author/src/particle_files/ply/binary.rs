//! Binary PLY files of either byte order.

use super::header::{Element, Kind, Scalar};
use crate::particle_files::columns::{Columns, Values};
use crate::particle_files::frame::FileParticle;
use crate::particle_files::mistake::Mistake;

/// Reads the vertices of the body that follows a header of `start` bytes.
pub fn read(
    body: &[u8],
    start: usize,
    is_big_endian: bool,
    before: &[Element],
    vertices: &Element,
    columns: &Columns,
) -> Result<Vec<FileParticle>, Mistake> {
    let mut reader = Reader { body, at: 0, is_big_endian };
    for element in before {
        if element.has_lists() {
            for row in 0..element.count {
                let passed = element.properties.iter().try_for_each(|property| reader.pass(property.kind));
                passed.ok_or_else(|| ended(element, row, start + reader.at))?;
            }
        } else {
            // Cannot overflow: `Header::parse` checked that the counts fit in the file.
            reader.at += element.count * element.min_bytes();
        }
    }
    let mut particles = Vec::with_capacity(vertices.count);
    for row in 0..vertices.count {
        let mut values = Values::default();
        for (column, property) in vertices.properties.iter().enumerate() {
            let at = start + reader.at;
            match property.kind {
                Kind::One(scalar) if columns.is_read(column) => {
                    let value = reader.scalar(scalar).ok_or_else(|| ended(vertices, row, at))?;
                    let put = columns.put(column, value, &mut values);
                    put.map_err(|reason| Mistake::Whole(format!("vertex {row} at byte {at}: {reason}")))?;
                }
                kind => reader.pass(kind).ok_or_else(|| ended(vertices, row, at))?,
            }
        }
        particles.push(columns.particle(row, &values));
    }
    Ok(particles)
}

fn ended(element: &Element, row: usize, at: usize) -> Mistake {
    let Element { name, count, .. } = element;
    Mistake::Whole(format!("the file ends within {name} {row} at byte {at}; expected {count}, as the header says"))
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

    fn scalar(&mut self, scalar: Scalar) -> Option<f64> {
        /// Reads a number of a type in the file's byte order.
        macro_rules! number {
            ($type:ty) => {{
                let bytes = self.take()?;
                (if self.is_big_endian { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }).into()
            }};
        }
        Some(match scalar {
            Scalar::I8 => number!(i8),
            Scalar::U8 => number!(u8),
            Scalar::I16 => number!(i16),
            Scalar::U16 => number!(u16),
            Scalar::I32 => number!(i32),
            Scalar::U32 => number!(u32),
            Scalar::F32 => number!(f32),
            Scalar::F64 => number!(f64),
        })
    }

    /// Skips a property. Returns `None` if it reaches beyond the end of the file or a list has a negative length.
    fn pass(&mut self, kind: Kind) -> Option<()> {
        let bytes = match kind {
            Kind::One(scalar) => scalar.bytes(),
            Kind::List { count, item } => {
                let count = self.scalar(count).filter(|count| *count >= 0.0)?;
                (count as usize).checked_mul(item.bytes())?
            }
        };
        self.at = self.at.checked_add(bytes).filter(|at| *at <= self.body.len())?;
        Some(())
    }
}
