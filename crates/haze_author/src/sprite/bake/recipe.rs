//! How a sprite was made: the contents of a `*.sprite.json`.

use std::path::Path;

use haze::assets::json;
use haze::assets::picture::MAX_SIDE;
use haze::assets::sprite::SpriteLayout;
use haze::builtin::{self, Builtin};
use haze::error::Error;
use haze::settings::{FieldVisitor, Fields, Headed, validate};

/// The version of the recipe format that this code writes and reads.
pub const RECIPE_VERSION: u32 = 2;

/// How a sprite was made: the contents of a `*.sprite.json`. Lengths are in halves of the sprite's side, so the sprite
/// reaches from −1 to 1.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpriteRecipe {
    /// Format version: 1 bakes as it always did, voxel by voxel; 2 is some fifty times as fast and can do more.
    pub version: u32,
    /// Different seeds give different wisps of the same kind.
    pub seed: u32,
    /// Side of one frame.
    pub size: u32,
    /// Frames beside each other on the sheet.
    pub columns: u32,
    /// Frames below each other on the sheet. The flipbook loops.
    pub rows: u32,
    /// Metaballs in the cluster.
    pub balls: u32,
    /// How far from the middle their centres lie.
    pub spread: f32,
    /// Smallest reach of a ball's influence.
    pub ball_radius_min: f32,
    /// Largest reach of a ball's influence.
    pub ball_radius_max: f32,
    /// How far the balls travel round their places in one loop.
    pub drift: f32,
    /// Noise cells along the sprite's half side, for the coarsest octave.
    pub noise_frequency: f32,
    /// Octaves of noise, each of twice the frequency and `noise_gain` times the weight.
    pub noise_octaves: u32,
    /// Weight of an octave relative to the coarser one. Larger is rougher.
    pub noise_gain: f32,
    /// How much the noise takes away: 0 leaves balls, 1 leaves shreds.
    pub erosion: f32,
    /// How far the balls are drawn out along a swirling flow: curls instead of lumps.
    pub warp: f32,
    /// Extinction at full density. Larger is more opaque and has a harder edge.
    pub extinction: f32,
    /// Weight of the fine normals, a texel wide, against the broad ones, a twelfth of the sprite wide.
    pub bump: f32,
    /// Version 2: half length of the lines that balls are drawn out to. 0 leaves balls; thin ones become strands.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub length: f32,
    /// Version 2: 0 draws them out in any direction, 1 upright: streaks.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub upright: f32,
    /// Version 2: how far the noise is round lumps with sharp creases between, a cauliflower, instead of waves.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub lumps: f32,
    /// Version 2: how far all of it is carried along a swirling flow and back in one loop. Above 0 the noise is carried too and
    /// does not turn in its place: frames that travel rather than boil. Up to about 0.2 motion can follow.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub travel: f32,
    /// How far a texel may be moved to make the file smaller; a normal in thin smoke up to four times as far, depth and motion half
    /// as far. 2 halves the file, and is not seen.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub tolerance: u32,
}

/// At what it is in older files.
fn is_unused<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Fields for SpriteRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, 1..=RECIPE_VERSION, "");
        visitor.seed("seed", &mut self.seed);
        // A frame is marched through a cube of its size; a sheet must be readable again.
        visitor.integer("size", &mut self.size, 8..=512, "pixels");
        let most = (MAX_SIDE / self.size.max(1)).min(16);
        visitor.integer("columns", &mut self.columns, 1..=most, "frames");
        visitor.integer("rows", &mut self.rows, 1..=most, "frames");
        visitor.integer("balls", &mut self.balls, 1..=256, "");
        visitor.number("spread", &mut self.spread, 0.0..=1.0, "half sides");
        visitor.number("ball_radius_min", &mut self.ball_radius_min, 0.02..=1.0, "half sides");
        visitor.number("ball_radius_max", &mut self.ball_radius_max, self.ball_radius_min..=1.0, "half sides");
        visitor.number("drift", &mut self.drift, 0.0..=0.5, "half sides");
        visitor.number("noise_frequency", &mut self.noise_frequency, 0.1..=32.0, "");
        visitor.integer("noise_octaves", &mut self.noise_octaves, 1..=8, "");
        visitor.number("noise_gain", &mut self.noise_gain, 0.0..=1.0, "");
        visitor.number("erosion", &mut self.erosion, 0.0..=4.0, "");
        visitor.number("warp", &mut self.warp, 0.0..=2.0, "");
        visitor.number("extinction", &mut self.extinction, 0.1..=200.0, "");
        visitor.number("bump", &mut self.bump, 0.0..=10.0, "");
        let up_to = |most: f32| 0.0..=if self.version < 2 { 0.0 } else { most };
        visitor.number("length", &mut self.length, up_to(1.0), "half sides");
        visitor.number("upright", &mut self.upright, up_to(1.0), "");
        visitor.number("lumps", &mut self.lumps, up_to(1.0), "");
        visitor.number("travel", &mut self.travel, up_to(1.0), "half sides");
        visitor.integer("tolerance", &mut self.tolerance, 0..=8, "of 255");
    }

    fn headings(&self) -> &'static [Headed] {
        HEADINGS
    }
}

/// What is set together.
const HEADINGS: &[Headed] = &[
    ("seed", Some("shape")),
    ("balls", None),
    ("spread", None),
    ("ball_radius_min", None),
    ("ball_radius_max", None),
    ("length", None),
    ("upright", None),
    ("erosion", Some("wisps")),
    ("noise_frequency", None),
    ("noise_octaves", None),
    ("noise_gain", None),
    ("lumps", None),
    ("warp", None),
    ("drift", Some("motion")),
    ("travel", None),
    ("extinction", Some("surface")),
    ("bump", None),
    ("version", Some("sheet")),
    ("size", None),
    ("columns", None),
    ("rows", None),
    ("tolerance", None),
];

impl SpriteRecipe {
    /// Reads a `*.sprite.json`.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Json`] or [`Error::JsonField`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        json::load(path, RECIPE_VERSION, |recipe: &Self| validate(recipe, String::new))
    }

    /// The JSON that [`SpriteRecipe::load`] reads, ending with a line break.
    pub fn to_text(&self) -> String {
        // Numbers: there is nothing that could fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Frames on the sheet.
    pub fn frame_count(&self) -> u32 {
        self.columns * self.rows
    }

    /// Reads the recipe of a built-in sprite.
    ///
    /// # Errors
    /// [`Error::Json`] if `builtin` is not a sprite.
    pub fn of_builtin(builtin: &Builtin) -> Result<Self, Error> {
        json::parse(&builtin::path(builtin.name), builtin.recipe)
    }

    /// How the sheet is cut into frames.
    pub fn layout(&self) -> SpriteLayout {
        SpriteLayout { columns: self.columns, rows: self.rows, y_down: false }
    }
}
