//! Reads particles from the vertices of a PLY file and ignores other elements. (Turk, *The PLY Polygon File Format*,
//! 1994)

mod ascii;
mod binary;
mod header;

use super::columns::ColumnMap;
use super::parse_error::ParseError;
use super::particle_frame::ParticleFrame;
use header::{Element, Format, Header, PropertyKind, ScalarType};

/// Reads a file of at most `max_particles` particles.
pub fn read(content: &[u8], max_particles: usize) -> Result<ParticleFrame, ParseError> {
    let header = Header::parse(content)?;
    let Some(at) = header.elements.iter().position(|element| element.name == "vertex") else {
        return Err(ParseError::WholeFile("no element vertex in the header; expected particles as vertices".into()));
    };
    let (before, vertices) = (&header.elements[..at], &header.elements[at]);
    if vertices.count > max_particles {
        let reason = format!("{} vertices; expected at most {max_particles} particles in a frame", vertices.count);
        return Err(ParseError::WholeFile(reason));
    }
    let mut columns = columns(vertices).map_err(ParseError::WholeFile)?;
    for (column, property) in vertices.properties.iter().enumerate() {
        match property.kind {
            PropertyKind::Scalar(ScalarType::U8) => columns.set_unit_value(column, 255.0),
            PropertyKind::Scalar(ScalarType::U16) => columns.set_unit_value(column, 65535.0),
            _ => {}
        }
    }
    let (body, provided) = (&content[header.length..], columns.provided);
    let particles = match header.format {
        Format::Ascii => ascii::read(body, header.lines, before, vertices, &columns)?,
        Format::Binary { is_big_endian } => {
            binary::read(body, header.length, is_big_endian, before, vertices, &columns)?
        }
    };
    ParticleFrame::new(particles, provided).map_err(ParseError::duplicate_id)
}

/// Maps the vertices' properties to columns. List properties get an empty name and thus no role.
fn columns(vertices: &Element) -> Result<ColumnMap, String> {
    let name = |property: &'_ header::Property| match property.kind {
        PropertyKind::Scalar(_) => property.name.clone(),
        PropertyKind::List { .. } => String::new(),
    };
    let names: Vec<_> = vertices.properties.iter().map(name).collect();
    ColumnMap::from_names(&names.iter().map(String::as_str).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests;
