//! Ramps, sprites and presets that are embedded in the library.

use haze_core::assets::image::{decode_color_png, decode_png};
use haze_core::assets::json;
use haze_core::assets::noise::NoiseVolume;
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::{AssetError, builtin_path};
use haze_core::settings::ImageRole;

/// A built-in file: its name and contents.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Builtin {
    /// Name without folder and extension.
    pub name: &'static str,
    /// The PNG, or the JSON of a preset or a simulation.
    pub bytes: &'static [u8],
    /// The recipe's JSON; empty for presets, simulations and detail maps.
    pub recipe: &'static str,
}

/// Path from this file to the folders of built-in files, found by build.rs.
#[cfg(has_folders)]
macro_rules! top {
    () => {
        "../"
    };
}
#[cfg(not(has_folders))]
macro_rules! top {
    () => {
        "../../../"
    };
}

macro_rules! builtin {
    ($folder:literal, $kind:literal, [$($name:literal),+ $(,)?]) => {
        &[$(Builtin {
            name: $name,
            bytes: include_bytes!(concat!(top!(), $folder, "/", $name, ".png")),
            recipe: include_str!(concat!(top!(), $folder, "/", $name, $kind)),
        }),+]
    };
}

/// Ramps of every role; `ramps/README.md` describes them.
pub const RAMPS: &[Builtin] = builtin!(
    "ramps",
    ".ramp.json",
    [
        "diffuse_soft",
        "diffuse_dusk",
        "diffuse_ember",
        "diffuse_overcast",
        "diffuse_neutral",
        "diffuse_steam",
        "diffuse_sand",
        "diffuse_soot",
        "diffuse_moon",
        "diffuse_night_lamp",
        "diffuse_sunset_backlight",
        "diffuse_soft_toon",
        "diffuse_ink",
        "diffuse_traced_steam",
        "diffuse_traced_ash",
        "diffuse_traced_soot",
        "diffuse_traced_dust",
        "diffuse_traced_diesel",
        "diffuse_traced_milk",
        "backlight_traced_steam",
        "backlight_traced_ash",
        "backlight_traced_soot",
        "backlight_traced_dust",
        "backlight_traced_diesel",
        "backlight_traced_milk",
        "shadow_neutral",
        "shadow_golden",
        "shadow_cold",
        "shadow_toon",
        "shadow_traced_steam",
        "shadow_traced_ash",
        "shadow_traced_soot",
        "shadow_traced_dust",
        "shadow_traced_diesel",
        "shadow_traced_milk",
        "shadow_six_way_steam",
        "shadow_six_way_ash",
        "shadow_six_way_soot",
        "shadow_six_way_dust",
        "shadow_six_way_diesel",
        "shadow_six_way_milk",
        "scatter_mist",
        "scatter_soot",
        "specular_halo",
        "specular_ember",
        "specular_neutral",
        "age_smoke",
        "heat_flame",
        "heat_blast",
        "heat_even",
        "fire_campfire",
        "fire_oil",
        "fire_black_body",
        "fire_lava",
        "fire_gas",
        "fire_magic",
        "fire_plasma",
        "coverage_soft",
        "coverage_toon",
        "coverage_wispy",
        "coverage_cut",
    ]
);

/// Motifs: painted images of a lit sphere.
pub const MOTIFS: &[Builtin] = builtin!("ramps", ".motif.json", ["motif_studio"]);

/// Flipbooks of normal maps.
pub const SPRITES: &[Builtin] =
    builtin!("sprites", ".sprite.json", ["puff", "wisp", "billow", "ball", "cauliflower", "strands", "streaks"]);

macro_rules! details {
    ([$($name:literal),+ $(,)?]) => {
        &[$(Builtin {
            name: $name,
            bytes: include_bytes!(concat!(top!(), "sprites/", $name, ".detail.png")),
            recipe: "",
        }),+]
    };
}

/// Detail maps (depth and motion) of the flipbooks, under the same names.
pub const DETAILS: &[Builtin] = details!(["puff", "wisp", "billow", "ball", "cauliflower", "strands", "streaks"]);

