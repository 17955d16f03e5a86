//! What is derived from a frame without a device: where things stand in the view, in uniforms that both renderers read.

mod back_to_front;
mod bounds;
mod lights;
mod middle;
mod system;
mod view;

pub(crate) use back_to_front::{SortScratch, back_to_front};
pub(crate) use lights::lights_in_view;
pub(crate) use system::{SystemInView, SystemInWorld, system_in_view};
pub(crate) use view::ViewGeometry;
