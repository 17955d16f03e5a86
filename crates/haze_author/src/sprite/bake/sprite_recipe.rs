//! Sprite recipes: the contents of a `*.sprite.json`.

use std::path::Path;

use haze_core::assets::image::MAX_SIDE;
use haze_core::assets::json;
use haze_core::assets::sprite::SpriteLayout;
use haze_core::error::{AssetError, builtin_path};
use haze_core::settings::{FieldHeading, FieldVisitor, Fields, validate};
use haze_preset::builtin::Builtin;

/// Recipe format version that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// Recipe of a sprite: the contents of a `*.sprite.json`. Lengths are in half sides: the sprite extends from −1 to 1.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpriteRecipe {
    /// Format version.
    pub version: u32,
    /// Random seed: different seeds give different sprites of the same kind.
    pub seed: u32,
    /// Width and height of one frame.
    pub size: u32,
    /// Columns of frames on the sheet.
    pub columns: u32,
    /// Rows of frames on the sheet. The flipbook loops.
    pub rows: u32,
    /// Number of metaballs in the cluster.
    pub balls: u32,
    /// Maximum distance of a ball's center from the middle.
    pub spread: f32,
    /// Smallest radius of a ball's influence.
    pub ball_radius_min: f32,
    /// Largest radius of a ball's influence.
    pub ball_radius_max: f32,
    /// Radius of the circle on which each ball moves in one loop.
    pub drift: f32,
    /// Noise cells per half side in the coarsest octave.
    pub noise_frequency: f32,
    /// Number of noise octaves, each of twice the frequency and `noise_gain` times the weight of the previous one.
    pub noise_octaves: u32,
    /// Weight of an octave relative to the coarser one. Larger values are rougher.
    pub noise_gain: f32,
    /// Strength of the erosion by noise: 0 leaves smooth balls, 1 leaves shreds.
    pub erosion: f32,
    /// Distortion along a swirling flow: turns lumps into curls.
    pub warp: f32,
    /// Extinction at full density. Larger values are more opaque and have harder edges.
    pub extinction: f32,
    /// Weight of fine normals (one texel wide) relative to broad normals (a twelfth of the sprite wide).
    pub bump: f32,
    /// Half length of the lines that balls are stretched to. 0 keeps balls; small radii give strands.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub length: f32,
    /// Direction of the lines. 0 is random, 1 upright, for streaks.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub upright: f32,
    /// Shape of the noise. 0 is waves, 1 round lumps with sharp creases, like cauliflower.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub lumps: f32,
    /// Distance that balls and noise are carried along a swirling flow and back in one loop. Above 0 the noise no
    /// longer changes in place: the smoke travels rather than boils. `sprite.motion` can follow values up to about 0.2.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub travel: f32,
    /// Maximum change of a texel to make the file smaller. Normals in thin smoke may change up to four times as much,
    /// depth and motion half as much. 2 halves the file size without a visible difference.
    #[serde(default, skip_serializing_if = "is_unused")]
    pub tolerance: u32,
}

/// True if the value is the default, as in files without the field.
fn is_unused<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Fields for SpriteRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.seed("seed", &mut self.seed);
        // Bounded because a frame has a quarter of the cube of its side in voxels; the baked sheet must stay within the
        // size limit for reading.
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
        visitor.number("length", &mut self.length, 0.0..=1.0, "half sides");
        visitor.number("upright", &mut self.upright, 0.0..=1.0, "");
        visitor.number("lumps", &mut self.lumps, 0.0..=1.0, "");
        visitor.number("travel", &mut self.travel, 0.0..=1.0, "half sides");
        visitor.integer("tolerance", &mut self.tolerance, 0..=8, "of 255");
    }

    fn headings(&self) -> &'static [FieldHeading] {
        HEADINGS
    }
}

/// Fields in order of display; a name starts a new group. `version` has one value and is not displayed.
const HEADINGS: &[FieldHeading] = &[
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
    ("size", Some("sheet")),
    ("columns", None),
    ("rows", None),
    ("tolerance", None),
];

impl SpriteRecipe {
    /// Loads a `*.sprite.json`.
    ///
    /// # Errors
    /// [`AssetError::Io`], [`AssetError::Text`] or [`AssetError::JsonField`].
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        json::load(path, RECIPE_VERSION, |recipe: &Self| validate(recipe, String::new))
    }

    /// Returns the recipe as JSON that [`SpriteRecipe::load`] reads, ending with a line break.
    pub fn to_json(&self) -> String {
        // Numbers only, so serialisation cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Returns the number of frames on the sheet.
    pub fn frame_count(&self) -> u32 {
        self.columns * self.rows
    }

    /// Reads the recipe of a built-in sprite.
    ///
    /// # Errors
    /// [`AssetError::Text`] if `builtin` is not a sprite.
    pub fn of_builtin(builtin: &Builtin) -> Result<Self, AssetError> {
        json::parse(&builtin_path(builtin.name), builtin.recipe)
    }

    /// Returns the layout of frames on the sheet.
    pub fn layout(&self) -> SpriteLayout {
        SpriteLayout { columns: self.columns, rows: self.rows, y_down: false }
    }
}
