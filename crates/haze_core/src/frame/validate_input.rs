//! Validation of the input that both renderers share.

use glam::{Mat4, UVec2, Vec3, Vec4};

use super::bounds::Bounds;
use super::light::{Light, LightKind, MAX_LIGHTS};
use super::shadow_projection::ShadowProjection;
use crate::error::FieldError;
use crate::formula::shadow_map::MAX_SHADOW_LAYERS;
use crate::settings::{DepthSource, Settings, validate};

/// Validates the settings of system `index` for an image of this size.
pub fn validate_settings(index: usize, settings: &Settings, image: UVec2) -> Result<(), FieldError> {
    settings.validate(|| format!("systems[{index}].settings"))?;
    let accumulate = &settings.accumulate;
    let is_host = accumulate.depth_source == DepthSource::Host && !settings.is_forward();
    if is_host && accumulate.effective_scale(image) != 1 {
        let field = format!("systems[{index}].settings.accumulate.max_side");
        let expected = format!("at least {} for this image with depth_source \"host\"", image.max_element());
        return Err(FieldError::new(field, accumulate.max_side, expected));
    }
    Ok(())
}

/// Validates box and depth that a host gives for system `index`.
pub fn validate_bounds_and_depth(index: usize, bounds: Option<&Bounds>, depth: Option<f32>) -> Result<(), FieldError> {
    if let Some(bounds) = bounds {
        bounds.validate(|| format!("systems[{index}].bounds"))?;
    }
    match depth {
        Some(depth) if !depth.is_finite() => {
            Err(FieldError::new(format!("systems[{index}].depth"), depth, "a finite number of metres, or None"))
        }
        _ => Ok(()),
    }
}

/// Validates the placement of the particles of system `index`.
pub fn validate_world_from_particles(index: usize, matrix: &Mat4) -> Result<(), FieldError> {
    let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(Vec4::truncate);
    let scale = axes[0].length();
    let is_affine = matrix.row(3) == Vec4::W && matrix.is_finite() && scale > 0.0;
    let has_one_scale = axes.iter().all(|axis| (axis.length() - scale).abs() <= 1.0e-3 * scale);
    let products = [axes[0].dot(axes[1]), axes[1].dot(axes[2]), axes[2].dot(axes[0])];
    let is_orthogonal = products.iter().all(|product| product.abs() <= 1.0e-3 * scale * scale);
    if is_affine && has_one_scale && is_orthogonal {
        return Ok(());
    }
    let expected = "rotation, translation and a uniform scale above 0";
    Err(FieldError::new(format!("systems[{index}].world_from_particles"), matrix, expected))
}

/// Validates the lights.
pub fn validate_lights(lights: &[Light]) -> Result<(), FieldError> {
    if lights.len() > MAX_LIGHTS {
        let problem = format!("{} lights are too many", lights.len());
        return Err(FieldError::from_problem("lights", problem, format!("at most {MAX_LIGHTS}")));
    }
    for (index, light) in lights.iter().enumerate() {
        validate(light, || format!("lights[{index}]"))?;
        if light.kind != LightKind::Point && light.direction.normalize_or_zero() == Vec3::ZERO {
            let field = format!("lights[{index}].direction");
            return Err(FieldError::new(field, light.direction, "a direction that is not zero"));
        }
    }
    Ok(())
}

/// Validates the projections of shadow maps, of a frame with this number of lights.
pub fn validate_shadow_projections<'a>(
    lights: usize,
    projections: impl Iterator<Item = ShadowProjection<'a>>,
) -> Result<(), FieldError> {
    let mut seen = [false; MAX_LIGHTS];
    for (index, projection) in projections.enumerate() {
        let field = |name| format!("shadow_maps[{index}].projection.{name}");
        let ShadowProjection { light, clip_from_world, bias, .. } = projection;
        let Some(seen) = seen.get_mut(light).filter(|_| light < lights) else {
            let expected = format!("the index of one of the {lights} lights");
            return Err(FieldError::new(field("light"), light, expected));
        };
        if std::mem::replace(seen, true) {
            return Err(FieldError::from_problem(
                field("light"),
                format!("{light} has a map already"),
                "one per light",
            ));
        }
        if clip_from_world.is_empty() || clip_from_world.len() > MAX_SHADOW_LAYERS {
            let problem = format!("has {} layers", clip_from_world.len());
            return Err(FieldError::from_problem(field("clip_from_world"), problem, "1 to 6"));
        }
        if let Some(matrix) = clip_from_world.iter().find(|matrix| !matrix.is_finite()) {
            return Err(FieldError::new(field("clip_from_world"), matrix, "finite numbers"));
        }
        if !bias.is_finite() || bias < 0.0 {
            return Err(FieldError::new(field("bias"), bias, "a finite number, at least 0"));
        }
    }
    Ok(())
}

/// Validates the numbers of a frame.
pub fn validate_frame_numbers(
    exposure: f32,
    time: f64,
    up: Vec3,
    scene_ambient: Option<Vec3>,
) -> Result<(), FieldError> {
    if !exposure.is_finite() || exposure < 0.0 {
        return Err(FieldError::new("exposure", exposure, "a finite number, at least 0"));
    }
    if !time.is_finite() {
        return Err(FieldError::new("time", time, "a finite number of seconds"));
    }
    if up.normalize_or_zero() == Vec3::ZERO {
        return Err(FieldError::new("up", up, "a direction that is not zero"));
    }
    if let Some(light) = scene_ambient.filter(|light| !light.is_finite() || light.min_element() < 0.0) {
        return Err(FieldError::new("scene_ambient", light, "finite numbers, at least 0, or None"));
    }
    Ok(())
}
