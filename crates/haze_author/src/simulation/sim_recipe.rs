//! Recipes of simulations: the contents of a `*.sim.json`.

use std::path::Path;

use glam::{UVec3, Vec3};
use haze_core::assets::json;
use haze_core::error::{AssetError, FieldError, builtin_path};
use haze_core::settings::choice;
use haze_core::settings::{FieldHeading, FieldVisitor, Fields, validate};
use haze_preset::builtin::Builtin;

use super::source::Source;
use crate::sprite::bake::SheetLayout;

/// Recipe format version that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// Maximum number of sources. Each is evaluated in every step.
const MAX_SOURCES: usize = 64;
/// Maximum number of cells of the velocity, and of the finer gas.
const MAX_CELLS: u32 = 128 * 192 * 128;
const MAX_GAS_CELLS: u32 = 8 * 64 * 96 * 64;

/// Recipe of a simulation: the contents of a `*.sim.json`. Lengths are in box widths: x from -0.5 to 0.5, y from 0 at
/// the bottom of the box, z from its middle to the viewer.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SimRecipe {
    /// Format version.
    pub version: u32,
    /// Resolution of the simulation.
    #[serde(default)]
    pub grid: GridSize,
    /// Sources of smoke, heat and fuel.
    pub sources: Vec<Source>,
    /// Behavior of the gas.
    #[serde(default)]
    pub physics: Physics,
    /// Box that the gas flows around.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<Obstacle>,
    /// Moments that become frames.
    pub time: TimeSpan,
    /// Frames on the sheet.
    #[serde(default)]
    pub sheet: SheetLayout,
    /// Appearance of the smoke in a frame.
    #[serde(default)]
    pub view: View,
}

/// Resolution of a simulation.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct GridSize {
    /// Cells from left to right. Multiple of 4.
    pub width: u32,
    /// Cells from bottom to top. Multiple of 4.
    pub height: u32,
    /// Cells from back to front. Multiple of 4.
    pub depth: u32,
    /// Cells of smoke, heat and fuel along each side of a cell of velocity. 2 draws finer wisps, and takes twice as
    /// long.
    pub detail: u32,
    /// The bottom is closed: gas spreads on it.
    pub ground: bool,
}

impl Default for GridSize {
    fn default() -> Self {
        Self { width: 64, height: 96, depth: 64, detail: 2, ground: false }
    }
}

/// Behavior of the gas.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Physics {
    /// Upward acceleration of gas of heat 1.
    pub buoyancy: f32,
    /// Downward acceleration of gas by smoke of density 1.
    pub weight: f32,
    /// Fraction of the heat that is lost per second.
    pub cooling: f32,
    /// Fraction of the smoke that is lost per second.
    pub dissipation: f32,
    /// Density that all smoke loses per second: eats thin smoke first, and leaves wisps.
    pub erosion: f32,
    /// Strength of the vorticity confinement, which keeps small swirls alive.
    pub vorticity: f32,
    /// Acceleration by swirling noise within the smoke.
    pub turbulence: f32,
    /// Swirls of the turbulence per box width.
    pub turbulence_frequency: f32,
    /// Changes of the turbulence per second.
    pub turbulence_rate: f32,
    /// Fraction of the velocity that is lost per second.
    pub drag: f32,
    /// Velocity of the air at the start.
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub wind: Vec3,
    /// Fuel that burns per second.
    pub burn_rate: f32,
    /// Heat from fuel of amount 1.
    pub burn_heat: f32,
    /// Smoke from fuel of amount 1.
    pub burn_smoke: f32,
    /// Volume that fuel of amount 1 expands to, relative to its own: pushes gas outwards.
    pub burn_expansion: f32,
    /// Different seeds give different turbulence of the same kind.
    pub seed: u32,
}

impl Default for Physics {
    fn default() -> Self {
        Self {
            buoyancy: 2.0,
            weight: 0.0,
            cooling: 0.5,
            dissipation: 0.0,
            erosion: 0.0,
            vorticity: 4.0,
            turbulence: 0.0,
            turbulence_frequency: 6.0,
            turbulence_rate: 0.5,
            drag: 0.0,
            wind: Vec3::ZERO,
            burn_rate: 2.0,
            burn_heat: 1.0,
            burn_smoke: 0.3,
            burn_expansion: 0.0,
            seed: 0,
        }
    }
}

/// Box that the gas flows around.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Middle of the box.
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub position: Vec3,
    /// Half extent along each axis.
    #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
    pub radius: Vec3,
}

