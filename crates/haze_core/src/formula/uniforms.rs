//! Rust mirrors of the WGSL structs. `tests/suite/shader_layout.rs` compares each with its WGSL struct: field names,
//! offsets and sizes.

use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Mat4, Vec2, Vec3, Vec4};

/// Field of a uniform struct: name, offset and size in bytes.
pub type UniformField = (&'static str, usize, usize);

/// Defines a uniform struct with a list of its fields, which are documented in WGSL.
macro_rules! uniform {
    ($(#[$meta:meta])* $name:ident { $($field:ident: $type:ty,)+ }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
        #[allow(missing_docs, reason = "documented in WGSL")]
        pub struct $name { $(pub $field: $type,)+ }

        impl $name {
            /// All fields, in order of declaration.
            pub const FIELDS: &[UniformField] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$type>()),)+];
        }
    };
}

uniform! {
    /// `View` in `shaders/lib/view.wgsl`.
    ViewUniform {
        view_from_world: Mat4,
        clip_from_view: Mat4,
        depth_coefficients: Vec4,
        ray_scale: Vec2,
        ray_offset: Vec2,
        size: Vec2,
        origin: Vec2,
        near: f32,
        far: f32,
        orthographic: f32,
        depth_offset: f32,
    }
}

uniform! {
    /// `Light` in `shaders/lib/lighting.wgsl`.
    LightUniform {
        position: Vec3,
        inverse_range: f32,
        direction: Vec3,
        directional: f32,
        color: Vec3,
        specular_scatter: f32,
        spot_scale: f32,
        spot_offset: f32,
        radius: f32,
        shadow_slot: f32,
    }
}

uniform! {
    /// `System` in `shaders/lib/system.wgsl`.
    SystemUniform {
        view_from_particles: Mat4,
        bounds_min: Vec3,
        bounds_near: f32,
        bounds_max: Vec3,
        opacity: f32,
        center: Vec3,
        smoke_near: f32,
        smoke_far: f32,
        smoke_depth_limit: f32,
        depth_limit: f32,
        scale: u32,
        scatter_color: Vec3,
        scatter_amount: f32,
        ambient_color: Vec3,
        scatter_smooth: f32,
        target_from_ndc: Vec4,
        target_origin: Vec2,
        target_size: Vec2,
        sprite_size: f32,
        frame_count: f32,
        boost: f32,
        fade_scale: f32,
        contrast_power: f32,
        epsilon: f32,
        near_fade_start: f32,
        near_fade_end: f32,
        diffuse_intensity: f32,
        soft_scatter_intensity: f32,
        specular_scatter_size: f32,
        specular_scatter_intensity: f32,
        light_count: u32,
        size: f32,
        motion: f32,
        age_color: f32,
        detail_lod: f32,
        billboard_radius: f32,
        billboard_density: f32,
        density: f32,
        noise_size: f32,
        volume_opacity: f32,
        depth_weight: f32,
        alive_count: u32,
        mean_alpha: f32,
        peak_alpha: f32,
        eroded_fraction: f32,
        specular_scatter_falloff: f32,
        noise_offset: Vec3,
        show_through_distance: f32,
        six_way_color: Vec3,
        six_way_anisotropy: f32,
        optical_depth_knots: [Vec4; 4],
        spherical_harmonics: [Vec4; 9],
        grid_from_view: Mat4,
        grid_size: Vec3,
        cells_per_metre: f32,
        up: Vec3,
        shadow_strength: f32,
        sky_color: Vec3,
        shadow_density: f32,
        ground_color: Vec3,
        density_reach: f32,
        visibility_block: f32,
        openness_block: f32,
        fire_intensity: f32,
        fire_core: f32,
        fire_crust: f32,
        tint: f32,
        stretch: f32,
        stretch_limit: f32,
        grain_erosion: f32,
        grain_dissolve: f32,
        grain_bump: f32,
        grain_tiles: f32,
        stretch_axis: Vec3,
        grain_fineness: f32,
    }
}

