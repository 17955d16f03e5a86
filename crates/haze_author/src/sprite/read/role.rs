//! Contents of a file.

use haze_core::settings::choice;

choice! {
    /// Contents of a file.
    Role {
        /// Gray = amount, or alpha.
        #[default]
        Opacity = "opacity",
        /// rgb = normals, a = amount.
        Normals = "normals",
        /// One of two light maps of three sides each.
        SixWay = "six_way",
        /// Red and green = motion to the next frame.
        Motion = "motion",
        /// rgb = light of fire.
        Emission = "emission",
        /// Gray = heat.
        Heat = "heat",
        /// Gray = depth.
        Depth = "depth",
        /// rgb = color of lit smoke, a = amount.
        Color = "color",
    }
}
