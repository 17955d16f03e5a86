//! Engines that looks and images are exported for, and their conventions.

use haze_author::sprite::six_way::Packing;

/// Engine to export for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(not(target_arch = "wasm32"), derive(clap::ValueEnum))]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    /// Unreal Engine.
    #[default]
    Unreal,
    /// Unity.
    Unity,
    /// Godot 4.
    Godot,
    /// WGSL, for wgpu and Bevy.
    Wgsl,
    /// three.js.
    Three,
    /// Babylon.js. Flipbooks alone.
    Babylon,
    /// PlayCanvas. Flipbooks alone.
    Playcanvas,
}

impl Engine {
    /// Returns true if the first row of an image has the texture coordinate 0. Unity flips images when it imports them.
    pub fn first_row_is_at_the_top(self) -> bool {
        self != Self::Unity
    }

    /// Returns true if green of a normal map points up, as in OpenGL; in Unreal Engine it points down.
    pub fn normals_point_up(self) -> bool {
        self != Self::Unreal
    }

    /// Returns true if the shader of a material gets the age of each particle.
    pub fn knows_age(self) -> bool {
        matches!(self, Self::Godot | Self::Three)
    }

    /// Returns true if a material comes with the sprite.
    pub fn takes_sprite(self) -> bool {
        matches!(self, Self::Godot | Self::Three)
    }

    /// Order of the sides in two maps of six-way light.
    pub fn six_way_packing(self) -> Packing {
        match self {
            Self::Unity => Packing::Unity,
            Self::Unreal | Self::Godot | Self::Wgsl | Self::Three | Self::Babylon | Self::Playcanvas => Packing::RltBbf,
        }
    }
}
