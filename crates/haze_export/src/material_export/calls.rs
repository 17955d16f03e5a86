//! Calls of a material's functions, for the sources of all engines.

use super::snippet::{Function, Snippet};

/// First line of every source.
pub const NOTE: &str = "// Light of smoke, exported from a haze preset. README.md says how to use it.\n";

/// Input that only fire has.
pub const HEAT: &str = "heat";

/// Text that calls a function. `ramp`: expression of a ramp by its name; `sampler`: of the sampler, if the language has any.
pub fn call(
    function: &Function,
    ramp: impl Fn(&str) -> String,
    sampler: Option<&str>,
    input: impl Fn(&str) -> String,
) -> String {
    let sampler = sampler.filter(|_| !function.ramps.is_empty()).map(str::to_owned);
    let ramps = function.ramps.iter().map(|name| ramp(name));
    let inputs = function.inputs.iter().map(|(name, _)| input(name));
    format!("{}({})", function.name, ramps.chain(sampler).chain(inputs).collect::<Vec<_>>().join(", "))
}

/// Calls of the functions that a material has, by name.
pub struct Calls {
    pub diffuse: String,
    pub soft_scatter: String,
    pub coverage: String,
    pub emission: Option<String>,
    /// Heat of a particle, where its age is known.
    pub heat: Option<String>,
}

impl Calls {
    pub fn new(snippet: &Snippet, call: impl Fn(&Function) -> String) -> Self {
        let find = |name: &str| snippet.functions.iter().find(|function| function.name == name).map(&call);
        let required = |name: &str| find(name).unwrap_or_default();
        Self {
            diffuse: required("haze_diffuse"),
            soft_scatter: required("haze_soft_scatter"),
            coverage: required("haze_coverage"),
            emission: find("haze_emission"),
            heat: find("haze_heat_by_age"),
        }
    }

    /// Sum of all light, under one light.
    pub fn light(&self, light_color: &str) -> String {
        let emission = self.emission.as_ref().map(|emission| format!(" + {emission}")).unwrap_or_default();
        format!("{} * {light_color} + {}{emission}", self.diffuse, self.soft_scatter)
    }
}
