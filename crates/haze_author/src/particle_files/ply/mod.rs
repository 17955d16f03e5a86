//! Reads particles from the vertices of a PLY file and ignores other elements. (Turk, *The PLY Polygon File Format*,
//! 1994)

mod ascii;
mod binary;
mod header;

use super::columns::Columns;
use super::frame::ParticleFrame;
use super::mistake::Mistake;
use header::{Element, Format, Header, Kind, Scalar};

/// Reads a file of at most `most` particles.
pub fn read(content: &[u8], most: usize) -> Result<ParticleFrame, Mistake> {
    let header = Header::parse(content)?;
    let Some(at) = header.elements.iter().position(|element| element.name == "vertex") else {
        return Err(Mistake::Whole("no element vertex in the header; expected particles as vertices".into()));
    };
    let (before, vertices) = (&header.elements[..at], &header.elements[at]);
    if vertices.count > most {
        let reason = format!("{} vertices; expected at most {most} particles in a frame", vertices.count);
        return Err(Mistake::Whole(reason));
    }
    let mut columns = columns(vertices).map_err(Mistake::Whole)?;
    for (column, property) in vertices.properties.iter().enumerate() {
        match property.kind {
            Kind::One(Scalar::U8) => columns.set_amount_unit_value(column, 255.0),
            Kind::One(Scalar::U16) => columns.set_amount_unit_value(column, 65535.0),
            _ => {}
        }
    }
    let (body, given) = (&content[header.length..], columns.given);
    let particles = match header.format {
        Format::Ascii => ascii::read(body, header.lines, before, vertices, &columns)?,
        Format::Binary { is_big_endian } => {
            binary::read(body, header.length, is_big_endian, before, vertices, &columns)?
        }
    };
    ParticleFrame::new(particles, given).map_err(Mistake::twice)
}

/// Maps the vertices' properties to columns. List properties get an empty name and thus no role.
fn columns(vertices: &Element) -> Result<Columns, String> {
    let name = |property: &'_ header::Property| match property.kind {
        Kind::One(_) => property.name.clone(),
        Kind::List { .. } => String::new(),
    };
    let names: Vec<_> = vertices.properties.iter().map(name).collect();
    Columns::of(&names.iter().map(String::as_str).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests;
