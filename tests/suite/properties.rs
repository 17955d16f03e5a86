//! Properties that hold for every image: draw order, empty frames, odd sizes, depth conventions, memory, steady frames.

mod depth_conventions;
mod draw_order;
mod finite;
mod memory;
mod mutants;
mod rejected_frames;
mod sizes;

use glam::UVec2;

const SIZE: UVec2 = UVec2::new(160, 90);
