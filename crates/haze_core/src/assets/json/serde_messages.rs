//! Translates serde's error messages into words that need no knowledge of Rust.

use crate::error::one_line;

/// Messages of serde_json about syntax, and their replacements.
const SYNTAX: &[(&str, &str)] = &[
    ("EOF while parsing a list", "the file ends inside a list; expected `]`"),
    ("EOF while parsing an object", "the file ends inside an object; expected `}`"),
    ("EOF while parsing a string", "the file ends inside a text; expected `\"`"),
    ("EOF while parsing a value", "the file ends where a value should be"),
    ("expected `:`", "expected `:` between a name and its value"),
    ("expected `,` or `]`", "expected `,` or `]` after an entry of a list"),
    ("expected `,` or `}`", "expected `,` or `}` after a field"),
    ("expected ident", "not a value; expected true, false, null, or a text in double quotes"),
    ("expected value", "not a value; expected a number, a text in double quotes, a list or an object"),
    ("key must be a string", "expected a field's name in double quotes"),
    ("trailing comma", "a comma before the closing bracket; expected none"),
    ("trailing characters", "more text after the end; expected nothing"),
    ("invalid number", "malformed number; expected digits, for example 0.5"),
    ("number out of range", "number too large; expected at most 1.8e308"),
    ("invalid escape", "an unknown escape in a text; expected for example \\n, \\\" or \\\\"),
    ("invalid unicode code point", "malformed escape in a text; expected \\u and four hexadecimal digits"),
    ("lone leading surrogate in hex escape", "malformed escape in a text; expected \\u and four hexadecimal digits"),
    ("unexpected end of hex escape", "malformed escape in a text; expected \\u and four hexadecimal digits"),
    (
        "control character (\\u0000-\\u001F) found while parsing a string",
        "a line break, tab or control character in a text; expected an escape, for example \\n",
    ),
];

/// Type names in serde's "expected …", and their replacements.
const EXPECTED: &[(&str, &str)] = &[
    ("f32", "a number"),
    ("u32", "a whole number, 0 to 4294967295"),
    ("a string", "a text in double quotes"),
    ("a boolean", "true or false"),
    ("a sequence", "a list"),
    ("a sequence of 3 f32 values", "a list of 3 numbers"),
    ("index into child of root", "an index, 0 or more"),
];

/// Translates `message`, serde_json's error without its position, for the field at `path` ("" for the whole file).
/// `rest` is the text from the position of the error on.
pub fn translate(message: &str, path: &str, rest: &str) -> String {
    let said = match message {
        // A valid value of another type: serde_json reports it as a syntax error where an enum name is expected.
        "expected value" if rest.starts_with(|c: char| c.is_ascii_digit() || "-[tfn".contains(c)) => {
            "not a text; expected a name in double quotes".to_owned()
        }
        "trailing characters" if !path.is_empty() => "too many entries; expected the list to end here".to_owned(),
        _ => lookup(SYNTAX, message)
            .map(str::to_owned)
            .or_else(|| translate_mismatch(message))
            .unwrap_or_else(|| one_line(message)),
    };
    if path.is_empty() { said } else { format!("{}: {said}", one_line(path)) }
}

/// Translates errors about unknown fields, unknown names and values of the wrong type; `None` for other messages.
fn translate_mismatch(message: &str) -> Option<String> {
    if let Some(field) = message.strip_prefix("unknown field `") {
        let (field, expected) = field.rsplit_once("`, expected ")?;
        return Some(format!("unknown field `{}`; expected {expected}", one_line(field)));
    }
    let (kind, rest) = ["unknown variant ", "invalid type: ", "invalid value: ", "invalid length "]
        .iter()
        .find_map(|kind| Some((*kind, message.strip_prefix(kind)?)))?;
    let (found, expected) = rest.rsplit_once(", expected ")?;
    let found = match found {
        "map" => "an object".to_owned(),
        "sequence" => "a list".to_owned(),
        _ if kind == "invalid length " => format!("a list of {found}"),
        _ if kind == "unknown variant " => one_line(format!("{:?}", found.trim_matches('`'))),
        // serde puts the type before the value: string "x", integer `1`.
        _ => match found.find(['"', '`']) {
            Some(at) => one_line(found[at..].trim_matches('`')),
            None => one_line(found),
        },
    };
    let expected = match lookup(EXPECTED, expected) {
        Some(expected) => expected.to_owned(),
        None if expected.starts_with("struct ") => "an object".to_owned(),
        None => expected.replace('`', ""),
    };
    Some(format!("{found} is not valid; expected {expected}"))
}

fn lookup(table: &[(&str, &'static str)], said: &str) -> Option<&'static str> {
    table.iter().find(|(serde, _)| *serde == said).map(|(_, plain)| *plain)
}
