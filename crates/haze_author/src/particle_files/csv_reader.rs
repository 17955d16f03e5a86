//! Reads particles from CSV: a line of column names, then one line per particle. The separator is the comma, semicolon
//! or tab, whichever the names contain most often, or white space if they contain none. Cells may be quoted. Lines that
//! begin with `#` or `//` are comments; if the first other line has numbers, the last comment with column names
//! names the columns, as NumPy and CloudCompare write them.
//!
//! The `csv` crate does not fit: it has no line comments of two characters, gives no column of an error, and accepts
//! text after a closing quote and unclosed quotes, which are errors here.

use std::borrow::Cow;
use std::collections::VecDeque;

use super::columns::{ColumnMap, MAX_COLUMNS, RowValues};
use super::file_frame::FileFrame;
use super::parse_error::ParseError;
use super::particle_frame::ParticleFrame;

/// The line of column names.
struct Header {
    line: usize,
    separator: char,
    columns: ColumnMap,
}

/// Number of comments above the first particle among which column names are looked for.
const MAX_COMMENTS: usize = 64;

const EXPECTED_NAMES: &str = "a line of column names, such as x,y,z,pscale,id";

/// Reads a file of at most `max_particles` particles.
pub fn read(content: &[u8], max_particles: usize) -> Result<FileFrame, ParseError> {
    let text = decode_utf8(content)?.trim_start_matches('\u{feff}');
    let Header { line, separator, columns } = Header::of_file(text)?;
    let rows = (1..).zip(text.lines()).skip(line).filter(|(_, line)| is_data_line(line));
    let mut particles = Vec::new();
    for (line, text) in rows {
        if particles.len() == max_particles {
            return Err(ParseError::too_many_particles(line, max_particles));
        }
        let mut values = RowValues::default();
        let mut count = 0;
        for (start, cell) in Cells::new(text, separator) {
            let at = |reason| ParseError::after_text(line, &text[..start], reason);
            let cell = cell.map_err(|reason| at(reason.into()))?;
            if columns.is_read(count) {
                columns.parse_and_set(count, &cell, &mut values).map_err(at)?;
            } else if count >= columns.len() && !cell.trim().is_empty() {
                let reason = format!("more cells than the {} named columns; expected one for each", columns.len());
                return Err(at(reason));
            }
            count += 1;
        }
        if count < columns.len() {
            let reason = format!("{count} cells; expected {}, one for each column", columns.len());
            return Err(ParseError::after_text(line, text, reason));
        }
        particles.push(columns.particle(particles.len(), &values));
    }
    let frame = ParticleFrame::new(particles, columns.provided).map_err(ParseError::duplicate_id)?;
    Ok(FileFrame { frame, columns })
}

impl Header {
    /// Finds the column names: the first line that is no comment, or a comment if that line has numbers.
    fn of_file(text: &str) -> Result<Self, ParseError> {
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim_start().is_empty());
        let mut comments = VecDeque::new();
        let first = loop {
            match lines.next() {
                Some(line) if is_data_line(line.1) => break Some(line),
                Some(line) => comments.push_back(line),
                None => break None,
            }
            if comments.len() > MAX_COMMENTS {
                comments.pop_front();
            }
        };
        if let Some(names) = first.filter(|(_, line)| !has_number(line)) {
            return Self::parse(names.0, names.1);
        }
        let last_names = comments.into_iter().rev().find_map(|(line, text)| Self::parse(line, text).ok());
        match (last_names, first) {
            (Some(header), _) => Ok(header),
            (None, Some((line, text))) => Self::parse(line, text),
            (None, None) => Err(ParseError::WholeFile(format!("no line of column names; expected {EXPECTED_NAMES}"))),
        }
    }

    /// `line`: its number from 1.
    fn parse(line: usize, text: &str) -> Result<Self, ParseError> {
        let names = text.trim_start_matches(['#', '/', ' ']);
        let before = text.len() - names.len();
        let separator = separator(names);
        let mut cells = Vec::new();
        for (start, cell) in Cells::new(names, separator) {
            if cells.len() == MAX_COLUMNS {
                let reason = format!("more than {MAX_COLUMNS} columns; expected {EXPECTED_NAMES}");
                return Err(ParseError::after_text(line, "", reason));
            }
            cells.push(cell.map_err(|reason| ParseError::after_text(line, &text[..before + start], reason))?);
        }
        let names: Vec<_> = cells.iter().map(AsRef::as_ref).collect();
        let columns = ColumnMap::from_names(&names).map_err(|reason| ParseError::after_text(line, "", reason))?;
        Ok(Self { line, separator, columns })
    }
}

