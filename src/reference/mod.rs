//! The whole frame on the CPU, pass by pass as the GPU renderer has it, in f32: the oracle of the tests, and what draws on a
//! machine without a GPU driver.

mod accumulated;
pub mod blend_unit;
mod draw;
mod frame;
mod pass;
mod sprite;

use glam::{UVec2, Vec4};

use crate::assets::picture::Picture;
use crate::error::FieldError;
use crate::frame::View;
use crate::frame::validate::{validate_lights, validate_place, validate_settings, validate_time_and_up};
use crate::in_view::ViewGeometry;
use crate::settings::ShadeTree;

use accumulated::Accumulated;
use draw::Draw;
pub use frame::{Frame, System};

/// Blends the frame's smoke over `picture`, linear HDR.
///
/// # Errors
/// The view, light or setting that cannot be used; `picture` is untouched then.
pub fn render(frame: &Frame<'_>, picture: &mut Picture<Vec4>) -> Result<(), FieldError> {
    // The picture is the view, wherever that lies in a host's targets.
    let view = ViewGeometry::new(&View { origin: UVec2::ZERO, ..frame.view })?;
    validate_lights(frame.lights)?;
    validate_time_and_up(frame.time, frame.up)?;
    for (name, size) in [("scene_depth", frame.scene_depth.size), ("picture", picture.size)] {
        if size != frame.view.size {
            let value = format!("{}x{}", size.x, size.y);
            return Err(FieldError::new(name, value, format!("{}x{}", frame.view.size.x, frame.view.size.y)));
        }
    }
    let mut draws = Vec::new();
    for (index, system) in frame.systems.iter().enumerate() {
        validate_settings(index, system.settings, frame.view.size)?;
        validate_place(index, system.bounds.as_ref(), system.depth)?;
        let info = system.material.info();
        info.validate(index, system.settings)?;
        draws.extend(Draw::new(&view, frame, system, &info));
    }
    draws.sort_by(|a, b| b.in_view.distance.total_cmp(&a.in_view.distance));

    for draw in &draws {
        if draw.settings.is_forward() {
            if frame.shade_tree.is_picture() {
                draw.forward(picture);
            }
            continue;
        }
        let reduced_depth = draw.depth_downsample();
        let accumulation = draw.accumulate(&reduced_depth, frame.shade_tree == ShadeTree::Overdraw);
        let weight_sum = draw.weight_sum(&reduced_depth);
        let smoke = Accumulated { draw, baked: draw.diffuse_bake(), reduced_depth, accumulation, weight_sum };
        if frame.shade_tree != ShadeTree::SpecularScatter {
            smoke.transfer(frame.shade_tree, picture);
        }
        if frame.shade_tree.glows() {
            smoke.specular_scatter(picture);
        }
    }
    Ok(())
}
