//! `haze ramp new`: a recipe to begin with.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use haze::ramp::template::{TEMPLATES, Template};
use haze::{Error, FieldError};

use super::super::output::{Files, say};
use super::{check_output, write_recipe};

#[derive(Args)]
pub struct Arguments {
    /// What to begin with.
    #[arg(long, value_name = "NAME", default_value = "neutral", value_parser = names())]
    template: String,
    /// The recipe to write, `NAME.ramp.json`; there must be none of that name.
    #[arg(short, long, value_name = "NAME.ramp.json")]
    output: PathBuf,
}

fn names() -> PossibleValuesParser {
    let about = |template: &Template| format!("{}: {}", template.role.name(), template.about);
    TEMPLATES.iter().map(|template| PossibleValue::new(template.name).help(about(template))).collect::<Vec<_>>().into()
}

pub fn run(Arguments { template, output }: &Arguments) -> Result<(), Error> {
    check_output(&mut Files::read::<PathBuf>([]), output)?;
    // Nobody's work is lost to a template.
    if output.exists() {
        return Err(FieldError::new("--output", output.display(), "a name that is free").into());
    }
    let Some(template) = Template::find(template) else { return Ok(()) };
    write_recipe(output, &template.recipe())?;
    say!("{}: {}, for {} ramps", output.display(), template.about, template.role.name())
}
