//! Shared code of the gradient importers.

use haze_core::error::one_line;

/// A parse error: the 1-based line, and what is wrong and expected.
pub struct GradientParseError {
    pub line: usize,
    pub reason: String,
}

/// Parses finite numbers separated by commas or white space; `None` if one is malformed.
pub fn parse_numbers(text: &str) -> Option<Vec<f32>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok().filter(|number: &f32| number.is_finite())).collect()
}

/// A gradient's name in its file, and its 1-based line if that is a text.
pub struct GradientName<'a> {
    pub name: &'a str,
    pub line: Option<usize>,
}

/// Gradient that is read of those in a file.
pub struct ChosenGradient {
    pub index: usize,
    /// Line, if it is known, the gradient that is read, and the others, if a name did not choose it.
    pub note: Option<String>,
}

/// Chooses the gradient of a name; without a name, the first. `names` is not empty.
pub fn choose_gradient(names: &[GradientName], name: Option<&str>) -> Result<ChosenGradient, GradientParseError> {
    let index = names.iter().position(|gradient| name.is_none_or(|name| name == gradient.name));
    let Some(index) = index else {
        let known: Vec<_> = names.iter().map(|gradient| gradient.name).collect();
        let name = one_line(name.unwrap_or_default());
        let reason = format!("no gradient {name:?}; expected one of {}", one_line(known.join(", ")));
        return Err(GradientParseError { line: 1, reason });
    };
    let is_other = |(other, gradient): (usize, &GradientName)| (other != index).then_some(one_line(gradient.name));
    let others: Vec<_> = names.iter().enumerate().filter_map(is_other).collect();
    let note = (name.is_none() && !others.is_empty()).then(|| {
        let GradientName { name, line } = &names[index];
        let line = line.map(|line| format!("{line}: ")).unwrap_or_default();
        format!("{line}read gradient {}, not {}; --gradient chooses one", one_line(name), others.join(", "))
    });
    Ok(ChosenGradient { index, note })
}