/// Decodes a file as UTF-8.
pub fn decode_utf8(content: &[u8]) -> Result<&str, ParseError> {
    std::str::from_utf8(content).map_err(|error| {
        let before = &content[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        ParseError::after_text(line, "", "not UTF-8; expected UTF-8 text")
    })
}

fn is_data_line(line: &str) -> bool {
    let line = line.trim_start();
    !line.is_empty() && !line.starts_with('#') && !line.starts_with("//")
}

/// True if a cell is a number: the line is a particle then, not names.
fn has_number(line: &str) -> bool {
    let is_number = |cell: &str| cell.trim_matches(['"', ' ']).parse::<f64>().is_ok();
    line.split([',', ';', '\t', ' ']).any(is_number)
}

/// Returns the separator: the candidate that occurs most often outside quotes in the line of names.
fn separator(names: &str) -> char {
    let count =
        |separator: char| names.split('"').step_by(2).map(|part| part.matches(separator).count()).sum::<usize>();
    // `max_by_key` returns the last maximum, so the comma wins a tie.
    let most = [';', '\t', ','].into_iter().max_by_key(|separator| count(*separator)).unwrap_or(',');
    if count(most) == 0 { ' ' } else { most }
}

/// Iterates over the cells of a line as (start in bytes, cell).
struct Cells<'a> {
    line: &'a str,
    /// Start of the next cell, bytes; `None` at the end.
    at: Option<usize>,
    separator: char,
}

impl<'a> Cells<'a> {
    fn new(line: &'a str, separator: char) -> Self {
        let mut cells = Self { line, at: None, separator };
        cells.at = cells.start_after(0);
        cells
    }

    /// Returns the start of the cell at a position or after it: several spaces are one separator.
    fn start_after(&self, at: usize) -> Option<usize> {
        if self.separator != ' ' {
            return Some(at);
        }
        let cells = self.line[at..].trim_start_matches(' ');
        (!cells.is_empty()).then(|| self.line.len() - cells.len())
    }
}

impl<'a> Iterator for Cells<'a> {
    type Item = (usize, Result<Cow<'a, str>, &'static str>);

