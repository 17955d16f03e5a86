//! Box layouts of the demo scenes. Metres; x right, y up, z towards the default camera.

use glam::{Vec3, vec3};
use haze_preset::{Environment, SceneName};

use super::boxes::{SceneBox, Surface};

pub(crate) fn boxes(environment: &Environment) -> Vec<SceneBox> {
    match environment.scene {
        SceneName::Yard => yard(environment),
        SceneName::Corridor => corridor(),
        SceneName::Studio => studio(),
        SceneName::Empty => Vec::new(),
    }
}

/// Creates a box with the center of its underside at `foot`. `turn` is the rotation about the vertical axis, radians.
fn box_on_ground(foot: Vec3, size: Vec3, turn: f32, color: Vec3, surface: Surface) -> SceneBox {
    SceneBox {
        center: foot + Vec3::Y * (0.5 * size.y),
        cos: turn.cos(),
        half_size: 0.5 * size,
        sin: turn.sin(),
        color,
        surface: surface as u32,
    }
}

const STONE: Vec3 = vec3(0.34, 0.33, 0.31);
const BRICK: Vec3 = vec3(0.36, 0.17, 0.12);
const WOOD: Vec3 = vec3(0.42, 0.27, 0.15);
const PLASTER: Vec3 = vec3(0.46, 0.42, 0.36);
const PAVING: Vec3 = vec3(0.30, 0.29, 0.28);
const IRON: Vec3 = vec3(0.06, 0.06, 0.065);
const PAINTED: Vec3 = vec3(0.20, 0.21, 0.20);
/// Reflectance of a photographic gray card.
const GRAY: Vec3 = Vec3::splat(0.18);

/// The glowing body of the yard's lamp.
const LAMP_BODY_FOOT: Vec3 = vec3(1.1, 2.36, -2.4);
const LAMP_BODY_SIZE: Vec3 = vec3(0.2, 0.24, 0.2);
/// Middle of the glowing body of the yard's lamp, where its light belongs.
pub const LAMP_HEAD: Vec3 = vec3(LAMP_BODY_FOOT.x, LAMP_BODY_FOOT.y + 0.5 * LAMP_BODY_SIZE.y, LAMP_BODY_FOOT.z);

fn pillar(boxes: &mut Vec<SceneBox>, foot: Vec3, height: f32) {
    boxes.push(box_on_ground(foot, vec3(0.8, 0.3, 0.8), 0.0, STONE, Surface::Plaster));
    boxes.push(box_on_ground(foot, vec3(0.52, height, 0.52), 0.0, STONE, Surface::Plaster));
    boxes.push(box_on_ground(foot + Vec3::Y * height, vec3(0.78, 0.22, 0.78), 0.0, STONE, Surface::Plaster));
}