impl Obstacle {
    /// True if a position is inside.
    pub fn contains(&self, position: Vec3) -> bool {
        (position - self.position).abs().cmplt(self.radius).all()
    }
}

choice! {
    /// End of a flipbook.
    FrameLoop {
        /// It is played once, over the life of a particle.
        #[default]
        Once = "once",
        /// Its last frames blend into its first ones.
        CrossBlend = "cross_blend",
    }
}

impl FrameLoop {
    /// Returns the number of frames after the sheet's that blend into its first ones. `blend`: fraction of the loop.
    pub fn blended_frames(self, sheet_frames: u32, blend: f32) -> u32 {
        match self {
            Self::Once => 0,
            Self::CrossBlend => (sheet_frames as f32 * blend).round() as u32,
        }
    }
}

/// Moments that become frames.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TimeSpan {
    /// Time before the first frame.
    #[serde(default)]
    pub warm_up: f32,
    /// Time from the first frame to the end of the last.
    pub duration: f32,
    /// End of the flipbook.
    #[serde(default, rename = "loop")]
    pub frame_loop: FrameLoop,
    /// Fraction of the loop in which `cross_blend` blends.
    #[serde(default = "default_blend")]
    pub blend: f32,
}

/// Fraction of the loop in which `cross_blend` blends by default.
pub const DEFAULT_BLEND: f32 = 0.3;

fn default_blend() -> f32 {
    DEFAULT_BLEND
}

choice! {
    /// Part of the box that a frame shows. It is the same in all frames.
    Framing {
        /// The smoke of all frames.
        #[default]
        Smoke = "smoke",
        /// The whole box.
        Box = "box",
    }
}

/// Appearance of the smoke in a frame, seen along z without perspective.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct View {
    /// Part of the box that a frame shows.
    pub framing: Framing,
    /// Clear margin around the smoke.
    pub margin: f32,
    /// Extinction of smoke of density 1 per half side of the frame. Larger values are more opaque and have harder
    /// edges.
    pub extinction: f32,
    /// Weight of fine normals (one texel wide) relative to broad normals (a twelfth of the sprite wide).
    pub bump: f32,
    /// Density of gas by its heat: makes flames visible that have no smoke.
    pub flame: f32,
}

impl Default for View {
    fn default() -> Self {
        Self { framing: Framing::Smoke, margin: 0.06, extinction: 12.0, bump: 0.5, flame: 0.0 }
    }
}

impl Fields for SimRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.group("grid", &mut self.grid);
        for (index, source) in self.sources.iter_mut().enumerate() {
            visitor.item("sources", index, source);
        }
        visitor.group("physics", &mut self.physics);
        if let Some(obstacle) = &mut self.obstacle {
            visitor.group("obstacle", obstacle);
        }
        visitor.group("time", &mut self.time);
        visitor.group("sheet", &mut self.sheet);
        visitor.group("view", &mut self.view);
    }

    fn headings(&self) -> &'static [FieldHeading] {
        HEADINGS
    }
}

/// Fields in order of display. `version` has one value and is not displayed.
const HEADINGS: &[FieldHeading] = &[
    ("grid", None),
    ("sources", None),
    ("physics", None),
    ("obstacle", None),
    ("time", None),
    ("sheet", None),
    ("view", None),
];

impl Fields for GridSize {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("width", &mut self.width, 8..=192, "cells");
        visitor.integer("height", &mut self.height, 8..=192, "cells");
        visitor.integer("depth", &mut self.depth, 8..=192, "cells");
        visitor.integer("detail", &mut self.detail, 1..=2, "");
        visitor.flag("ground", &mut self.ground);
    }
}

impl Fields for Physics {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("buoyancy", &mut self.buoyancy, -50.0..=50.0, "box widths/s²");
        visitor.number("weight", &mut self.weight, -50.0..=50.0, "box widths/s²");
        visitor.number("cooling", &mut self.cooling, 0.0..=50.0, "per second");
        visitor.number("dissipation", &mut self.dissipation, 0.0..=50.0, "per second");
        visitor.number("erosion", &mut self.erosion, 0.0..=50.0, "per second");
        visitor.number("vorticity", &mut self.vorticity, 0.0..=50.0, "");
        visitor.number("turbulence", &mut self.turbulence, 0.0..=50.0, "box widths/s²");
        visitor.number("turbulence_frequency", &mut self.turbulence_frequency, 0.0..=64.0, "per box width");
        visitor.number("turbulence_rate", &mut self.turbulence_rate, 0.0..=60.0, "per second");
        visitor.number("drag", &mut self.drag, 0.0..=50.0, "per second");
        visitor.vector("wind", &mut self.wind, -20.0..=20.0, "box widths/s");
        visitor.number("burn_rate", &mut self.burn_rate, 0.0..=100.0, "per second");
        visitor.number("burn_heat", &mut self.burn_heat, 0.0..=100.0, "");
        visitor.number("burn_smoke", &mut self.burn_smoke, 0.0..=100.0, "");
        visitor.number("burn_expansion", &mut self.burn_expansion, 0.0..=100.0, "");
        visitor.seed("seed", &mut self.seed);
    }
}

