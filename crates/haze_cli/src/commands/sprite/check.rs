//! `haze sprite check`: reports visible flaws of sprites.

use std::path::{Path, PathBuf};

use clap::Args;
use haze_author::finding::Finding;
use haze_author::sprite::bake::SpriteRecipe;
use haze_author::sprite::lint::lint_sprite;
use haze_core::assets::image::read_png;
use haze_core::assets::sprite::SpriteLayout;
use haze_core::error::Error;
use haze_export::file_kind::explain_wrong_kind;
use haze_export::options::whole_number;
use haze_export::output::Failures;

use crate::findings::report_findings;

#[derive(Args)]
pub struct Arguments {
    /// PNGs to check.
    #[arg(required = true)]
    sprites: Vec<PathBuf>,
    /// Frames per row of the sheet. Default: from the recipe beside the PNG, else 1.
    #[arg(long, allow_hyphen_values = true, value_parser = whole_number(1..=256))]
    columns: Option<u32>,
    /// Rows of frames. Default: from the recipe beside the PNG, else 1.
    #[arg(long, allow_hyphen_values = true, value_parser = whole_number(1..=256))]
    rows: Option<u32>,
    /// Normals point down in green: the preset loads the sprites with `"y_down": true`.
    #[arg(long)]
    y_down: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    report_findings(&arguments.sprites, |path| findings(path, arguments))
}

fn findings(path: &Path, Arguments { columns, rows, y_down, .. }: &Arguments) -> Result<Vec<Finding>, Error> {
    let image = read_png(path).map_err(|error| explain_wrong_kind(error.into(), path, "image", "a PNG"))?.to_rgba8();
    let recipe = path.with_extension("sprite.json");
    let beside = if (columns, rows) == (&None, &None) && recipe.is_file() {
        SpriteRecipe::load(&recipe)?.layout()
    } else {
        SpriteLayout::default()
    };
    let layout =
        SpriteLayout { columns: columns.unwrap_or(beside.columns), rows: rows.unwrap_or(beside.rows), y_down: *y_down };
    Ok(lint_sprite(path, &image, layout)?)
}
