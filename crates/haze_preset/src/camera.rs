//! Camera of a preset.

use haze_core::glam::camera::rh;
use haze_core::glam::{UVec2, Vec3};

use haze_core::frame::{FOV_RANGE, View};
use haze_core::settings::{Tonemap, settings};

settings! {
    /// Perspective camera.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Camera {
        /// Position in world space, metres. Inside the smoke, sprites fade before they reach the camera.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        position: Vec3 = Vec3::new(0.0, 2.0, 8.0), vector(-1.0e5..=1.0e5, "m");
        /// Point in the middle of the image, metres.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        target: Vec3 = Vec3::new(0.0, 1.5, 0.0), vector(-1.0e5..=1.0e5, "m");
        /// Vertical field of view, degrees. Lower: brings the smoke near and flattens it. Higher: shows more of the
        /// scene around it.
        fov: f32 = 45.0, number(FOV_RANGE, "degrees");
        /// Near plane, metres. Anything nearer is cut off.
        near: f32 = 0.1, number(0.001..=100.0, "m");
        /// Far plane, metres. Anything beyond is cut off.
        far: f32 = 200.0, number(|this| this.near * 1.01..=1.0e5, "m");
        /// Multiplies the linear image by 2^exposure before it is tonemapped. Each step up doubles the light; glow
        /// turns white.
        exposure: f32 = 0.0, number(-16.0..=16.0, "EV");
        /// Tonemap of the program's images. An engine has its own: choose the one that is most like it.
        tonemap: Tonemap = Tonemap::default(), choice;
        /// Fraction of the light that the lens spreads around bright areas: fire and sparks glow into the air. 0.05 is a clean
        /// lens, 0.3 a dreamy one. Images of smoke alone have none: it belongs to the engine that shows them.
        bloom: f32 = 0.0, number(0.0..=1.0, "");
        /// Smooths edges of what is thin and far brighter than what is behind it, such as sparks. Images of smoke alone are not
        /// smoothed.
        antialiasing: bool = false, flag;
        /// Bends light in the hot air above flames, so that the scene behind it shimmers. 0.3 is a campfire on a warm night, 1 a
        /// furnace. Fires that cast no light have no hot air, and images of smoke alone show none: it belongs to the engine that
        /// shows them.
        heat_haze: f32 = 0.0, number(0.0..=1.0, "");
    }
}

impl Camera {
    /// View of an image of this size.
    pub fn view(&self, size: UVec2) -> View {
        let aspect = size.x.max(1) as f32 / size.y.max(1) as f32;
        // When looking straight up or down, x stays to the right.
        let forward = (self.target - self.position).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.9999 { Vec3::Z * forward.y.signum() } else { Vec3::Y };
        let clip_from_view = rh::proj::directx::perspective(self.fov.to_radians(), aspect, self.near, self.far);
        View::new(rh::view::look_to_mat4(self.position, forward, up), clip_from_view, size)
    }
}
