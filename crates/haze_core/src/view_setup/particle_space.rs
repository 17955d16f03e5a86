//! Space of a system's particles.

use glam::{Mat4, Vec3};

use super::view_geometry::ViewGeometry;
use crate::frame::Bounds;

/// Placement of a system's particles in the world and in the view.
#[derive(Clone, Copy, Debug)]
pub struct ParticleSpace {
    /// Rotation, translation and a uniform scale.
    pub world_from_particles: Mat4,
    /// The same to view space.
    pub view_from_particles: Mat4,
    /// Metres per unit of the particles' space.
    pub scale: f32,
}

impl ParticleSpace {
    /// `world_from_particles`: rotation, translation and a uniform scale.
    pub fn new(view: &ViewGeometry, world_from_particles: &Mat4) -> Self {
        // f64, because the translations of a far position cancel out.
        let view_from_particles = view.view_from_world.as_dmat4() * world_from_particles.as_dmat4();
        Self {
            world_from_particles: *world_from_particles,
            view_from_particles: view_from_particles.as_mat4(),
            scale: world_from_particles.x_axis.truncate().length(),
        }
    }

    /// Transforms a particle's position to view space.
    pub fn view_position(&self, position: Vec3) -> Vec3 {
        self.view_from_particles.transform_point3(position)
    }

    /// Transforms a particle's position to world space.
    pub fn world_position(&self, position: Vec3) -> Vec3 {
        self.world_from_particles.transform_point3(position)
    }

    /// Returns the world-space box around a box of the particles' space.
    pub fn world_bounds(&self, bounds: &Bounds) -> Bounds {
        if bounds.is_empty() || self.world_from_particles == Mat4::IDENTITY {
            return *bounds;
        }
        let mut world = Bounds::EMPTY;
        for corner in 0..8 {
            world.include(self.world_position(bounds.corner(corner)), 0.0);
        }
        world
    }
}