impl Fields for Obstacle {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.vector("position", &mut self.position, -4.0..=4.0, "box widths");
        visitor.vector("radius", &mut self.radius, 0.0..=4.0, "box widths");
    }
}

impl Fields for TimeSpan {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("warm_up", &mut self.warm_up, 0.0..=60.0, "s");
        visitor.number("duration", &mut self.duration, 0.01..=60.0, "s");
        visitor.choice("loop", &mut self.frame_loop);
        visitor.number("blend", &mut self.blend, 0.0..=1.0, "");
    }
}

impl Fields for View {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.choice("framing", &mut self.framing);
        visitor.number("margin", &mut self.margin, 0.0..=0.5, "");
        visitor.number("extinction", &mut self.extinction, 0.1..=200.0, "");
        visitor.number("bump", &mut self.bump, 0.0..=10.0, "");
        visitor.number("flame", &mut self.flame, 0.0..=10.0, "");
    }
}

impl SimRecipe {
    /// Loads a `*.sim.json`.
    ///
    /// # Errors
    /// [`AssetError::Io`], [`AssetError::Text`] or [`AssetError::JsonField`].
    pub fn load(path: &Path) -> Result<Self, AssetError> {
        json::load(path, RECIPE_VERSION, Self::validate)
    }

    /// Returns the recipe as JSON that [`Self::load`] reads, ending with a line break.
    pub fn to_json(&self) -> String {
        // Numbers only, so serialization cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Reads a built-in recipe, of [`SIMULATIONS`](haze_preset::builtin::SIMULATIONS).
    ///
    /// # Errors
    /// [`AssetError::Text`] or [`AssetError::JsonField`]; a test shows that there are none.
    pub fn of_built_in(builtin: &Builtin) -> Result<Self, AssetError> {
        let text = String::from_utf8_lossy(builtin.bytes);
        json::parse(&builtin_path(builtin.name), &text)
    }

    /// Checks ranges, the size of the grid and the number of sources.
    ///
    /// # Errors
    /// The first field that is not valid.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate(self, String::new)?;
        let GridSize { width, height, depth, detail, .. } = self.grid;
        for (field, side) in [("grid.width", width), ("grid.height", height), ("grid.depth", depth)] {
            if side % 4 != 0 {
                return Err(FieldError::new(field, side, "a multiple of 4"));
            }
        }
        let cells = width * height * depth;
        if cells > MAX_CELLS {
            let given = format!("{width}x{height}x{depth}");
            return Err(FieldError::new("grid", given, "at most 128x192x128 cells"));
        }
        if cells * detail.pow(3) > MAX_GAS_CELLS {
            return Err(FieldError::new("grid.detail", detail, "1 for more than 64x96x64 cells"));
        }
        if self.sources.is_empty() || self.sources.len() > MAX_SOURCES {
            return Err(FieldError::new("sources", self.sources.len(), format!("1 to {MAX_SOURCES} sources")));
        }
        Ok(())
    }

    /// Returns the same simulation on half the grid with a quarter of the frames.
    #[must_use]
    pub fn preview(&self) -> Self {
        let half = |side: u32| (side / 8 * 4).max(8);
        let mut preview = self.clone();
        preview.grid.width = half(self.grid.width);
        preview.grid.height = half(self.grid.height);
        preview.grid.depth = half(self.grid.depth);
        preview.sheet.columns = self.sheet.columns.div_ceil(2);
        preview.sheet.rows = self.sheet.rows.div_ceil(2);
        preview
    }

    /// True if fuel burns, so that frames have a heat map.
    pub fn burns(&self) -> bool {
        self.sources.iter().any(|source| source.fuel > 0.0) || self.view.flame > 0.0
    }

    /// Cells of the velocity.
    pub(super) fn cells(&self) -> UVec3 {
        UVec3::new(self.grid.width, self.grid.height, self.grid.depth)
    }
}