/// Tiling 3D noise volumes.
pub const NOISES: &[Builtin] = builtin!("sprites", ".noise.json", ["fbm"]);

macro_rules! json_files {
    ($folder:literal, $kind:literal, [$($name:literal),+ $(,)?]) => {
        &[$(Builtin {
            name: $name,
            bytes: include_bytes!(concat!(top!(), $folder, "/", $name, $kind)),
            recipe: "",
        }),+]
    };
}

/// Recipes of simulations.
pub const SIMULATIONS: &[Builtin] = json_files!(
    "simulations",
    ".sim.json",
    ["puff", "mushroom", "rising_column", "flame_lick", "burst", "ground_dust"]
);

/// Presets; the first is the default.
pub const PRESETS: &[Builtin] = json_files!(
    "presets",
    ".json",
    [
        "column",
        "backlit_fog",
        "corridor",
        "colored_lights",
        "fence",
        "inside",
        "crates",
        "dust_storm",
        "campfire",
        "oil_fire",
        "fireball",
        "steam_vent",
        "spell",
        "wildfire_sky"
    ]
);

/// Layers, in the order of their shelf: presets of one system.
pub(crate) const LAYERS: &[Builtin] = json_files!(
    "presets",
    ".json",
    [
        "layers/smoke",
        "layers/steam",
        "layers/flame",
        "layers/sparks",
        "layers/embers",
        "layers/ground_dust",
        "layers/shock_ring",
        "layers/magic_wisps",
        "layers/heat_shimmer"
    ]
);

/// Returns the built-in images for a role; empty for details and six-way maps.
pub fn for_role(role: ImageRole) -> &'static [Builtin] {
    match role {
        ImageRole::Sprite => SPRITES,
        ImageRole::Ramp => RAMPS,
        ImageRole::Motif => MOTIFS,
        ImageRole::Noise => NOISES,
        ImageRole::Detail | ImageRole::SixWay => &[],
    }
}

/// Finds a built-in by name.
pub fn find(list: &'static [Builtin], name: &str) -> Option<&'static Builtin> {
    list.iter().find(|builtin| builtin.name == name)
}

impl Builtin {
    /// Decodes a ramp or a motif.
    ///
    /// # Errors
    /// As [`decode_color_png`].
    pub fn ramp(&self) -> Result<Ramp, AssetError> {
        Ok(Ramp::from_image(&decode_color_png(&builtin_path(self.name), self.bytes)?))
    }

    /// Decodes a sprite with the layout of its recipe.
    ///
    /// # Errors
    /// As [`decode_png`] and [`Sprite::from_image`].
    pub fn sprite(&self) -> Result<Sprite, AssetError> {
        self.decode(self.sprite_layout()?)
    }

    /// Decodes the sprite's detail map, if it has one.
    ///
    /// # Errors
    /// As [`Builtin::sprite`].
    pub fn detail(&self) -> Result<Option<Sprite>, AssetError> {
        let layout = self.sprite_layout()?;
        find(DETAILS, self.name).map(|detail| detail.decode(layout)).transpose()
    }

    /// The sheet's layout, from its recipe; bakes point y up.
    pub fn sprite_layout(&self) -> Result<SpriteLayout, AssetError> {
        #[derive(serde::Deserialize)]
        struct Sheet {
            columns: u32,
            rows: u32,
        }
        let Sheet { columns, rows } = json::parse(&builtin_path(self.name), self.recipe)?;
        Ok(SpriteLayout { columns, rows, y_down: false })
    }

    fn decode(&self, layout: SpriteLayout) -> Result<Sprite, AssetError> {
        let path = builtin_path(self.name);
        Sprite::from_image(&path, &decode_png(&path, self.bytes)?.to_rgba8(), layout)
    }

    /// Decodes a noise volume.
    ///
    /// # Errors
    /// As [`decode_png`] and [`NoiseVolume::from_image`].
    pub fn noise(&self) -> Result<NoiseVolume, AssetError> {
        let path = builtin_path(self.name);
        NoiseVolume::from_image(&path, &decode_png(&path, self.bytes)?.to_rgba8())
    }
}
