//! Evaluates the particles at a time from the frames of files.

use glam::{UVec3, Vec3};
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::frame::Particle;
use haze_preset::{EndBehavior, ParticleFiles, UpAxis};

use super::particle_frames::{FramePair, ParticleFrames};

impl ParticleFrames {
    /// Replaces `particles` with those at `time`, seconds. The same input gives the same output.
    pub fn evaluate(&self, source: &ParticleFiles, time: f64, particles: &mut Vec<Particle>) {
        particles.clear();
        let mut frame = (time - f64::from(source.start)) * f64::from(source.fps);
        if source.after == EndBehavior::Loop {
            frame = frame.rem_euclid(f64::from(self.frame_count()));
        }
        let Some(FramePair { before, after, fraction }) = self.frames_around(frame) else { return };
        let provided = before.provided();
        before.interpolate(after, fraction, |particle, weight| {
            let id = particle.id as u64;
            let random = pcg3d(UVec3::new(id as u32, (id >> 32) as u32, 0));
            let y_up = |v: Vec3| if source.up == UpAxis::Z { Vec3::new(v.x, v.z, -v.y) } else { v };
            let channel = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
            particles.push(Particle {
                position: source.position + y_up(particle.position) * source.units,
                radius: if provided.radius { particle.radius * source.units } else { source.default_radius },
                // Random rotations hide that all sprites have the same image.
                rotation: if provided.rotation { particle.rotation } else { unit(random.x) * std::f32::consts::TAU },
                amount: weight * if provided.amount { particle.amount } else { source.default_amount },
                frame: unit(random.y) * 256.0 + (time * f64::from(source.flipbook_rate)) as f32,
                age: particle.age,
                velocity: y_up(particle.velocity) * source.units,
                tint: if provided.color { particle.color.to_array().map(channel) } else { [255; 3] },
                heat: if provided.heat { channel(particle.heat) } else { 255 },
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::particle_frames::Limits;
    use super::*;

    fn frames(texts: &[&str]) -> ParticleFrames {
        let folder = tempfile::tempdir().unwrap();
        for (number, text) in texts.iter().enumerate() {
            std::fs::write(folder.path().join(format!("{number}.csv")), text).unwrap();
        }
        ParticleFrames::load(&folder.path().join("#.csv"), Limits { particles: 9, bytes: 1 << 20 }).unwrap()
    }

    fn at(source: &ParticleFiles, frames: &ParticleFrames, time: f64) -> Vec<Particle> {
        let mut particles = Vec::new();
        frames.evaluate(source, time, &mut particles);
        particles
    }

    #[test]
    fn units_and_up_axis_of_the_settings_are_applied() {
        let frames =
            frames(&["x,y,z,pscale,amount,rotation,age,vx,vy,vz,r,g,b,heat\n1,2,3,4,0.5,6,0.25,7,8,9,1,0.2,0,0.4"]);
        let plain = ParticleFiles { flipbook_rate: 0.0, ..ParticleFiles::default() };
        let [y_up] = at(&plain, &frames, 0.0)[..] else { panic!("one particle") };
        assert_eq!((y_up.position, y_up.radius), (Vec3::new(1.0, 2.0, 3.0), 4.0));
        assert_eq!((y_up.amount, y_up.rotation, y_up.age), (0.5, 6.0, 0.25));
        let moved = ParticleFiles { up: UpAxis::Z, units: 0.01, position: Vec3::new(0.0, 10.0, 0.0), ..plain };
        let [z_up] = at(&moved, &frames, 0.0)[..] else { panic!("one particle") };
        // Blender's forward axis, y, points away from the viewer.
        assert!(z_up.position.distance(Vec3::new(0.01, 10.03, -0.02)) < 1e-6 && (z_up.radius - 0.04).abs() < 1e-7);
        assert!(z_up.velocity.distance(Vec3::new(0.07, 0.09, -0.08)) < 1e-6);
        assert_eq!((y_up.velocity, y_up.tint, y_up.heat), (Vec3::new(7.0, 8.0, 9.0), [255, 51, 0], 102));
        let Particle { position, radius, velocity, .. } = y_up;
        assert_eq!(Particle { position, radius, velocity, ..z_up }, y_up);
    }

    #[test]
    fn last_frame_is_held_or_the_sequence_repeats() {
        let frames = frames(&["id,x,y,z\n1,0,0,0", "id,x,y,z\n1,1,0,0\n2,0,0,0", "id,x,y,z\n2,4,0,0"]);
        let mut source = ParticleFiles { fps: 2.0, start: 1.0, default_amount: 0.4, ..ParticleFiles::default() };
        let mut seen = |after, time| {
            source.after = after;
            at(&source, &frames, time).iter().map(|particle| (particle.position.x, particle.amount)).collect::<Vec<_>>()
        };
        assert_eq!(seen(EndBehavior::Hold, 0.9), []);
        assert_eq!(seen(EndBehavior::Hold, 1.0), [(0.0, 0.4)]);
        assert_eq!(seen(EndBehavior::Hold, 1.25), [(0.5, 0.4), (0.0, 0.2)]);
        assert_eq!(seen(EndBehavior::Hold, 1.75), [(1.0, 0.2), (2.0, 0.4)]);
        assert_eq!(seen(EndBehavior::Hold, 50.0), [(4.0, 0.4)]);
        assert_eq!(seen(EndBehavior::Loop, 2.25), [(4.0, 0.4)]);
        for turn in [-3.0, 0.0, 3.0] {
            assert_eq!(seen(EndBehavior::Loop, 2.75 + turn), [(0.5, 0.4), (0.0, 0.2)]);
        }
    }

    #[test]
    fn missing_columns_come_from_the_settings_and_stay_with_the_id() {
        let frames = frames(&["id,x,y,z\n7,0,0,0\n8,0,0,0", "id,x,y,z\n8,0,0,0\n7,0,0,0"]);
        let source = ParticleFiles { default_radius: 0.5, fps: 1.0, flipbook_rate: 0.0, ..ParticleFiles::default() };
        let first = at(&source, &frames, 0.0);
        let second = at(&source, &frames, 1.0);
        assert_eq!(first, second);
        assert_eq!((first[0].radius, first[0].amount), (0.5, 0.3));
        let apart = [first[0].rotation - first[1].rotation, first[0].frame - first[1].frame];
        assert!(apart.iter().all(|apart| apart.abs() > 0.01) && first.iter().all(Particle::is_valid));
    }
}
