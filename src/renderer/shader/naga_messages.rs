//! Conversion of naga's error messages to WGSL terms. naga prints an excerpt of the source and refers to expressions by
//! number.

/// naga's names of types, and the names in WGSL.
const TYPES: &[(&str, &str)] = &[
    ("Scalar { kind: Float, width: 4 }", "f32"),
    ("Scalar { kind: Sint, width: 4 }", "i32"),
    ("Scalar { kind: Uint, width: 4 }", "u32"),
    ("Scalar { kind: Bool, width: 1 }", "bool"),
    ("Vector { size: Bi, scalar: ", "vec2<"),
    ("Vector { size: Tri, scalar: ", "vec3<"),
    ("Vector { size: Quad, scalar: ", "vec4<"),
    ("f32 }", "f32>"),
    ("i32 }", "i32>"),
    ("u32 }", "u32>"),
    ("bool }", "bool>"),
    ("Scalar(f32)", "f32"),
    ("Scalar(i32)", "i32"),
    ("Scalar(u32)", "u32"),
    ("Scalar(bool)", "bool"),
];

/// Returns the message without the source excerpt: the text behind "error: ", followed by the notes below the excerpt,
/// each closer to the cause.
pub(super) fn to_wgsl_terms(message: &str) -> String {
    let mut lines = message.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or_default();
    let said = first.split_once("error: ").map_or(first, |(_, said)| said);
    let notes = lines.filter_map(|line| line.strip_prefix("= ")).map(|note| note.trim_start_matches("note: "));
    let parts = std::iter::once(said).chain(notes).map(strip_handles);
    parts.filter(|part| part != "Expression is invalid").collect::<Vec<_>>().join(": ")
}

fn strip_handles(said: &str) -> String {
    let said = TYPES.iter().fold(said.to_owned(), |said, (naga, wgsl)| said.replace(naga, wgsl));
    let said = said.replace("(of type ", "\u{1} ");
    let mut words: Vec<&str> = Vec::new();
    let mut typed = false;
    for word in said.split(' ') {
        let returned = word.strip_prefix("Some(").and_then(|rest| rest.strip_suffix(')'));
        let number = returned.unwrap_or(word).strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        if word == "\u{1}" {
            // The type alone identifies the operand.
            words.pop_if(|before| *before == "this");
            typed = true;
        } else if number.is_some_and(|digits| digits.parse::<u32>().is_ok()) {
            // "Function [3] 'name'" has a name; "the `return` expression Some([3])" is the one that the excerpt marks.
            let is_named = words.last().is_some_and(|before| before.starts_with(char::is_uppercase));
            words.extend((returned.is_none() && !is_named).then_some("this"));
        } else if typed && word.ends_with(')') {
            typed = false;
            words.extend(word.strip_suffix(')'));
        } else {
            words.push(word);
        }
    }
    words.join(" ")
}

/// Returns line and column, 1-based, of the innermost mark in the excerpt: for an invalid function, the expression that
/// makes it invalid. `None` if only the whole function is marked.
pub(super) fn marked_location(message: &str, source: &str) -> Option<(usize, usize)> {
    // Parse errors have their own location.
    if !message.trim_start().starts_with("Shader validation") {
        return None;
    }
    let mut row = None;
    for line in message.lines() {
        if let Some(number) = line.split('│').next().and_then(|gutter| gutter.trim().parse::<usize>().ok()) {
            row = Some((number, line));
            continue;
        }
        // "╰─^" ends a mark that began on an earlier line.
        if let (Some(at), Some((number, row))) = (line.find('^'), row)
            && !line[..at].contains('╰')
        {
            let text = source.lines().nth(number.checked_sub(1)?)?;
            let before = row.strip_suffix(text.trim_end()).map(|before| before.chars().count());
            let column = before.and_then(|before| (line[..at].chars().count() + 1).checked_sub(before));
            // naga prints tabs as spaces, which hides the column: uses the start of the line's text.
            return Some((number, column.unwrap_or(text.len() - text.trim_start().len() + 1)));
        }
    }
    None
}

/// Returns line, column (1-based) and character of a bracket that is still open at the end of the text. The compiler
/// would report it in the file that follows in the composed text.
pub(super) fn find_unclosed_bracket(text: &str) -> Option<(usize, usize, char)> {
    let mut open = Vec::new();
    let mut comments = 0_u32;
    for (line, text) in (1..).zip(text.lines()) {
        let mut previous = ' ';
        for (column, c) in (1..).zip(text.chars()) {
            previous = match (previous, c) {
                ('/', '/') if comments == 0 => break,
                ('/', '*') => {
                    comments += 1;
                    ' '
                }
                ('*', '/') if comments > 0 => {
                    comments -= 1;
                    ' '
                }
                _ => c,
            };
            match c {
                '{' | '(' | '[' if comments == 0 => open.push((line, column, c)),
                '}' | ')' | ']' if comments == 0 => drop(open.pop()),
                _ => {}
            }
        }
    }
    open.pop()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn naga_messages_are_converted_to_wgsl_terms() {
        let f32s = "Vector { size: Tri, scalar: Scalar { kind: Float, width: 4 } }";
        let message = format!(
            "\nShader validation error: Function [23] 'f' is invalid\n    ┌─ a:1:1\n    │\n    = Expression [4] is invalid\n    \
             = Operation Add can't work with [1] (of type {f32s}) and [3] (of type Scalar(Scalar {{ kind: Uint, width: 4 }}))\n"
        );
        assert_eq!(to_wgsl_terms(&message), "Function 'f' is invalid: Operation Add can't work with vec3<f32> and u32");
        let returned = "Shader validation error: The `return` expression Some([5]) does not match the declared return type Some([3])";
        assert_eq!(to_wgsl_terms(returned), "The `return` expression does not match the declared return type");
        assert_eq!(to_wgsl_terms("error: Bindings for [4] conflict with [5]"), "Bindings for this conflict with this");
        let parsed = "\nShader 'a' parsing error: expected `;`, found \"return\"\n  ┌─ wgsl:387:5\n";
        assert_eq!(to_wgsl_terms(parsed), "expected `;`, found \"return\"");
    }

    #[test]
    fn brackets_in_comments_do_not_count() {
        assert_eq!(find_unclosed_bracket("fn f() { // {\n/* ( /* [ */ { */ g(); }\n"), None);
        assert_eq!(find_unclosed_bracket("fn f() {\n    if x { g();\n}\n"), Some((1, 8, '{')));
        assert_eq!(find_unclosed_bracket("const a = b(1,\n"), Some((1, 12, '(')));
        assert_eq!(find_unclosed_bracket("a / b * (c) /* /"), None);
    }
}
