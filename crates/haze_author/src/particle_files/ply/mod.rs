//! Reads particles from the vertices of a PLY file and ignores other elements. (Turk, *The PLY Polygon File Format*,
//! 1994)

mod ascii;
mod binary;
mod header;

use super::columns::{ColumnKind, ColumnMap, DeclaredColumn};
use super::file_frame::FileFrame;
use super::parse_error::ParseError;
use super::particle_frame::ParticleFrame;
use header::{Element, Format, Header, Property, PropertyKind, ScalarType};

/// Reads a file of at most `max_particles` particles.
pub fn read(content: &[u8], max_particles: usize) -> Result<FileFrame, ParseError> {
    let header = Header::parse(content)?;
    let Some(at) = header.elements.iter().position(|element| element.name == "vertex") else {
        return Err(ParseError::WholeFile("no element vertex in the header; expected particles as vertices".into()));
    };
    let before = &header.elements[..at];
    let vertices = &header.elements[at];
    if vertices.count > max_particles {
        let reason = format!("{} vertices; expected at most {max_particles} particles in a frame", vertices.count);
        return Err(ParseError::WholeFile(reason));
    }
    refuse_splat(vertices).map_err(ParseError::WholeFile)?;
    let declared: Vec<_> = vertices.properties.iter().map(declared).collect();
    let columns = ColumnMap::new(&declared).map_err(ParseError::WholeFile)?;
    let body = &content[header.length..];
    let provided = columns.provided;
    let particles = match header.format {
        Format::Ascii => ascii::read(body, header.lines, before, vertices, &columns)?,
        Format::Binary { is_big_endian } => {
            binary::read(body, header.length, is_big_endian, before, vertices, &columns)?
        }
    };
    let frame = ParticleFrame::new(particles, provided).map_err(ParseError::duplicate_id)?;
    Ok(FileFrame { frame, columns })
}

fn declared(property: &Property) -> DeclaredColumn<'_> {
    let kind = match property.kind {
        PropertyKind::Scalar(ScalarType::U8) => ColumnKind::Code(255.0),
        PropertyKind::Scalar(ScalarType::U16) => ColumnKind::Code(65535.0),
        PropertyKind::Scalar(ScalarType::F32 | ScalarType::F64) => ColumnKind::Number,
        PropertyKind::Scalar(_) => ColumnKind::Integer,
        PropertyKind::List { .. } => ColumnKind::List,
    };
    DeclaredColumn { name: &property.name, kind }
}

/// Returns an error for Gaussian splats, whose opacity is a logit and whose scale is a logarithm. (Kerbl et al., *3D
/// Gaussian Splatting*, 2023)
fn refuse_splat(vertices: &Element) -> Result<(), String> {
    let has = |name: &str| vertices.properties.iter().any(|property| property.name == name);
    if has("scale_0") && (has("rot_0") || has("opacity")) {
        return Err("properties scale_0 and opacity or rot_0 are those of a Gaussian splat, with a logarithm and a \
                    logit; expected particles with radius = exp(scale_0) and amount = 1 / (1 + exp(-opacity))"
            .into());
    }
    Ok(())
}

#[cfg(test)]
mod tests;