fn yard(environment: &Environment) -> Vec<SceneBox> {
    let mut boxes = Vec::new();
    let at = vec3;
    boxes.push(box_on_ground(at(0.0, -1.0, 0.0), vec3(60.0, 1.0, 60.0), 0.0, PAVING, Surface::Slabs));

    // Back wall with coping, left wall with coping, and a house with window and door on the right.
    boxes.push(box_on_ground(at(0.0, 0.0, -6.4), vec3(26.0, 3.4, 0.6), 0.0, BRICK, Surface::Brick));
    boxes.push(box_on_ground(at(0.0, 3.4, -6.4), vec3(26.0, 0.18, 0.85), 0.0, STONE, Surface::Plaster));
    boxes.push(box_on_ground(at(-7.6, 0.0, -1.0), vec3(0.6, 3.0, 12.0), 0.0, PLASTER, Surface::Plaster));
    boxes.push(box_on_ground(at(-7.6, 3.0, -1.0), vec3(0.85, 0.16, 12.0), 0.0, STONE, Surface::Plaster));
    boxes.push(box_on_ground(at(9.4, 0.0, -3.4), vec3(4.4, 5.2, 6.0), 0.0, PLASTER, Surface::Plaster));
    boxes.push(box_on_ground(at(9.2, 5.2, -3.4), vec3(5.2, 0.3, 6.8), 0.0, BRICK, Surface::Plain));
    boxes.push(box_on_ground(at(7.18, 1.2, -2.2), vec3(0.12, 1.5, 1.1), 0.0, IRON, Surface::Plain));
    boxes.push(box_on_ground(at(7.18, 0.0, -4.6), vec3(0.12, 2.2, 1.2), 0.0, WOOD * 0.6, Surface::Wood));
    // Buildings behind the wall.
    boxes.push(box_on_ground(at(-9.0, 0.0, -24.0), vec3(9.0, 7.0, 6.0), 0.1, PAINTED, Surface::Plain));
    boxes.push(box_on_ground(at(3.0, 0.0, -30.0), vec3(12.0, 9.0, 6.0), -0.1, PAINTED, Surface::Plain));
    boxes.push(box_on_ground(at(14.0, 0.0, -22.0), vec3(7.0, 6.0, 6.0), 0.2, PAINTED, Surface::Plain));

    // A pergola: pillars with a beam.
    for x in [-4.4, -0.6, 3.2] {
        pillar(&mut boxes, at(x, 0.0, -3.6), 3.0);
    }
    boxes.push(box_on_ground(at(-0.6, 3.22, -3.6), vec3(9.4, 0.34, 0.42), 0.0, WOOD, Surface::Wood));

    // Crates.
    boxes.push(box_on_ground(at(-3.1, 0.0, -0.5), vec3(1.1, 1.1, 1.1), 0.35, WOOD, Surface::Wood));
    boxes.push(box_on_ground(at(-4.3, 0.0, -0.9), vec3(0.95, 0.95, 0.95), -0.15, WOOD * 0.85, Surface::Wood));
    boxes.push(box_on_ground(at(-3.6, 1.1, -0.65), vec3(0.8, 0.8, 0.8), 0.9, WOOD * 1.1, Surface::Wood));
    boxes.push(box_on_ground(at(-2.5, 0.0, 0.9), vec3(0.6, 0.6, 0.6), -0.4, WOOD * 0.95, Surface::Wood));
    boxes.push(box_on_ground(at(4.6, 0.0, -1.6), vec3(1.2, 1.2, 1.2), 0.2, WOOD * 0.9, Surface::Wood));
    boxes.push(box_on_ground(at(5.7, 0.0, -0.9), vec3(0.8, 0.8, 0.8), -0.5, WOOD, Surface::Wood));

    // A brazier, the source of the smoke.
    if environment.brazier {
        boxes.push(box_on_ground(at(0.0, 0.0, 0.0), vec3(0.7, 0.12, 0.7), 0.3, IRON, Surface::Plain));
        boxes.push(box_on_ground(at(0.0, 0.12, 0.0), vec3(0.46, 0.36, 0.46), 0.3, IRON, Surface::Plain));
        boxes.push(box_on_ground(at(0.0, 0.48, 0.0), vec3(0.36, 0.03, 0.36), 0.3, vec3(2.6, 0.7, 0.12), Surface::Glow));
    }

    // A lamp on a post behind the brazier.
    if environment.lamp {
        boxes.push(box_on_ground(at(1.1, 0.0, -2.4), vec3(0.3, 0.14, 0.3), 0.0, IRON, Surface::Plain));
        boxes.push(box_on_ground(at(1.1, 0.0, -2.4), vec3(0.09, 2.35, 0.09), 0.0, IRON, Surface::Plain));
        boxes.push(box_on_ground(LAMP_BODY_FOOT, LAMP_BODY_SIZE, 0.0, vec3(9.0, 6.4, 3.6), Surface::Glow));
        boxes.push(box_on_ground(at(1.1, 2.62, -2.4), vec3(0.36, 0.06, 0.36), 0.0, IRON, Surface::Plain));
    }

    // A thin fence, for hard depth edges.
    for rail in [0.28, 0.82] {
        boxes.push(box_on_ground(at(3.1, rail, 1.7), vec3(3.9, 0.07, 0.04), 0.0, PAINTED, Surface::Plain));
    }
    for picket in 0..18 {
        let x = 1.25 + 0.22 * picket as f32;
        boxes.push(box_on_ground(at(x, 0.06, 1.75), vec3(0.075, 1.05, 0.03), 0.0, PAINTED, Surface::Plain));
    }
    boxes
}

