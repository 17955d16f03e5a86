//! ASCII PLY files: one element per line.

use super::header::{Element, PropertyKind};
use crate::particle_files::columns::{ColumnMap, RowValues};
use crate::particle_files::csv_reader::decode_utf8;
use crate::particle_files::parse_error::ParseError;
use crate::particle_files::particle_frame::FileParticle;

/// Reads the vertices of the body that follows a header of `lines` lines.
pub fn read(
    body: &[u8],
    lines: usize,
    before: &[Element],
    vertices: &Element,
    columns: &ColumnMap,
) -> Result<Vec<FileParticle>, ParseError> {
    let text = decode_utf8(body).map_err(|error| shift_lines(error, lines))?;
    let mut lines = (lines + 1..).zip(text.lines()).filter(|(_, line)| !line.trim_ascii().is_empty());
    for element in before.iter().filter(|element| !element.properties.is_empty()) {
        (0..element.count).try_for_each(|row| lines.next().map(|_| ()).ok_or_else(|| truncated(element, row)))?;
    }
    let mut particles = Vec::with_capacity(vertices.count);
    for row in 0..vertices.count {
        let (number, line) = lines.next().ok_or_else(|| truncated(vertices, row))?;
        let after = |word: &str| &line[..word.as_ptr() as usize - line.as_ptr() as usize];
        let mut words = line.split_ascii_whitespace();
        let short = || {
            let reason = format!("too few numbers; expected one for each of {} properties", columns.len());
            ParseError::after_text(number, line, reason)
        };
        let mut values = RowValues::default();
        for (column, property) in vertices.properties.iter().enumerate() {
            let word = words.next().ok_or_else(short)?;
            match property.kind {
                PropertyKind::Scalar(_) if columns.is_read(column) => {
                    let result = columns.parse_and_set(column, word, &mut values);
                    result.map_err(|reason| ParseError::after_text(number, after(word), reason))?;
                }
                PropertyKind::Scalar(_) => {}
                PropertyKind::List { .. } => {
                    let reason = "the list length is not a whole number; expected 0 or more";
                    let items = word.parse().map_err(|_| ParseError::after_text(number, after(word), reason))?;
                    (0..items).try_for_each(|_: usize| words.next().map(|_| ()).ok_or_else(short))?;
                }
            }
        }
        if let Some(word) = words.next() {
            let reason = format!("more numbers than the {} properties; expected one for each", columns.len());
            return Err(ParseError::after_text(number, after(word), reason));
        }
        particles.push(columns.particle(row, &values));
    }
    Ok(particles)
}

fn truncated(element: &Element, row: usize) -> ParseError {
    let Element { name, count, .. } = element;
    ParseError::WholeFile(format!("the file ends after {row} {name} elements; expected {count}, as the header says"))
}

/// Moves an error's line down by `lines`.
fn shift_lines(error: ParseError, lines: usize) -> ParseError {
    match error {
        ParseError::At { line, column, reason } => ParseError::At { line: line + lines, column, reason },
        whole @ ParseError::WholeFile(_) => whole,
    }
}
