//! Parses and evaluates formulas for the position on a ramp, such as `smoothstep(0, 0.2 + v, u)`.

use haze_core::error::{FieldError, one_line};

use crate::deterministic_math::{exp, power};

/// Maximum length of a formula, bytes.
const MAX_LENGTH: usize = 1000;
/// Maximum nesting depth of brackets and signs.
const MAX_DEPTH: u32 = 64;

/// A formula of the two axes `u` and `v`, 0 to 1, with numbers, `+ - * / ^`, brackets and the functions of
/// [`FUNCTIONS`]. Stored in reverse Polish order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Formula(Vec<Operation>);

/// One operation on a stack of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    Number(f32),
    U,
    V,
    /// Replaces the function's arguments on the stack by its value. Indexes [`FUNCTIONS`].
    Call(usize),
}

type Function = (&'static str, usize, fn(&[f32]) -> f32);

/// Name, argument count and implementation. The first entries are the operators; `~` is negation.
const FUNCTIONS: &[Function] = &[
    ("+", 2, |x| x[0] + x[1]),
    ("-", 2, |x| x[0] - x[1]),
    ("*", 2, |x| x[0] * x[1]),
    ("/", 2, |x| x[0] / x[1]),
    ("^", 2, |x| power(x[0], x[1])),
    ("~", 1, |x| -x[0]),
    ("abs", 1, |x| x[0].abs()),
    ("exp", 1, |x| exp(x[0])),
    ("max", 2, |x| x[0].max(x[1])),
    ("min", 2, |x| x[0].min(x[1])),
    ("mix", 3, |x| x[0] * (1.0 - x[2]) + x[1] * x[2]),
    ("pow", 2, |x| power(x[0], x[1])),
    ("smoothstep", 3, |x| {
        let t = ((x[2] - x[0]) / (x[1] - x[0])).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }),
    ("sqrt", 1, |x| x[0].max(0.0).sqrt()),
    ("step", 2, |x| f32::from(u8::from(x[1] >= x[0]))),
];

impl Formula {
    /// Parses a formula. `field` is used only in errors.
    pub fn parse(field: &str, text: &str) -> Result<Self, FieldError> {
        if text.len() > MAX_LENGTH {
            let problem = format!("{} characters are too many", text.len());
            return Err(FieldError::from_problem(field, problem, format!("at most {MAX_LENGTH}")));
        }
        let mut reader = Reader { rest: text.trim_start(), operations: Vec::new(), depth: 0 };
        let read = reader
            .sum()
            .and_then(|()| if reader.rest.is_empty() { Ok(()) } else { Err("an operator, or the end".to_owned()) });
        read.map_err(|expected| {
            let rest = one_line(reader.rest.chars().take(20).collect::<String>());
            let place = if rest.is_empty() { "at its end".to_owned() } else { format!("before {rest:?}") };
            let text = format!("{text:?}");
            FieldError::from_problem(field, format!("{} is not valid {place}", one_line(text)), expected)
        })?;
        Ok(Self(reader.operations))
    }

    /// Evaluates the formula and clamps the value to 0 to 1. NaN becomes 0.
    pub fn place(&self, u: f32, v: f32) -> f32 {
        let mut stack = Vec::with_capacity(8);
        for operation in &self.0 {
            let value = match *operation {
                Operation::Number(number) => number,
                Operation::U => u,
                Operation::V => v,
                Operation::Call(index) => {
                    let (_, count, function) = FUNCTIONS[index];
                    let arguments = stack.split_off(stack.len().saturating_sub(count));
                    function(&arguments)
                }
            };
            stack.push(value);
        }
        // The comparison is false for NaN.
        stack.pop().filter(|&place| place >= 0.0).unwrap_or(0.0).min(1.0)
    }
}

/// Recursive descent parser. Its errors say what is expected at `rest`.
struct Reader<'a> {
    rest: &'a str,
    operations: Vec<Operation>,
    depth: u32,
}

