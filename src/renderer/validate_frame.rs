//! Validation of a frame for the GPU renderer.

use haze_core::error::FieldError;
use haze_core::frame::validate_input::{
    validate_bounds_and_depth, validate_frame_numbers, validate_lights, validate_settings, validate_shadow_projections,
    validate_world_from_particles,
};
use haze_core::frame::{Particle, SpriteExtent, View};
use haze_core::glam::UVec2;
use haze_core::settings::{DepthSource, RenderPath, Technique};

use super::context::Shared;
use super::gpu::capabilities::array_layers;
use super::gpu::host_pass::HostPass;
use super::plan::reads_linear_target;
use super::targets::validate_attachments;
use super::tiled::{PARTICLE_ALIGNMENT, TILE_SPRITE_BYTES};
use crate::frame::{AliveCount, FrameInput, ParticleBuffer, ParticleSystem, Particles, SceneDepth, ShadowMap};

/// Validates everything except the view's matrices.
///
/// # Errors
/// Names the first field that is not valid.
pub(crate) fn validate(shared: &Shared, host: &HostPass, frame: &FrameInput<'_>) -> Result<(), FieldError> {
    validate_frame_numbers(frame.exposure, frame.time, frame.up, frame.scene_ambient)?;
    let size = validate_scene_depth(shared, frame)?;
    if frame.view.origin.saturating_add(frame.view.size).cmpgt(size).any() {
        let View { size: pixels, origin, .. } = frame.view;
        let [x, y] = origin.to_array();
        let problem = format!("{}x{} from ({x}, {y}) is not inside the scene depth", pixels.x, pixels.y);
        let expected = format!("the size of the scene depth, {}x{}, or a part of it", size.x, size.y);
        return Err(FieldError::from_problem("view.size", problem, expected));
    }
    let reads_attached = host.depth_format.is_some() && frame.scene_depth.linear().is_none();
    if reads_attached && !shared.read_only_depth && host.sample_count == 1 {
        let expected = "SceneDepth::Linear or BufferAndLinear, or a descriptor with depth_format None: this backend (OpenGL) \
                        cannot sample the depth buffer that the pass tests";
        return Err(FieldError::new("scene_depth", "SceneDepth::Buffer", expected));
    }
    validate_lights(frame.lights)?;
    validate_shadow_projections(frame.lights.len(), frame.shadow_maps.iter().map(|map| map.projection))?;
    for (index, map) in frame.shadow_maps.iter().enumerate() {
        validate_shadow_map(shared, index, map)?;
    }
    for (index, system) in frame.systems.iter().enumerate() {
        if let Some(other) = frame.systems[..index].iter().position(|other| other.key == system.key) {
            let problem = format!("{} is also the key of systems[{other}]", system.key);
            return Err(FieldError::from_problem(format!("systems[{index}].key"), problem, "a unique key"));
        }
        validate_system(shared, index, frame, system)?;
    }
    Ok(())
}

/// Returns the size of the host's targets, pixels.
pub(crate) fn host_size(frame: &FrameInput<'_>) -> UVec2 {
    frame.target_size.unwrap_or_else(|| depth_size(&frame.scene_depth))
}

/// Returns the size of the texture that holds the scene depth, pixels.
fn depth_size(scene_depth: &SceneDepth<'_>) -> UVec2 {
    let texture = scene_depth.texture();
    UVec2::new(texture.width(), texture.height())
}

fn validate_scene_depth(shared: &Shared, frame: &FrameInput<'_>) -> Result<UVec2, FieldError> {
    let size = depth_size(&frame.scene_depth);
    if let Some(target_size) = frame.target_size {
        let is_level = |level: u32| (size >> level).max(UVec2::ONE) == target_size;
        let levels = frame.scene_depth.texture().mip_level_count();
        if !(0..levels).any(is_level) {
            let value = format!("{}x{}", target_size.x, target_size.y);
            let expected =
                format!("the size of one of the {levels} mip levels of the scene depth, {}x{}", size.x, size.y);
            return Err(FieldError::new("target_size", value, expected));
        }
    }
    if let SceneDepth::Multisampled(buffer) = frame.scene_depth {
        if !shared.read_only_depth {
            let expected = "Buffer, Linear or BufferAndLinear: this backend (OpenGL) cannot read multisampled depth";
            return Err(FieldError::new("scene_depth", "Multisampled", expected));
        }
        if buffer.texture().sample_count() < 2 {
            let problem = "Multisampled has 1 sample per pixel";
            return Err(FieldError::from_problem("scene_depth", problem, "SceneDepth::Buffer"));
        }
        let is_depth = buffer.texture().format().has_depth_aspect();
        validate_depth_format_and_usage(buffer.texture(), is_depth, "a depth format")?;
    }
    if let Some(buffer) = frame.scene_depth.buffer() {
        let is_depth = buffer.texture().format().has_depth_aspect();
        validate_depth_texture(size, buffer, is_depth, "a depth format for the depth buffer")?;
    }
    if let Some(linear) = frame.scene_depth.linear() {
        let is_linear = linear.texture().format() == wgpu::TextureFormat::R32Float;
        validate_depth_texture(size, linear, is_linear, "R32Float for the linear target")?;
    }
    Ok(host_size(frame))
}

