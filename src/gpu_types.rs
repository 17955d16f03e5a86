//! Every struct that WGSL sees. `tests/suite/shader_layout.rs` holds each against its WGSL twin: name, offset, size.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// `View` in `shaders/lib/view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented in WGSL")]
pub struct ViewUniform {
    pub view_from_world: Mat4,
    pub clip_from_view: Mat4,
    pub depth_coefficients: Vec4,
    pub ray_scale: Vec2,
    pub ray_offset: Vec2,
    pub size: Vec2,
    pub near: f32,
    pub far: f32,
    pub orthographic: f32,
    pub padding: [f32; 3],
}

/// `Light` in `shaders/lib/lighting.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented in WGSL")]
pub struct LightUniform {
    pub position: Vec3,
    pub inverse_range: f32,
    pub direction: Vec3,
    pub directional: f32,
    pub colour: Vec3,
    pub specular_scatter: f32,
    pub spot_scale: f32,
    pub spot_offset: f32,
    pub radius: f32,
    pub padding: f32,
}

/// `System` in `shaders/lib/system.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented in WGSL")]
pub struct SystemUniform {
    pub bounds_min: Vec3,
    pub bounds_near: f32,
    pub bounds_max: Vec3,
    pub bounds_far: f32,
    pub bounds_centre: Vec3,
    pub plane_depth: f32,
    pub scatter_colour: Vec3,
    pub scatter_amount: f32,
    pub ambient_colour: Vec3,
    pub scatter_smooth: f32,
    pub target_from_ndc: Vec4,
    pub target_origin: Vec2,
    pub target_size: Vec2,
    pub scale: f32,
    pub depth_limit: f32,
    pub sprite_size: f32,
    pub frame_count: f32,
    pub opacity: f32,
    pub boost: f32,
    pub fade_scale: f32,
    pub contrast_power: f32,
    pub epsilon: f32,
    pub near_fade_start: f32,
    pub near_fade_end: f32,
    pub diffuse_intensity: f32,
    pub soft_scatter_intensity: f32,
    pub specular_scatter_size: f32,
    pub specular_scatter_intensity: f32,
    pub light_count: u32,
    pub size: f32,
    pub motion: f32,
    pub age_colour: f32,
    pub detail_lod: f32,
    pub billboard_radius: f32,
    pub billboard_density: f32,
    pub density: f32,
    pub noise_size: f32,
    pub volume_opacity: f32,
    pub march_steps: u32,
    pub noise_octaves: u32,
    pub noise_scroll: f32,
    pub fade_through: f32,
    pub padding: [f32; 3],
    pub spherical_harmonics: [Vec4; 9],
}