fn corridor() -> Vec<SceneBox> {
    let mut boxes = Vec::new();
    let at = vec3;
    boxes.push(box_on_ground(at(0.0, -1.0, -6.0), vec3(30.0, 1.0, 40.0), 0.0, PAVING, Surface::Slabs));
    // Right wall and ceiling; the left side is open between pillars.
    boxes.push(box_on_ground(at(3.0, 0.0, -7.0), vec3(0.6, 4.3, 29.9), 0.0, BRICK, Surface::Brick));
    boxes.push(box_on_ground(at(0.0, 4.2, -7.0), vec3(6.8, 0.4, 30.0), 0.0, PLASTER, Surface::Plaster));
    boxes.push(box_on_ground(at(-2.75, 3.5, -7.0), vec3(0.7, 0.7, 29.9), 0.0, STONE, Surface::Plaster));
    for bay in 0..7 {
        let z = 3.0 - 2.9 * bay as f32;
        pillar(&mut boxes, at(-2.75, 0.0, z), 3.28);
        boxes.push(box_on_ground(at(2.6, 0.0, z), vec3(0.3, 4.2, 0.5), 0.0, STONE, Surface::Plaster));
        boxes.push(box_on_ground(at(0.0, 3.95, z), vec3(5.6, 0.25, 0.34), 0.0, WOOD * 0.8, Surface::Wood));
    }
    // Far wall with a bright doorway.
    boxes.push(box_on_ground(at(-1.9, 0.0, -17.0), vec3(2.2, 4.2, 0.5), 0.0, BRICK, Surface::Brick));
    boxes.push(box_on_ground(at(1.9, 0.0, -17.0), vec3(2.2, 4.2, 0.5), 0.0, BRICK, Surface::Brick));
    boxes.push(box_on_ground(at(0.0, 2.9, -17.0), vec3(1.6, 1.3, 0.5), 0.0, BRICK, Surface::Brick));
    boxes.push(box_on_ground(at(0.0, 0.0, -17.6), vec3(1.6, 2.9, 0.1), 0.0, vec3(5.0, 4.2, 3.2), Surface::Glow));
    // The garden wall outside.
    boxes.push(box_on_ground(at(-9.0, 0.0, -7.0), vec3(0.6, 2.4, 34.0), 0.0, PLASTER, Surface::Plaster));

    boxes.push(box_on_ground(at(1.9, 0.0, -0.6), vec3(0.9, 0.9, 0.9), 0.2, WOOD, Surface::Wood));
    boxes.push(box_on_ground(at(1.95, 0.0, -1.7), vec3(0.7, 0.7, 0.7), -0.3, WOOD * 0.9, Surface::Wood));
    boxes.push(box_on_ground(at(1.9, 0.9, -0.7), vec3(0.6, 0.6, 0.6), 0.7, WOOD * 1.1, Surface::Wood));
    boxes.push(box_on_ground(at(-1.4, 0.0, -6.2), vec3(0.8, 0.8, 0.8), 0.5, WOOD, Surface::Wood));
    boxes.push(box_on_ground(at(1.6, 0.0, -8.4), vec3(1.0, 1.0, 1.0), -0.2, WOOD * 0.85, Surface::Wood));
    boxes
}

fn studio() -> Vec<SceneBox> {
    // Extends beyond the view of the presets' cameras.
    let floor = box_on_ground(vec3(0.0, -1.0, 0.0), vec3(60.0, 1.0, 60.0), 0.0, GRAY, Surface::Even);
    let wall = box_on_ground(vec3(0.0, 0.0, -10.0), vec3(60.0, 16.0, 1.0), 0.0, GRAY, Surface::Even);
    vec![floor, wall]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glowing_boxes_are_only_present_with_lamp_and_brazier() {
        let glowing = |lamp, brazier| {
            let boxes = boxes(&Environment { lamp, brazier, ..Environment::default() });
            boxes.iter().filter(|b| b.surface == Surface::Glow as u32).count()
        };
        assert_eq!([glowing(true, true), glowing(true, false), glowing(false, true)], [2, 1, 1]);
        assert_eq!(glowing(false, false), 0);
    }

    #[test]
    fn the_studio_is_uniformly_gray() {
        let boxes = boxes(&Environment { scene: SceneName::Studio, ..Environment::default() });
        assert!(boxes.iter().all(|b| b.color == Vec3::splat(0.18) && b.surface == Surface::Even as u32));
    }
}
