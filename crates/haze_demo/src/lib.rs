//! Demo scene for the smoke: boxes with procedural materials, lit by the preset's lights. A GPU and a CPU renderer draw
//! the same image.

pub mod apart;
mod arriving;
mod boxes;
pub mod capture;
mod cpu;
pub mod develop;
pub mod headless;
mod layout;
mod occluders;
mod render;
mod scene;
mod scene_renderer;
mod shading;
pub mod shot;
pub mod stage;