fn validate_shadow_map(shared: &Shared, index: usize, map: &ShadowMap<'_>) -> Result<(), FieldError> {
    let refuse =
        |problem, expected| Err(FieldError::from_problem(format!("shadow_maps[{index}].depth"), problem, expected));
    let texture = map.depth;
    if !texture.format().has_depth_aspect() {
        return refuse(format!("has the format {:?}", texture.format()), "a depth format");
    }
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != 1 {
        return refuse("is not a single-sampled 2D texture".into(), "one with a layer per matrix");
    }
    if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        return refuse(format!("has the usage {:?}", texture.usage()), "TEXTURE_BINDING");
    }
    let layers = texture.depth_or_array_layers();
    let needed = map.projection.clip_from_world.len() as u64;
    if u64::from(map.first_layer) + needed > u64::from(layers) {
        let problem = format!("has {layers} layers");
        return refuse(problem, "a layer per matrix, from first_layer on");
    }
    // The flag is off on OpenGL.
    if array_layers(layers) != layers && !shared.read_only_depth {
        let expected = "another number than 1 and the multiples of 6 on this backend (OpenGL), which takes them for no array and \
                        for cubes";
        return refuse(format!("has {layers} layers"), expected);
    }
    Ok(())
}

fn validate_depth_texture(
    size: UVec2,
    depth: &wgpu::TextureView,
    format_fits: bool,
    expected: &str,
) -> Result<(), FieldError> {
    let texture = depth.texture();
    let refuse = |problem: String, expected: &str| Err(FieldError::from_problem("scene_depth", problem, expected));
    if (texture.width(), texture.height()) != (size.x, size.y) {
        let problem = format!("{}x{} is not the size of the other depth", texture.width(), texture.height());
        return refuse(problem, &format!("{}x{}", size.x, size.y));
    }
    if texture.sample_count() != 1 {
        let problem = format!("has {} samples per pixel", texture.sample_count());
        return refuse(problem, "1, or SceneDepth::Multisampled");
    }
    validate_depth_format_and_usage(texture, format_fits, expected)
}

fn validate_depth_format_and_usage(
    texture: &wgpu::Texture,
    format_fits: bool,
    expected: &str,
) -> Result<(), FieldError> {
    let refuse = |problem: String, expected: &str| Err(FieldError::from_problem("scene_depth", problem, expected));
    if !format_fits {
        return refuse(format!("{:?} is not valid", texture.format()), expected);
    }
    if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        let problem = format!("usage {:?} lacks TEXTURE_BINDING", texture.usage());
        return refuse(problem, "a usage that includes TEXTURE_BINDING");
    }
    Ok(())
}

fn validate_system(
    shared: &Shared,
    index: usize,
    frame: &FrameInput<'_>,
    system: &ParticleSystem<'_, '_>,
) -> Result<(), FieldError> {
    validate_settings(index, system.settings, frame.view.size)?;
    if !system.settings.is_forward() {
        validate_attachments(index, system.settings)?;
    }
    if system.settings.path == RenderPath::Tiled && shared.tiles().is_none() {
        let expected =
            "\"raster\", or a device with compute shaders and WebGPU's default limits; OpenGL is not supported";
        return Err(FieldError::new(format!("systems[{index}].settings.path"), "\"tiled\"", expected));
    }
    validate_world_from_particles(index, &system.world_from_particles)?;
    validate_bounds_and_depth(index, system.bounds.as_ref(), system.depth)?;
    let field = |name: &str| format!("systems[{index}].{name}");
    validate_particles(shared, system, &field)?;
    if system.material.context != shared.number {
        let expected = "a material created by this renderer's context; renderers share materials by sharing a context";
        return Err(FieldError::from_problem(field("material"), "belongs to another context", expected));
    }
    system.material.info.validate(index, system.settings)?;
    if system.settings.technique == Technique::SoftLinear && frame.scene_depth.linear().is_none() {
        let expected = "\"soft\", or a scene_depth that is SceneDepth::Linear or BufferAndLinear";
        return Err(FieldError::new(field("settings.technique"), "\"soft_linear\"", expected));
    }
    if system.settings.accumulate.depth_source == DepthSource::Host && !system.settings.is_forward() {
        let can_be_attached = |buffer: &wgpu::TextureView| {
            let texture = buffer.texture();
            texture.usage().contains(wgpu::TextureUsages::RENDER_ATTACHMENT) && !texture.format().has_stencil_aspect()
        };
        let attachable = matches!(frame.scene_depth, SceneDepth::Multisampled(_))
            || frame.scene_depth.buffer().is_some_and(can_be_attached);
        let is_read = !reads_linear_target(frame.scene_depth.kind(), shared.read_only_depth, system.settings);
        if !attachable || (is_read && !shared.read_only_depth) {
            let expected = "\"reduced\", or a scene_depth that has a depth buffer without stencil, with \
                            RENDER_ATTACHMENT usage, and on OpenGL a linear target as well";
            return Err(FieldError::new(field("settings.accumulate.depth_source"), "\"host\"", expected));
        }
    }
    Ok(())
}

