//! Depth limit of WGSL, checked before compilation.
//!
//! naga, the compiler inside wgpu, visits expressions, blocks and types recursively, on the stack of the thread that
//! creates a module or a pipeline. A text that is too deep overflows that stack, which ends the process. naga's own limits
//! do not count every kind of nesting, and are too high for unoptimized builds.
//!
//! The depth is an upper bound that needs no parser. At each level of brackets, a path through the syntax tree passes at
//! most every operator and every `else` of one statement or list element, and one pair of brackets.

/// Maximum depth: each operator, `.`, `(` and `[` counts 1, each block and `else` counts [`BLOCK`].
///
/// Measured with naga 30.0.1 from parsing to the SPIR-V, GLSL, HLSL and MSL back ends, for every kind of nesting. On a stack
/// of 2 MiB, the default of Rust's threads, an unoptimized build compiles 1.7 times this depth, which leaves room for the
/// frames of the host. A release build compiles 25 times this depth on 1 MiB, the default of wasm32 and of the main thread
/// on Windows. The deepest of haze's own shaders has 27.
///
/// A thread with a larger stack was rejected: pipelines are compiled on the host's thread too, and wasm32 has no threads.
const MAX_DEPTH: usize = 40;
/// Depth of a block or an `else`, which takes 1.4 times the stack of an operator.
const BLOCK: usize = 2;
/// Maximum number of declarations outside functions, whose references naga and its back ends follow recursively: 1.4 times as
/// many fit in 2 MiB without optimization. haze's own shaders have up to 360.
const MAX_DECLARATIONS: usize = 720;

/// Place of the first token that is too deep.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooDeep {
    /// 1-based.
    pub line: usize,
    /// 1-based, in characters.
    pub column: usize,
    /// Problem, and what would be right.
    pub reason: String,
}

/// Refuses a text that could overflow the stack of a compiler.
pub(super) fn check_nesting(text: &str) -> Result<(), TooDeep> {
    measure(text, MAX_DEPTH, MAX_DECLARATIONS).map(|_| ())
}

/// Largest values of a text.
#[derive(Debug, Default)]
struct Measured {
    depth: usize,
    declarations: usize,
}

/// State of the text between a pair of brackets.
#[derive(Default)]
struct Level {
    /// Depth of the brackets themselves.
    base: usize,
    /// `else`s of the current statement.
    elses: usize,
    /// Operators of the current statement or list element.
    operators: usize,
    /// Depth of its deepest brackets.
    inner: usize,
    /// `<` that may still be open. Never less than the number of open template lists.
    angles: usize,
    /// Depth of the deepest statement or list element that has ended.
    deepest: usize,
}

impl Level {
    /// Depth of the current statement or list element inside this level.
    fn depth(&self) -> usize {
        BLOCK * self.elses + self.operators + self.inner
    }

    /// Ends a statement, a condition or a list element.
    fn end(&mut self) {
        self.deepest = self.deepest.max(self.depth());
        self.operators = 0;
        self.inner = 0;
    }
}

