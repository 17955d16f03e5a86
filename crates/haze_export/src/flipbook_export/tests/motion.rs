//! Motion vectors, used as an engine does.

use super::*;

/// Two frames of a flipbook, mixed along their motion vectors as an engine does.
struct MixedFrames {
    colors: [RgbaImage; 2],
    motions: [RgbaImage; 2],
    /// Fractions of a frame's width and height, in texture coordinates from the upper left corner.
    motion_scale: Vec2,
}

impl MixedFrames {
    /// `indices`: of a frame and the one that follows it.
    fn new(flipbook: &Flipbook, engine: Engine, indices: [u32; 2]) -> Self {
        // Texture coordinates count from the bottom in Unity.
        let up = if engine == Engine::Unity { -1.0 } else { 1.0 };
        Self {
            colors: indices.map(|index| flipbook.frame(sheets::COLOR, index)),
            motions: indices.map(|index| flipbook.frame(sheets::MOTION, index)),
            motion_scale: flipbook.numbers.motion_scale * Vec2::new(1.0, up),
        }
    }

    fn uv(at: UVec2) -> Vec2 {
        (at.as_vec2() + 0.5) / SIDE as f32
    }

    fn motion(&self, index: usize, uv: Vec2) -> Vec2 {
        (sample(&self.motions[index], uv).xy() * 2.0 - 1.0) * self.motion_scale
    }

    /// `fraction`: of the second frame. `strength`: factor of the vectors; 0 is a cross-fade.
    fn texel(&self, at: UVec2, fraction: f32, strength: f32) -> Vec4 {
        let at = Self::uv(at);
        let a = sample(&self.colors[0], at - self.motion(0, at) * fraction * strength);
        let b = sample(&self.colors[1], at + self.motion(1, at) * (1.0 - fraction) * strength);
        let mixed = (a.xyz() * a.w).lerp(b.xyz() * b.w, fraction);
        let alpha = a.w + (b.w - a.w) * fraction;
        (mixed / alpha.max(1.0e-4)).extend(alpha)
    }

    /// Mean squared difference from the image of the renderer.
    fn error(&self, expected: &RgbaImage, fraction: f32, strength: f32) -> f32 {
        difference(|at| self.texel(at, fraction, strength), |at| texel(expected, at.as_ivec2()))
    }
}

/// Image so many frames after the first.
fn image_after(shot: &Shot, frames: &Frames, count: f32) -> RgbaImage {
    let format = ImageFormat { background: Background::Transparent, ..ImageFormat::default() };
    let mut between = frames.shot(shot, 0);
    between.preset.time += f64::from(count) / f64::from(frames.rate);
    block_on(format.render(&between, async |shot| shot.render_on_cpu())).unwrap().into_rgba8()
}

#[test]
fn motion_vectors_predict_the_next_frame_and_the_time_between_in_every_engine() {
    // Eight frames per second: smoke moves by some pixels.
    let shot = shot("spell");
    let frames = frames(2, 8.0);
    let between = image_after(&shot, &frames, 0.5);
    for engine in ENGINES {
        let flipbook = Flipbook::new(&shot, &frames, options(engine));
        let mixed = MixedFrames::new(&flipbook, engine, [0, 1]);
        let half = |strength: f32| mixed.error(&between, 0.5, strength);
        assert!(half(1.0) < 0.8 * half(0.0), "{engine:?}: {} with, {} without", half(1.0), half(0.0));
        assert!(half(-1.0) > 1.1 * half(0.0), "{engine:?}: vectors of the opposite sign are as good");
        let next = |strength: f32| {
            let [first, second] = &mixed.colors;
            let warped = |at: UVec2| {
                let uv = MixedFrames::uv(at);
                sample(first, uv - mixed.motion(0, uv) * strength)
            };
            difference(warped, |at| texel(second, at.as_ivec2()))
        };
        assert!(next(1.0) < 0.7 * next(0.0), "{engine:?}: {} with, {} without", next(1.0), next(0.0));
    }
}

#[test]
fn motion_vectors_predict_flames_with_sparks_at_times_to_which_they_are_not_fitted_too() {
    let shot = shot("campfire");
    let frames = frames(2, 24.0);
    let flipbook = Flipbook::new(&shot, &frames, options(Engine::Godot));
    let mixed = MixedFrames::new(&flipbook, Engine::Godot, [0, 1]);
    for fraction in [0.25, 0.5, 0.75] {
        let expected = image_after(&shot, &frames, fraction);
        let error = |strength: f32| mixed.error(&expected, fraction, strength);
        assert!(error(1.0) < 0.9 * error(0.0), "at {fraction}: {} with, {} without", error(1.0), error(0.0));
    }
}

#[test]
fn motion_vectors_lead_from_the_last_frame_of_a_loop_to_the_first() {
    let shot = shot("spell");
    let frames = frames(4, 8.0);
    let flipbook = Flipbook::new(&shot, &frames, FlipbookOptions { loop_fade: 2, ..options(Engine::Godot) });
    let mixed = MixedFrames::new(&flipbook, Engine::Godot, [3, 0]);
    let expected = image_after(&shot, &frames, 3.5);
    let error = |strength: f32| mixed.error(&expected, 0.5, strength);
    assert!(error(1.0) < 0.8 * error(0.0), "{} with, {} without", error(1.0), error(0.0));
}

#[test]
fn motion_vectors_stay_inside_the_frame() {
    let mut shot = shot("column");
    let frames = frames(2, 8.0);
    // Smoke at the borders.
    shot.preset.camera.fov = 20.0;
    let flipbook = Flipbook::new(&shot, &frames, options(Engine::Unreal));
    let scale = flipbook.numbers.motion_scale;
    // Codes are half a step of 8 bits off; rest is between two of them.
    let inside = 0.5 / SIDE as f32;
    let step = scale / 255.0 + 1.0e-6;
    let mut longest: f32 = 0.0;
    for index in 0..2 {
        let motion = flipbook.frame(sheets::MOTION, index);
        for at in pixels() {
            let uv = (at.as_vec2() + 0.5) / SIDE as f32;
            let way = (texel(&motion, at.as_ivec2()).xy() * 2.0 - 1.0) * scale;
            for end in [uv - way, uv + way] {
                let out = (inside - end).max(end - 1.0 + inside).max_element();
                assert!(out < step, "frame {index}, {at}: {way} leads {out} out");
            }
            longest = longest.max(way.abs().max_element());
        }
    }
    assert!(longest * SIDE as f32 > 2.0, "{longest}");
}