uniform! {
    /// `ShadowMarch` in `shaders/shadow_march.wgsl`.
    ShadowMarchUniform {
        lights: [Vec4; 15],
        radii: [Vec4; 5],
        sky: [Vec4; 4],
        size: Vec3,
        resolution: u32,
        extent: Vec3,
        openness_block: u32,
        light_blocks: u32,
        padding: [u32; 3],
    }
}

uniform! {
    /// `ShadowMap` in `shaders/lib/shadow_map_lookup.wgsl`.
    ShadowMapUniform {
        clip_from_grid: [Mat4; 6],
        layers: u32,
        reversed: u32,
        bias: f32,
        padding: f32,
    }
}

uniform! {
    /// `ShadowVisibility` in `shaders/lib/shadow_map_lookup.wgsl`.
    ShadowVisibilityUniform {
        maps: [ShadowMapUniform; 3],
        size: Vec3,
        first_cell: u32,
    }
}

uniform! {
    /// `SceneShadow` in `shaders/lib/haze_transmittance.wgsl`.
    SceneShadowUniform {
        origin: Vec3,
        cells_per_metre: f32,
        extent: Vec3,
        strength: f32,
        lights: [Vec4; 15],
        indices: [u32; 16],
    }
}

uniform! {
    /// `ScreenShadow` in `shaders/screen_shadow.wgsl`.
    ScreenShadowUniform {
        world_from_view: Mat4,
        ambient: Vec3,
        light_count: u32,
    }
}

uniform! {
    /// `Splat` in `shaders/density_splat.wgsl`.
    SplatUniform {
        count: u32,
        first: u32,
        columns: u32,
        padding: u32,
    }
}

uniform! {
    /// `Measure` in `shaders/measure.wgsl`.
    MeasureUniform {
        count: u32,
        first: u32,
        workgroups: u32,
        keeps_depth: u32,
        fade_distance: f32,
        padding: [f32; 3],
    }
}

uniform! {
    /// `Tiles` in `shaders/lib/tiles.wgsl`.
    TilesUniform {
        count: u32,
        loops: u32,
        first: u32,
        blocks: u32,
        bin_side: u32,
        columns: u32,
        rows: u32,
        runs: u32,
        capacity: u32,
        occlusion_margin: f32,
        padding: [u32; 2],
    }
}

uniform! {
    /// `Emitter` in `shaders/lib/flight.wgsl`.
    EmitterUniform {
        first: u32,
        count: u32,
        seed: u32,
        shape: u32,
        since_first: f32,
        rate: f32,
        lifetime: f32,
        lifetime_spread: f32,
        position: Vec3,
        burst: f32,
        extent: Vec3,
        velocity_spread: f32,
        velocity: Vec3,
        drag: f32,
        rise: Vec3,
        swirl_strength: f32,
        wind: Vec3,
        swirl_frequency: f32,
        disc_x: Vec3,
        radius_start: f32,
        disc_z: Vec3,
        radius_end: f32,
        swirl_turn: f32,
        swirl_turn_rate: f32,
        radius_spread: f32,
        spin: f32,
        amount: f32,
        fade_in: f32,
        fade_out: f32,
        frame_rate: f32,
        tint: Vec3,
        heat_spread: f32,
        other_tint: Vec3,
        bounce: f32,
        up: Vec3,
        floor: f32,
        per_pulse: u32,
        first_in_pulse: u32,
        period: f32,
        has_curves: u32,
        speed_curve: [Vec4; 4],
        size_curve: [Vec4; 4],
        amount_curve: [Vec4; 4],
        rate_curve: [Vec4; 4],
        anchor: f32,
        rotation_spread: f32,
        has_rate_curve: u32,
        swirl_detail: f32,
        swirl_travel: Vec3,
        ring_rate: f32,
        swirl_offset: Vec3,
        ring_phase: f32,
        swirl_first: IVec3,
        ring_first: u32,
        wind_shear: Vec3,
        ring_speed: f32,
        attractor: Vec3,
        attraction: f32,
        ring_size: f32,
        attractor_size: f32,
        orbit_rate: f32,
        has_flow: u32,
        small_fraction: f32,
        small_size: f32,
        floor_margin: f32,
        obstacle_margin: f32,
        obstacle: Vec3,
        obstacle_rounding: f32,
        obstacle_core: Vec3,
        padding: f32,
    }
}
