// One particle system in this view. Mirrors SystemUniform in crates/haze_core/src/formula/uniforms.rs. Fields named like settings have
// the values of those settings.

struct System {
    view_from_particles: mat4x4f,
    // World space.
    bounds_min: vec3f,
    // View depth of the box's near side.
    bounds_near: f32,
    bounds_max: vec3f,
    opacity: f32,
    // View space: the middle of the smoke. Light is evaluated on the plane through it that faces the viewer. This field
    // and the next three are measured on the GPU for particles that the CPU cannot read.
    center: vec3f,
    // Most of the smoke lies between this view depth and smoke_far.
    smoke_near: f32,
    smoke_far: f32,
    // Like depth_limit, but from the visible smoke: it does not jump with the box.
    smoke_depth_limit: f32,
    // Depths beyond this are equivalent for the system: the far side of the box plus the length of the fade.
    depth_limit: f32,
    // Pixels per reduced texel.
    scale: u32,
    scatter_color: vec3f,
    scatter_amount: f32,
    ambient_color: vec3f,
    scatter_smooth: f32,
    // NDC of the accumulation target = NDC of the view · xy + zw.
    target_from_ndc: vec4f,
    // Reduced texels.
    target_origin: vec2f,
    target_size: vec2f,
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
    // Number of mip levels by which the detail map is smaller than the sprite.
    detail_lod: f32,
    billboard_radius: f32,
    billboard_density: f32,
    density: f32,
    noise_size: f32,
    volume_opacity: f32,
    depth_weight: f32,
    // Particles from this index on are not drawn. Copied from a host's buffer if only the GPU knows it.
    alive_count: u32,
    // Density of the sprite: see mean_optical_depth().
    mean_alpha: f32,
    peak_alpha: f32,
    // Fraction of the sprite's alpha that remains at an erosion of 1.
    eroded_fraction: f32,
    specular_scatter_falloff: f32,
    // Position of the eye minus the rise of the noise, metres, modulo one tile.
    noise_offset: vec3f,
    // Metres behind the scene at which sprites still show, under the curve `always`.
    show_through_distance: f32,
    // Linear RGB of smoke that is lit by six-way maps.
    six_way_color: vec3f,
    six_way_anisotropy: f32,
    // Optical depth of the smoke in front of sixteen view depths.
    optical_depth_knots: array<vec4f, 4>,
    // Diffuse light as spherical harmonics, rgb.
    spherical_harmonics: array<vec4f, 9>,
    // Density grid, in cells.
    grid_from_view: mat4x4f,
    grid_size: vec3f,
    cells_per_metre: f32,
    // View space, unit length.
    up: vec3f,
    // 0: no shadow.
    shadow_strength: f32,
    // Light from above, exposed.
    sky_color: vec3f,
    shadow_density: f32,
    // Light from below, exposed.
    ground_color: vec3f,
    // Extent of a sprite's density, as a fraction of the sprite's.
    density_reach: f32,
    // Blocks of the volume that hold the lights' visibility past the scene, and openness to sky and ground; 0 for none.
    visibility_block: f32,
    openness_block: f32,
    // Of the fire ramp, exposed.
    fire_intensity: f32,
    fire_core: f32,
    fire_crust: f32,
    // Weight of the particles' own colors.
    tint: f32,
    // Time for which the shutter is open, seconds, and the largest length, in lengths of the sprite at rest.
    stretch: f32,
    stretch_limit: f32,
    grain_erosion: f32,
    grain_dissolve: f32,
    grain_bump: f32,
    grain_tiles: f32,
    // World space; 0 for the sprites' own velocities.
    stretch_axis: vec3f,
    // Texels of the noise per pixel, on a sprite whose radius is 1 at a view depth of 1.
    grain_fineness: f32,
}
