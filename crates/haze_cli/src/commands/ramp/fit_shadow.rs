//! `haze ramp fit-shadow`: fits a shadow ramp to path-traced clouds of puffs.

use std::path::PathBuf;

use clap::Args;
use haze_author::ramp::response::{FitShape, Puff, Response, ShadowShape, fit_shadow_ramp};
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_core::settings::Lighting;
use haze_demo::puff_cloud::{CloudShape, PuffKind, ring_of_lights};
use haze_export::options::{choices, whole_number};
use haze_export::output::{FileChecks, print_line};
use haze_export::recipe_files::image_path;
use haze_export::sprite_by_name::sprite_recipe;
use haze_preset::write_baked_png;

use super::ramp_io::{check_recipe_output, write_recipe};
use crate::bake_job::{PaintedPng, check_not_painted};
use crate::medium_options::PuffArguments;

/// Number of clouds that the ramp is fitted to: four of each shape, at other random positions.
const CLOUDS: usize = 12;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    puff: PuffArguments,
    /// Lighting of the puffs. Each has an error of its own by angle, which the ramp makes good.
    #[arg(long, value_parser = choices::<Lighting>(), default_value = Lighting::default().name())]
    lighting: Lighting,
    /// Stops per row, from no smoke in front of the light to endless smoke.
    #[arg(long, default_value_t = ShadowShape::default().stops, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(2..=64))]
    stops: u32,
    /// Rows, from a light on the viewer's side to a light behind the smoke.
    #[arg(long, default_value_t = ShadowShape::default().rows, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(1..=16))]
    rows: u32,
    /// Recipe to write, with its PNG beside it.
    #[arg(short, long, value_name = "NAME.ramp.json")]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let Arguments { puff: PuffArguments { medium, sprite, quality }, lighting, stops, rows, output } = arguments;
    let mut files = FileChecks::for_inputs([sprite]);
    check_recipe_output(&mut files, output)?;
    files.check_output("--output", &image_path(output), "png")?;
    check_not_painted(&image_path(output), PaintedPng::Keep)?;
    let recipe = sprite_recipe(sprite)?;
    let of = medium.medium()?;
    let path_trace = quality.path_trace();
    let puff = quality.with_progress(medium.name(), |progress| Puff::trace(&recipe, &of, &path_trace, progress))?;
    let fitted = puff.fit(FitShape::default());
    let ramp = |recipe: &haze_author::ramp::RampRecipe| Ok::<_, Error>(Ramp::from_image(&recipe.bake()?));
    let diffuse = ramp(&fitted.diffuse)?;
    let backlight = fitted.backlight.as_ref().map(ramp).transpose()?;
    let kind = PuffKind::new(&recipe, &of, path_trace);
    let [normals, six_way] = kind.materials(&diffuse, backlight.as_ref().unwrap_or(&diffuse))?;
    let material = if *lighting == Lighting::SixWay { six_way } else { normals };
    let mut clouds = Vec::new();
    let mut equations = Vec::new();
    let shapes = CloudShape::ALL.into_iter().cycle().take(CLOUDS);
    for (seed, shape) in (1..).zip(shapes) {
        let cloud = kind.cloud(shape, seed);
        let truth = cloud.truth(&ring_of_lights());
        equations.extend(cloud.shaded_lights(&material, &truth)?);
        clouds.push((shape, cloud, truth));
    }
    let (fitted, full_light) = fit_shadow_ramp(&equations, ShadowShape { stops: *stops, rows: *rows });
    let baked = fitted.bake()?;
    write_recipe(output, &fitted)?;
    write_baked_png(&image_path(output), &baked)?;
    let shadow = Ramp::from_image(&baked);
    for (shape, cloud, truth) in &clouds {
        let error = |material| {
            let response = Response::new(&cloud.drawn(&ring_of_lights(), material)?, truth);
            Ok::<_, Error>(100.0 * response.error)
        };
        let plain = error(&material)?;
        let shaded = error(&material.with_shadow(&shadow))?;
        print_line!("{}: brightness {shaded:.1} % off, {plain:.1} % without shadow", shape.name())?;
    }
    print_line!(
        "{}: multiply diffuse.intensity by {:.2}; the ramp is {full_light:.2} in full light, because smoke of {} is \
         brighter among other smoke than alone",
        output.display(),
        1.0 / full_light,
        medium.name()
    )
}
