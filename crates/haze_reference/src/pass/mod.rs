//! The passes of the reference renderer, each beside its shader: the formulas of the modules above, pixel by pixel.

mod accumulate;
mod depth_downsample;
mod diffuse_bake;
mod forward;
mod light_target;
mod specular_scatter;
mod transfer;