impl Reader<'_> {
    fn sum(&mut self) -> Result<(), String> {
        self.chain(&["+", "-"], |reader| reader.chain(&["*", "/"], Self::signed))
    }

    /// Parses operands joined by left-associative binary operators.
    fn chain(&mut self, signs: &[&str], part: impl Fn(&mut Self) -> Result<(), String>) -> Result<(), String> {
        part(self)?;
        while let Some(sign) = signs.iter().find(|sign| self.consume(sign)) {
            part(self)?;
            self.call(sign);
        }
        Ok(())
    }

    /// Parses an optional minus sign and a power. The sign binds weaker than `^`; the exponent may have a sign itself.
    fn signed(&mut self) -> Result<(), String> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(format!("at most {MAX_DEPTH} nested brackets and signs"));
        }
        if self.consume("-") {
            self.signed()?;
            self.call("~");
        } else {
            self.value()?;
            if self.consume("^") {
                self.signed()?;
                self.call("^");
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn value(&mut self) -> Result<(), String> {
        if self.consume("(") {
            self.sum()?;
            return self.expect(")");
        }
        let is_number = self.rest.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        let part_of = |c: char| if is_number { c.is_ascii_digit() || c == '.' } else { c.is_ascii_alphabetic() };
        let end = self.rest.find(|c| !part_of(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        let function =
            FUNCTIONS.iter().position(|&(name, ..)| name == word).filter(|_| rest.trim_start().starts_with('('));
        let operation = match (word, word.parse(), function) {
            ("u", ..) => Operation::U,
            ("v", ..) => Operation::V,
            (_, Ok(number), _) if is_number => Operation::Number(number),
            (.., Some(function)) => Operation::Call(function),
            _ => {
                let names: Vec<_> = FUNCTIONS.iter().map(|&(name, ..)| name).filter(|name| name.len() > 1).collect();
                return Err(format!("a number, u, v, a bracket, or one of {} with its arguments", names.join(", ")));
            }
        };
        self.rest = rest.trim_start();
        if let Operation::Call(function) = operation {
            for argument in 0..FUNCTIONS[function].1 {
                self.expect(if argument == 0 { "(" } else { "," })?;
                self.sum()?;
            }
            self.expect(")")?;
        }
        self.operations.push(operation);
        Ok(())
    }

    fn call(&mut self, name: &str) {
        self.operations.extend(FUNCTIONS.iter().position(|function| function.0 == name).map(Operation::Call));
    }

    fn consume(&mut self, sign: &str) -> bool {
        let rest = self.rest.strip_prefix(sign);
        self.rest = rest.map_or(self.rest, str::trim_start);
        rest.is_some()
    }

    fn expect(&mut self, sign: &str) -> Result<(), String> {
        if self.consume(sign) { Ok(()) } else { Err(format!("\"{sign}\"")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_evaluated_with_the_usual_precedence() {
        for (text, expected) in [
            ("u", 0.25),
            (" v ", 0.5),
            ("u + v * u", 0.375),
            ("(u + v) * u", 0.1875),
            ("1 - u - v", 0.25),
            ("u / v / 2", 0.25),
            ("v ^ 2", 0.25),
            ("-v ^ 2 + 1", 0.75),
            ("0.5 ^ -1 - 1.5", 0.5),
            ("2 ^ 2 ^ 0 - 1.5", 0.5),
            ("--u", 0.25),
            ("min(u, v) + max(u, v)", 0.75),
            ("smoothstep(0, 1, v)", 0.5),
            ("step(0.3, u) + step(0.3, v)/2", 0.5),
            ("mix(u, v, 0.5)", 0.375),
            ("sqrt(u)", 0.5),
            ("abs(u - 1) - .5", 0.25),
            ("exp(0) / 2", 0.5),
            ("9", 1.0),
            ("-9", 0.0),
            ("0 / 0", 0.0),
            ("u / 0", 1.0),
        ] {
            let place = Formula::parse("place", text).unwrap().place(0.25, 0.5);
            assert!((place - expected).abs() < 1.0e-6, "{text}: {place}");
        }
    }

    #[test]
    fn malformed_formulas_are_refused_with_their_position() {
        let error = |text: &str| Formula::parse("place", text).unwrap_err().to_string();
        assert_eq!(error("u v"), r#"place: "u v" is not valid before "v"; expected an operator, or the end"#);
        let cut = error("u +");
        assert!(cut.starts_with(r#"place: "u +" is not valid at its end; expected a number, u, v,"#), "{cut}");
        assert_eq!(error("min(u)"), r#"place: "min(u)" is not valid before ")"; expected ",""#);
        for text in ["", "1.2.3", "é", "sin(u)", "u(", "min", "min(u, v", "+", "u ** v", "1e5", "\u{1b}[2J"] {
            assert!(Formula::parse("place", text).is_err(), "{text}");
        }
        for deep in ["(", "-", "2^", "abs("] {
            let error = error(&format!("{}u", deep.repeat(200)));
            assert!(error.contains("at most 64 nested brackets and signs"), "{error}");
        }
        assert!(error(&"u+".repeat(600)).contains("1200 characters are too many; expected at most 1000"));
    }
}
