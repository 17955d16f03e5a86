//! Sides that smoke is lit from.

use haze_core::settings::choice;

choice! {
    /// Side that light comes from.
    Side {
        /// Right.
        #[default]
        Right = "right",
        /// Left.
        Left = "left",
        /// Top.
        Top = "top",
        /// Bottom.
        Bottom = "bottom",
        /// Back.
        Back = "back",
        /// Front: the viewer.
        Front = "front",
    }
}
