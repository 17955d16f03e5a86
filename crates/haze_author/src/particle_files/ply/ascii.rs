//! ASCII PLY files: one element per line.

use super::header::{Element, Kind};
use crate::particle_files::columns::{Columns, Values};
use crate::particle_files::csv::text;
use crate::particle_files::frame::FileParticle;
use crate::particle_files::mistake::Mistake;

/// Reads the vertices of the body that follows a header of `lines` lines.
pub fn read(
    body: &[u8],
    lines: usize,
    before: &[Element],
    vertices: &Element,
    columns: &Columns,
) -> Result<Vec<FileParticle>, Mistake> {
    let text = text(body).map_err(|mistake| below(mistake, lines))?;
    let mut lines = (lines + 1..).zip(text.lines()).filter(|(_, line)| !line.trim_ascii().is_empty());
    for element in before.iter().filter(|element| !element.properties.is_empty()) {
        (0..element.count).try_for_each(|row| lines.next().map(|_| ()).ok_or_else(|| ended(element, row)))?;
    }
    let mut particles = Vec::with_capacity(vertices.count);
    for row in 0..vertices.count {
        let (number, line) = lines.next().ok_or_else(|| ended(vertices, row))?;
        let after = |word: &str| &line[..word.as_ptr() as usize - line.as_ptr() as usize];
        let mut words = line.split_ascii_whitespace();
        let short = || {
            let reason = format!("too few numbers; expected one for each of {} properties", columns.len());
            Mistake::after(number, line, reason)
        };
        let mut values = Values::default();
        for (column, property) in vertices.properties.iter().enumerate() {
            let word = words.next().ok_or_else(short)?;
            match property.kind {
                Kind::One(_) if columns.is_read(column) => {
                    let put = columns.parse_and_set(column, word, &mut values);
                    put.map_err(|reason| Mistake::after(number, after(word), reason))?;
                }
                Kind::One(_) => {}
                Kind::List { .. } => {
                    let reason = "the list length is not a whole number; expected 0 or more";
                    let items = word.parse().map_err(|_| Mistake::after(number, after(word), reason))?;
                    (0..items).try_for_each(|_: usize| words.next().map(|_| ()).ok_or_else(short))?;
                }
            }
        }
        if let Some(word) = words.next() {
            let reason = format!("more numbers than the {} properties; expected one for each", columns.len());
            return Err(Mistake::after(number, after(word), reason));
        }
        particles.push(columns.particle(row, &values));
    }
    Ok(particles)
}

fn ended(element: &Element, row: usize) -> Mistake {
    let Element { name, count, .. } = element;
    Mistake::Whole(format!("the file ends after {row} {name} elements; expected {count}, as the header says"))
}

/// Moves an error's line down by `lines`.
fn below(mistake: Mistake, lines: usize) -> Mistake {
    match mistake {
        Mistake::At { line, column, reason } => Mistake::At { line: line + lines, column, reason },
        whole @ Mistake::Whole(_) => whole,
    }
}