fn measure(text: &str, max_depth: usize, max_declarations: usize) -> Result<Measured, TooDeep> {
    let mut measured = Measured::default();
    let mut outer: Vec<Level> = Vec::new();
    let mut level = Level::default();
    let mut previous = "";
    for (at, token) in Tokens::new(text) {
        match token {
            "(" | "[" | "{" => {
                let weight = if token == "{" {
                    level.end();
                    level.angles = 0;
                    BLOCK
                } else {
                    1
                };
                // `a[0][0]…` is a chain; calls cannot be chained.
                level.operators += usize::from(token == "[");
                let base = level.base + BLOCK * level.elses + level.operators + weight;
                outer.push(std::mem::replace(&mut level, Level { base, ..Level::default() }));
            }
            ")" | "]" | "}" => {
                level.end();
                let weight = if token == "}" { BLOCK } else { 1 };
                let inner = level.deepest + weight;
                level = outer.pop().unwrap_or_default();
                level.inner = level.inner.max(inner);
            }
            ";" => {
                level.end();
                level.angles = 0;
                level.elses = 0;
            }
            // Inside a template list the expression around it goes on.
            "," if level.angles == 0 => level.end(),
            "else" => {
                level.end();
                level.elses += 1;
            }
            "if" if previous != "else" => level.elses = 0,
            "<" | "<=" | "<<" => {
                level.operators += 1;
                level.angles += token.matches('<').count();
            }
            ">" | ">=" | ">>" => {
                level.operators += 1;
                level.angles = level.angles.saturating_sub(token.matches('>').count());
            }
            _ if is_operator(token) => level.operators += 1,
            _ => {}
        }
        if token == "}" {
            level.end();
        }
        let ends_declaration = outer.is_empty() && (token == "}" || token == ";");
        measured.declarations += usize::from(ends_declaration);
        measured.depth = measured.depth.max(level.base + level.depth().max(level.deepest));
        let refuse = |reason| {
            let before = &text[..at];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
            Err(TooDeep { line, column, reason })
        };
        if measured.depth > max_depth {
            return refuse(format!(
                "nested more than {max_depth} deep; expected fewer operators, brackets, blocks and `else` within one \
                 another: split the statement, or move a part of it to a function"
            ));
        }
        if measured.declarations > max_declarations {
            return refuse(format!("more than {max_declarations} declarations, imports included; expected fewer"));
        }
        previous = token;
    }
    Ok(measured)
}

/// True for operators and for `.` of a component; `:` and `->` nest nothing.
fn is_operator(token: &str) -> bool {
    token != "->" && token.starts_with(['+', '-', '*', '/', '%', '&', '|', '^', '!', '~', '=', '.'])
}

/// Iterates over tokens that matter for depth, with their byte positions: words, brackets, operators. Comments are
/// skipped as naga skips them.
struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    /// Returns the length of a comment at the start of `rest`.
    fn comment(rest: &str) -> Option<usize> {
        const LINE_BREAKS: [char; 7] = ['\n', '\u{b}', '\u{c}', '\r', '\u{85}', '\u{2028}', '\u{2029}'];
        if rest.starts_with("//") {
            return Some(rest.find(LINE_BREAKS).unwrap_or(rest.len()));
        }
        let mut inside = rest.strip_prefix("/*")?;
        let mut depth = 1;
        while depth > 0 {
            // An unterminated comment extends to the end.
            let Some(at) = inside.find(['*', '/']) else { return Some(rest.len()) };
            inside = &inside[at..];
            let length = if let Some("*/") = inside.get(..2) {
                depth -= 1;
                2
            } else if let Some("/*") = inside.get(..2) {
                depth += 1;
                2
            } else {
                1
            };
            inside = &inside[length..];
        }
        Some(rest.len() - inside.len())
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        const PAIRS: [&str; 11] = ["->", "==", "!=", "<=", ">=", "<<", ">>", "&&", "||", "++", "--"];
        loop {
            let rest = &self.text[self.at..];
            let first = rest.chars().next()?;
            let start = self.at;
            if let Some(length) = Self::comment(rest) {
                self.at += length;
                continue;
            }
            let is_word = |c: char| c.is_alphanumeric() || c == '_';
            let length = if is_word(first) {
                rest.find(|c| !is_word(c)).unwrap_or(rest.len())
            } else if PAIRS.iter().any(|pair| rest.starts_with(pair)) {
                2
            } else {
                first.len_utf8()
            };
            self.at += length;
            let is_decimal_point = first == '.' && rest[length..].starts_with(|c: char| c.is_ascii_digit());
            if !first.is_whitespace() && !is_decimal_point {
                return Some((start, &rest[..length]));
            }
        }
    }
}

#[cfg(test)]
mod tests;
