//! WGSL of a material, assembled from the functions of the transfer pass.

use glam::Vec3;
use haze::{MaterialAssets, shader};
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_core::settings::{Backlight, Choice as _, CoverageMode, Settings, SoftScatterMode};

use super::translation::untranslated;
use crate::engine::Engine;

/// A ramp that a material reads.
pub struct UsedRamp {
    /// Name of the parameter, and of the file without ending.
    pub name: &'static str,
    /// Axes, in a few words.
    pub axes: &'static str,
    pub of: fn(&MaterialAssets) -> &Ramp,
}

impl UsedRamp {
    pub fn file(&self) -> String {
        format!("{}.png", self.name)
    }
}

/// Function of a material.
pub struct Function {
    pub name: &'static str,
    pub doc: &'static str,
    /// Ramps that it reads, which are its first parameters, followed by a sampler; none without a ramp.
    pub ramps: Vec<&'static str>,
    /// Further parameters: names and WGSL types.
    pub inputs: &'static [(&'static str, &'static str)],
    /// WGSL type of the result.
    pub result: &'static str,
    body: String,
}

/// WGSL of a material. Its functions take their ramps as parameters: it declares no bindings.
pub struct Snippet {
    pub ramps: Vec<UsedRamp>,
    pub functions: Vec<Function>,
    pub wgsl: String,
}

const VECTORS_AND_AMOUNT: &[(&str, &str)] =
    &[("normal", "vec3f"), ("to_light", "vec3f"), ("to_viewer", "vec3f"), ("amount", "f32")];
const AMOUNT: &[(&str, &str)] = &[("amount", "f32")];
const AGE: &[(&str, &str)] = &[("age", "f32")];
const HEAT_AND_AMOUNT: &[(&str, &str)] = &[("heat", "f32"), ("amount", "f32")];

impl Snippet {
    /// `settings`: of a system that is lit by ramps.
    ///
    /// # Errors
    /// [`Error::Field`] if the library does not compose.
    pub fn new(settings: &Settings, engine: Engine) -> Result<Self, Error> {
        let knows_age = engine.knows_age();
        let ramps = used_ramps(settings, knows_age);
        let functions = functions(settings, knows_age);
        let constants = constants(settings);
        let own: String = functions.iter().map(Function::wgsl).collect();
        let library = shader::compose(LIBRARY).map_err(|reason| untranslated("WGSL", &reason))?;
        let chosen = [("BACKLIGHT", settings.diffuse.backlight.index()), ("RAMP_FILTER", settings.ramp_filter.index())];
        let items = items(&with_chosen(&library, &chosen), declared_name);
        let wgsl = with_prefixes(&items, &(constants + &used_items(&items, &own) + &own));
        Ok(Self { ramps, functions, wgsl: wgsl.trim_end().to_owned() + "\n" })
    }
}

/// Files of the library that hold the functions of a material.
const LIBRARY: &str = "#import \"lib/response.wgsl\"\n";

impl Function {
    fn wgsl(&self) -> String {
        let ramps = self.ramps.iter().map(|name| format!("{name}: texture_2d<f32>"));
        let sampler = (!self.ramps.is_empty()).then(|| "ramp_sampler: sampler".to_owned());
        let inputs = self.inputs.iter().map(|(name, ty)| format!("{name}: {ty}"));
        let parameters: Vec<_> = ramps.chain(sampler).chain(inputs).collect();
        let parameters = parameters.join(", ");
        let Self { name, doc, result, body, .. } = self;
        let doc: String = doc.lines().map(|line| format!("// {line}\n")).collect();
        format!("{doc}fn {name}({parameters}) -> {result} {{\n{body}}}\n\n")
    }
}

fn used_ramps(settings: &Settings, knows_age: bool) -> Vec<UsedRamp> {
    let angle = "across: dot(normal, to_light)/2 + 1/2; rows: amount times boost";
    let all = [
        (true, UsedRamp { name: "diffuse_ramp", axes: angle, of: |assets| &assets.diffuse_ramp }),
        (
            settings.diffuse.backlight == Backlight::Ramp,
            UsedRamp { name: "backlight_ramp", axes: angle, of: |assets| &assets.backlight_ramp },
        ),
        (
            settings.soft_scatter.mode == SoftScatterMode::Ramp,
            UsedRamp { name: "soft_scatter_ramp", axes: "across: amount", of: |assets| &assets.soft_scatter_ramp },
        ),
        (
            settings.coverage == CoverageMode::Ramp,
            UsedRamp { name: "coverage_ramp", axes: "across: amount times boost", of: |assets| &assets.coverage_ramp },
        ),
        (
            settings.burns(),
            UsedRamp {
                name: "fire_ramp",
                axes: "across: heat; rows: amount times boost",
                of: |assets| &assets.fire_ramp,
            },
        ),
        (
            settings.burns() && knows_age,
            UsedRamp { name: "heat_ramp", axes: "across: age; gray: heat", of: |assets| &assets.heat_ramp },
        ),
    ];
    all.into_iter().filter(|(is_used, _)| *is_used).map(|(_, ramp)| ramp).collect()
}