fn validate_alive_count(alive: &AliveCount<'_>, field: &impl Fn(&str) -> String) -> Result<(), FieldError> {
    let AliveCount { buffer, offset } = *alive;
    if !offset.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT) {
        let expected = format!("a multiple of {}", wgpu::COPY_BUFFER_ALIGNMENT);
        return Err(FieldError::new(field("particles.alive.offset"), offset, expected));
    }
    let needed = offset.saturating_add(wgpu::COPY_BUFFER_ALIGNMENT);
    if buffer.size() < needed || !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
        let problem = format!("the buffer has {} bytes and usage {:?}", buffer.size(), buffer.usage());
        let expected = format!("at least {needed} bytes and usage {:?}", wgpu::BufferUsages::COPY_SRC);
        return Err(FieldError::from_problem(field("particles.alive"), problem, expected));
    }
    Ok(())
}

fn validate_particles(
    shared: &Shared,
    system: &ParticleSystem<'_, '_>,
    field: &impl Fn(&str) -> String,
) -> Result<(), FieldError> {
    let size = size_of::<Particle>() as u64;
    let is_tiled = system.settings.path == RenderPath::Tiled;
    let needs_sorting = system.particles.needs_sorting(system.settings);
    if needs_sorting && shared.pipelines.tiled.is_none() {
        let expected = "true, the order \"weighted\", or a slice: sorting a buffer needs compute shaders and \
                        WebGPU's default limits; OpenGL is not supported";
        return Err(FieldError::new(field("particles.is_sorted"), false, expected));
    }
    let limits = shared.device.limits();
    let mut max_count = limits.max_buffer_size / size;
    if is_tiled {
        max_count = max_count.min(limits.max_storage_buffer_binding_size / TILE_SPRITE_BYTES);
    } else if needs_sorting {
        max_count = max_count.min(limits.max_storage_buffer_binding_size / size);
    }
    match system.particles {
        Particles::Slice(particles) => validate_count(particles.len() as u64, max_count, field)?,
        Particles::Emitter(emission) => {
            validate_count(u64::from(emission.count()), max_count, field)?;
            let bounds = emission.bounds(SpriteExtent::from_settings(system.settings));
            let is_finite = bounds.min.is_finite() && bounds.max.is_finite();
            if !bounds.is_empty() && !is_finite {
                let expected = "an emission of an emitter that Emitter::validate accepts";
                let problem = "the bounds of the emission are not finite";
                return Err(FieldError::from_problem(field("particles"), problem, expected));
            }
        }
        Particles::Buffer(ParticleBuffer { buffer, offset, count, alive, .. }) => {
            validate_count(u64::from(count), max_count, field)?;
            if system.bounds.is_none() {
                let expected = "the bounding box of the particles: the CPU does not read a GPU buffer";
                return Err(FieldError::new(field("bounds"), "None", expected));
            }
            let is_read = is_tiled || needs_sorting;
            let alignment = if is_read { PARTICLE_ALIGNMENT } else { wgpu::VERTEX_ALIGNMENT };
            if !offset.is_multiple_of(alignment) {
                let expected = format!("a multiple of {alignment}");
                return Err(FieldError::new(field("particles.offset"), offset, expected));
            }
            let needed = offset.saturating_add(u64::from(count) * size);
            let mut usage = wgpu::BufferUsages::VERTEX;
            usage.set(wgpu::BufferUsages::STORAGE, is_read);
            if buffer.size() < needed || !buffer.usage().contains(usage) {
                let problem = format!("the buffer has {} bytes and usage {:?}", buffer.size(), buffer.usage());
                let expected = format!("at least {needed} bytes and usage {usage:?}");
                return Err(FieldError::from_problem(field("particles"), problem, expected));
            }
            if let Some(alive) = alive {
                validate_alive_count(&alive, field)?;
            }
        }
    }
    Ok(())
}

fn validate_count(count: u64, max_count: u64, field: &impl Fn(&str) -> String) -> Result<(), FieldError> {
    if count > max_count {
        let problem = format!("{count} particles are too many");
        let expected = format!("at most {max_count} on this device");
        return Err(FieldError::from_problem(field("particles"), problem, expected));
    }
    Ok(())
}
