//! Validation of the input that both renderers share.

use glam::{UVec2, Vec3};

use super::bounds::Bounds;
use super::light::{Light, LightKind, MAX_LIGHTS};
use crate::error::FieldError;
use crate::settings::{DepthSource, Settings, validate};

/// Validates the settings of system `index` for a picture of this size.
pub fn validate_settings(index: usize, settings: &Settings, picture: UVec2) -> Result<(), FieldError> {
    settings.validate(|| format!("systems[{index}].settings"))?;
    let accumulate = &settings.accumulate;
    let is_host = accumulate.depth_source == DepthSource::Host && !settings.is_forward();
    if is_host && accumulate.effective_scale(picture) != 1 {
        let field = format!("systems[{index}].settings.accumulate.max_side");
        let expected = format!("at least {} for this picture with depth_source \"host\"", picture.max_element());
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

/// Validates time and up direction of a frame.
pub fn validate_time_and_up(time: f32, up: Vec3) -> Result<(), FieldError> {
    if !time.is_finite() {
        return Err(FieldError::new("time", time, "a finite number of seconds"));
    }
    if up.normalize_or_zero() == Vec3::ZERO {
        return Err(FieldError::new("up", up, "a direction that is not zero"));
    }
    Ok(())
}