fn functions(settings: &Settings, knows_age: bool) -> Vec<Function> {
    let backlight = (settings.diffuse.backlight == Backlight::Ramp).then_some("backlight_ramp");
    let by_ramp = settings.soft_scatter.mode == SoftScatterMode::Ramp;
    let covers_by_ramp = settings.coverage == CoverageMode::Ramp;
    let mut functions = vec![
        Function {
            name: "haze_diffuse",
            doc: "Share of a light that the smoke sends to the viewer. Multiply by the light's color and attenuation, and add the\n\
                  results of all lights. The three vectors have unit length and are in one space.",
            ramps: [Some("diffuse_ramp"), backlight].into_iter().flatten().collect(),
            inputs: VECTORS_AND_AMOUNT,
            result: "vec3f",
            body: format!(
                "    let covered = coverage(amount, HAZE_BOOST);\n    \
                 let against = backlight_weight(to_light, to_viewer);\n    \
                 return diffuse_response(\n        \
                 diffuse_ramp, {}, ramp_sampler, normal, to_light, covered, against,\n    \
                 ) * HAZE_DIFFUSE_INTENSITY;\n",
                // Without a ramp of its own, light from behind uses that of all other light.
                backlight.unwrap_or("diffuse_ramp"),
            ),
        },
        Function {
            name: "haze_soft_scatter",
            doc: "Even light of the smoke itself, for all lights together.",
            ramps: if by_ramp { vec!["soft_scatter_ramp"] } else { Vec::new() },
            inputs: AMOUNT,
            result: "vec3f",
            body: match by_ramp {
                true => {
                    "    return sample_ramp(soft_scatter_ramp, ramp_sampler, amount) * HAZE_SOFT_SCATTER_INTENSITY;\n"
                }
                false => {
                    "    return soft_scatter_curve(\n        \
                     amount, HAZE_SCATTER_COLOR, HAZE_AMBIENT_COLOR, HAZE_SCATTER_AMOUNT, HAZE_SCATTER_SMOOTH,\n    \
                     ) * HAZE_SOFT_SCATTER_INTENSITY;\n"
                }
            }
            .into(),
        },
        Function {
            name: "haze_coverage",
            doc: "Opacity of the smoke: the fraction of the background that it hides.",
            ramps: if covers_by_ramp { vec!["coverage_ramp"] } else { Vec::new() },
            inputs: AMOUNT,
            result: "f32",
            body: match covers_by_ramp {
                true => {
                    "    let covered = coverage(amount, HAZE_BOOST);\n    \
                     return painted_fraction(sample_ramp(coverage_ramp, ramp_sampler, covered));\n"
                }
                false => "    return coverage(amount, HAZE_BOOST);\n",
            }
            .into(),
        },
    ];
    if settings.burns() {
        functions.push(Function {
            name: "haze_emission",
            doc: "Light of hot smoke, which is added to that of the others. `heat`: 0 for cold smoke, 1 for the hottest.",
            ramps: vec!["fire_ramp"],
            inputs: HEAT_AND_AMOUNT,
            result: "vec3f",
            body: "    return fire_response(fire_ramp, ramp_sampler, vec2f(heat, 1.0), amount, HAZE_BOOST) * HAZE_FIRE_INTENSITY;\n"
                .into(),
        });
    }
    if settings.burns() && knows_age {
        functions.push(Function {
            name: "haze_heat_by_age",
            doc: "Heat of a particle. `age`: 0 at birth, 1 at death.",
            ramps: vec!["heat_ramp"],
            inputs: AGE,
            result: "f32",
            body: "    return painted_fraction(sample_ramp(heat_ramp, ramp_sampler, age));\n".into(),
        });
    }
    functions
}