    fn next(&mut self) -> Option<Self::Item> {
        let start = self.at.take()?;
        let rest = &self.line[start..];
        let Some(quoted) = rest.trim_start_matches(' ').strip_prefix('"') else {
            let cell = rest.split(self.separator).next().unwrap_or_default();
            if cell.len() < rest.len() {
                self.at = self.start_after(start + cell.len() + 1);
            }
            return Some((start, Ok(cell.into())));
        };
        // A quote ends the cell; a doubled quote is an escaped quote.
        let mut quotes = quoted.match_indices('"').map(|(at, _)| at);
        let mut is_doubled = false;
        let end_of_quote = loop {
            match quotes.next() {
                None => return Some((start, Err("unclosed quote; expected a closing quote on this line"))),
                Some(at) if quoted[at + 1..].starts_with('"') => {
                    quotes.next();
                    is_doubled = true;
                }
                Some(at) => break at,
            }
        };
        let after = quoted[end_of_quote + 1..].trim_start_matches(' ');
        if !after.is_empty() {
            let end = self.line.len() - after.len();
            if self.separator == ' ' && quoted[end_of_quote + 1..].starts_with(' ') {
                self.at = Some(end);
            } else if after.starts_with(self.separator) {
                self.at = Some(end + 1);
            } else {
                return Some((start, Err("text after a closing quote; expected the end of the cell")));
            }
        }
        let cell = &quoted[..end_of_quote];
        Some((start, Ok(if is_doubled { cell.replace("\"\"", "\"").into() } else { cell.into() })))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn read_bytes(content: &[u8]) -> Result<ParticleFrame, ParseError> {
        super::read(content, 4).map(|read| read.frame)
    }

    fn read(text: &str) -> Result<ParticleFrame, ParseError> {
        read_bytes(text.as_bytes())
    }

    #[test]
    fn separators_quotes_comments_and_line_ends() {
        let plain = read("x,y,z,radius\n1,2,3,0.5\n-1e1,0,0.25,0\n").unwrap();
        assert_eq!(plain.particles()[0].position, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(plain.particles()[1].position, Vec3::new(-10.0, 0.0, 0.25));
        for same in [
            "\u{feff}X;Y;Z;Radius\r\n1;2;3;.5\r\n-10;0;0.25;0",
            "# from a simulation, of 2\n\nx\ty\tz\tradius\n1\t2\t3\t0.5\n// the next\n-10\t0\t0.25\t0\n",
            "\"P[x]\", \"P[y]\" ,\"P[z]\",radius\n \"1\" ,2,3, 0.5\n-10,0,0.25,0,\n",
            "x,y,z,\"say \"\"a\"\", b\",radius\n1,2,3,words,0.5\n-10,0,.25,\"a \"\",\"\" b\",0\n",
        ] {
            assert_eq!(read(same).as_ref(), Ok(&plain), "{same}");
        }
        assert_eq!(read("x,y,z\n").unwrap().particles(), []);
    }

    #[test]
    fn column_names_may_be_in_a_comment_and_separated_by_spaces() {
        let plain = read("x,y,z,radius\n1,2,3,0.5\n-10,0,0.25,0").unwrap();
        for same in [
            "# x,y,z,radius\n1,2,3,0.5\n-10,0,0.25,0",
            "#x;y;z;radius\n\n1;2;3;0.5\n# no names\n-10;0;0.25;0",
            "# of x,y,z\n# x y z radius\n# in metres\n1.0e+00 2 3 0.5\n  -10  0 0.25   0 \n",
            "//X Y Z Radius\n1 2 3 0.5\n-10 0 0.25 0",
            "x y  \"z\" radius\n\"1\" 2 3 \"0.5\"\n-10 0 0.25 0",
            "# y,x,z,radius\nx,y,z,radius\n1,2,3,0.5\n-10,0,0.25,0",
        ] {
            assert_eq!(read(same).as_ref(), Ok(&plain), "{same}");
        }
        assert_eq!(read("# x,y,z,name\n1,2,3,smoke").unwrap().particles()[0].position, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(read("# x,y,z\n").unwrap().particles(), []);
        let at = |line, column, reason: &str| Err(ParseError::At { line, column, reason: reason.into() });
        assert_eq!(read("# x,y,z\n1,2,3\n1,a,3"), at(3, 3, "y: \"a\" is not valid; expected a number"));
        assert_eq!(read("x y z\n1  2"), at(2, 5, "2 cells; expected 3, one for each column"));
        assert_eq!(read("x y z\n1 \"2\"3 3"), at(2, 3, "text after a closing quote; expected the end of the cell"));
        let without = read("# a simulation\n1,2,3").unwrap_err();
        assert!(matches!(without, ParseError::At { line: 2, reason, .. } if reason.starts_with("no column for the x")));
    }

    #[test]
    fn errors_name_line_and_column() {
        let at = |line, column, reason: &str| Err(ParseError::At { line, column, reason: reason.into() });
        assert_eq!(read("x,y,z\n1,2,3\n\n1,nan,3"), at(4, 3, "y: NaN is not valid; expected a number up to 1e9"));
        assert_eq!(read("x,y,z\n1,2"), at(2, 4, "2 cells; expected 3, one for each column"));
        assert_eq!(read("ä,x,y,z\nü,1,,3"), at(2, 5, "y: \"\" is not valid; expected a number"));
        assert_eq!(read("x,y,z\n1,2,3,4"), at(2, 7, "more cells than the 3 named columns; expected one for each"));
        assert_eq!(read("x,y,\"z\n1,2,3"), at(1, 5, "unclosed quote; expected a closing quote on this line"));
        assert_eq!(read("x,y,z\n1,\"2\"3,3"), at(2, 3, "text after a closing quote; expected the end of the cell"));
        assert_eq!(
            read(&format!("x,y,z\n{}", "1,2,3\n".repeat(5))),
            at(6, 1, "more than 4 particles in a frame; expected at most 4")
        );
        assert_eq!(read_bytes(b"x,y,z\n1,2,\xff"), at(2, 1, "not UTF-8; expected UTF-8 text"));
        let twice = "id 7 is used twice; expected unique ids within a frame, or no id column";
        assert_eq!(read("x,y,z,id\n1,2,3,7\n1,2,3,8\n1,2,3,7"), Err(ParseError::WholeFile(twice.into())));
        for (text, reason) in [("", "no line of column names"), ("# x,y", "no line of column names")] {
            assert!(matches!(read(text), Err(ParseError::WholeFile(said)) if said.starts_with(reason)), "{text}");
        }
        let wide = read(&"x,".repeat(2000)).unwrap_err();
        assert!(matches!(wide, ParseError::At { reason, .. } if reason.starts_with("more than 1024 columns")));
    }
}