fn constants(settings: &Settings) -> String {
    let number = |name: &str, value: f32| format!("const HAZE_{name}: f32 = {value:?};\n");
    let color = |name: &str, c: Vec3| format!("const HAZE_{name}: vec3f = vec3f({:?}, {:?}, {:?});\n", c.x, c.y, c.z);
    let scatter = &settings.soft_scatter;
    let mut text = number("BOOST", settings.boost) + &number("DIFFUSE_INTENSITY", settings.diffuse.intensity);
    if scatter.mode == SoftScatterMode::Smoothstep {
        text += &color("SCATTER_COLOR", scatter.scatter_color);
        text += &color("AMBIENT_COLOR", scatter.ambient_color);
        text += &number("SCATTER_AMOUNT", scatter.scatter_amount);
        text += &number("SCATTER_SMOOTH", scatter.scatter_smooth);
    }
    text += &number("SOFT_SCATTER_INTENSITY", scatter.intensity);
    if settings.burns() {
        text += &number("FIRE_INTENSITY", settings.fire.intensity);
    }
    text
}

/// Replaces override constants by constants, with the chosen values.
fn with_chosen(library: &str, chosen: &[(&str, usize)]) -> String {
    let line = |line: &str| {
        let Some(declaration) = line.strip_prefix("override ") else { return line.to_owned() };
        let value = |(name, index): &(&str, usize)| {
            declaration.starts_with(&format!("{name}:")).then(|| format!("const {name}: u32 = {index}u;"))
        };
        chosen.iter().find_map(value).unwrap_or_else(|| format!("const {declaration}"))
    };
    library.lines().map(|text| line(text) + "\n").collect()
}

/// A declaration of WGSL outside functions, with the comment above it.
struct Item {
    name: String,
    text: String,
}

/// Splits a library into its declarations.
fn items(library: &str, declared_name: impl Fn(&str) -> Option<&str>) -> Vec<Item> {
    let mut items = Vec::new();
    let mut text = String::new();
    let mut name = None;
    for line in library.lines() {
        if line.is_empty() && name.is_none() {
            // The comment at the head of a file.
            text.clear();
            continue;
        }
        text += line;
        text += "\n";
        if name.is_none() && !line.starts_with("//") {
            name = declared_name(line).map(str::to_owned);
        }
        // Declarations end at the left margin.
        let is_end = line == "}" || !line.starts_with([' ', '/']) && line.ends_with(';');
        if is_end && let Some(name) = name.take() {
            items.push(Item { name, text: std::mem::take(&mut text) });
        }
    }
    items
}

fn declared_name(line: &str) -> Option<&str> {
    let rest = ["fn ", "const ", "struct "].iter().find_map(|keyword| line.strip_prefix(keyword))?;
    words(rest).next()
}

/// Name that a line of GLSL declares: that of a function, or of a constant.
fn declared_in_glsl(line: &str) -> Option<&str> {
    words(line.strip_prefix("const ").unwrap_or(line)).nth(1)
}

/// Returns the declarations of some GLSL that the functions of these names use, and those functions.
pub fn used_glsl(glsl: &str, names: &[&str]) -> String {
    used_items(&items(glsl, declared_in_glsl), &names.join(" ")).trim().to_owned() + "\n"
}

/// Gives all names of the library a prefix: an engine has names of its own, such as `BACKLIGHT`.
fn with_prefixes(items: &[Item], text: &str) -> String {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut prefixed = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(is_name) {
        let (before, from) = rest.split_at(start);
        let (word, after) = from.split_at(from.find(|c| !is_name(c)).unwrap_or(from.len()));
        let prefix = match items.iter().any(|item| item.name == word) {
            false => "",
            true if word.starts_with(|c: char| c.is_uppercase()) => "HAZE_LIB_",
            true => "haze_lib_",
        };
        prefixed.extend([before, prefix, word]);
        rest = after;
    }
    prefixed + rest
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// Returns the text of the declarations that a text uses, and of those that these use.
fn used_items(items: &[Item], text: &str) -> String {
    let mut is_used = vec![false; items.len()];
    let mut open = vec![text];
    while let Some(text) = open.pop() {
        let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        for word in code.flat_map(words) {
            let found = items.iter().position(|item| item.name == word);
            if let Some(index) = found.filter(|index| !std::mem::replace(&mut is_used[*index], true)) {
                open.push(&items[index].text);
            }
        }
    }
    let used = items.iter().zip(&is_used).filter(|(_, is_used)| **is_used).map(|(item, _)| item);
    let (constants, functions): (Vec<_>, Vec<_>) = used.partition(|item| item.text.lines().count() == 1);
    let functions = functions.iter().map(|item| item.text.clone() + "\n");
    constants.iter().map(|item| item.text.clone()).chain(["\n".to_owned()]).chain(functions).collect()
}
