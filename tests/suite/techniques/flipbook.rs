//! Flipbooks: agreement of the renderers on every sprite setting, pipelines, and motion between frames.

use std::sync::LazyLock;

use glam::{UVec2, Vec2, Vec3Swizzles, Vec4, Vec4Swizzles};
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::formula::sprite::{flipbook_frames, sample_detail, sample_sprite};
use haze_core::settings::*;

use super::{assert_agreement, scene};
use crate::gpu::gpu;
use crate::test_host::Host;
use crate::test_scene::{TestScene, six_way_of};

#[test]
fn gpu_and_cpu_agree_on_every_sprite_setting() {
    type Change = fn(&mut TestScene);
    let changes: &[(&str, Change)] = &[
        ("size", |s| s.settings.sprite.size = 1.7),
        ("volume", |s| s.settings.sprite.animation = SpriteAnimation::Volume),
        ("still", |s| s.settings.sprite.animation = SpriteAnimation::Still),
        ("nearest", |s| s.settings.sprite.animation = SpriteAnimation::Nearest),
        ("motion", |s| s.settings.sprite.motion = 1.0),
        ("checkerboard", |s| s.settings.debug.checkerboard = true),
        ("draw count", |s| s.settings.debug.draw_count = 3),
        ("age color", |s| (s.settings.path, s.settings.sprite.age_color) = (RenderPath::Forward, 0.8)),
    ];
    for (name, change) in changes {
        for technique in [Technique::Soft, Technique::SphericalBillboard] {
            let mut scene = scene(technique);
            (scene.material.sprite, scene.material.detail, scene.material.six_way) = flipbook();
            for (index, particle) in (0..).zip(&mut scene.particles) {
                particle.frame = index as f32 * 0.37;
            }
            let plain = scene.on_cpu();
            change(&mut scene);
            assert_agreement(&format!("{} {name}", technique.name()), &scene);
            // The setting must have an effect on the image.
            assert_ne!(plain, scene.on_cpu(), "{name} has no effect");
        }
    }
}

#[test]
fn only_flipbooks_compile_a_pipeline_per_animation() {
    // Every animation of a flipbook has its own pipeline. A single frame has nothing to blend, so all animations share
    // one.
    for path in [RenderPath::Raster, RenderPath::Forward] {
        for (has_frames, expected) in [(false, 0), (true, SpriteAnimation::ALL.len() - 1)] {
            let mut scene = scene(Technique::Soft);
            scene.settings.path = path;
            if has_frames {
                (scene.material.sprite, _, scene.material.six_way) = flipbook();
                scene.material.detail = None;
            }
            let mut host = Host::new(gpu(), &scene).unwrap();
            let mut counts = SpriteAnimation::ALL.iter().map(|&animation| {
                scene.settings.sprite.animation = animation;
                host.draw(gpu(), &scene).unwrap();
                host.renderer.context().pipeline_count()
            });
            let first = counts.next().unwrap();
            assert_eq!(counts.last().unwrap() - first, expected, "{}, flipbook {has_frames}", path.name());
        }
    }
}

/// A small flipbook, its detail map and six-way maps. Baked once.
pub fn flipbook() -> (Sprite, Option<Sprite>, Option<Sprite>) {
    static FLIPBOOK: LazyLock<[Sprite; 3]> = LazyLock::new(|| {
        let recipe = recipe();
        let baked = recipe.bake(|_| Ok::<_, haze::FieldError>(())).unwrap();
        let decode = |image| Sprite::from_image("flipbook".as_ref(), image, recipe.layout()).unwrap();
        let sprite = decode(&baked.image);
        let six_way = six_way_of(&sprite);
        [sprite, decode(&baked.detail), six_way]
    });
    let [sprite, detail, six_way] = FLIPBOOK.clone();
    (sprite, Some(detail), Some(six_way))
}

/// A puff whose balls travel. Smoke that only boils in place has no motion to estimate.
fn recipe() -> SpriteRecipe {
    let text = include_str!("../../corpus/sprite/good_first");
    let puff: SpriteRecipe = serde_json::from_str(text).unwrap();
    SpriteRecipe { size: 64, drift: 0.2, ball_radius_max: 0.4, erosion: 0.5, ..puff }
}

/// Squared errors of normals and amount halfway between frames, against a frame baked for that time. In order: blended,
/// with motion, and with reversed motion.
fn errors_between_frames(recipe: &SpriteRecipe) -> [f32; 3] {
    let baked = recipe.bake(|_| Ok::<_, haze::FieldError>(())).unwrap();
    let decode = |image: &_, layout| Sprite::from_image("flipbook".as_ref(), image, layout).unwrap();
    let sprite = decode(&baked.image, recipe.layout());
    let detail = decode(&baked.detail, recipe.layout());
    let size = recipe.size;
    // Premultiplied normal and amount, as they are accumulated.
    let counted = |texel: Vec4| (texel.xyz() * texel.w).extend(texel.w);
    let mut errors = [0.0; 3];
    for frame in [0.5, 3.5, 6.5] {
        let truth = recipe.bake_frame(frame).image;
        let image = image::RgbaImage::from_fn(size, size, |x, y| truth.texels[(y * size + x) as usize]);
        let truth = decode(&image, SpriteLayout::default());
        let frames = flipbook_frames(frame, sprite.frame_count() as f32);
        for index in 0..size * size {
            let at = UVec2::new(index % size, index / size);
            let uv = (at.as_vec2() + 0.5) / size as f32;
            let motion = sample_detail(&detail, uv, frames, 0.0).yz();
            let wanted = truth.texel(0, 0, at.x, at.y);
            let wanted = counted((wanted.xyz() * 2.0 - 1.0).extend(wanted.w));
            for (error, motion) in errors.iter_mut().zip([Vec2::ZERO, motion, -motion]) {
                *error += (counted(sample_sprite(&sprite, uv, frames, motion, 0.0)) - wanted).length_squared();
            }
        }
    }
    errors
}

#[test]
fn motion_reduces_the_error_between_flipbook_frames() {
    let print_errors = |name: &str, recipe: &SpriteRecipe| {
        let errors = errors_between_frames(recipe);
        println!(
            "{name}: squared error blended {:.1}, with motion {:.1}, reversed {:.1}",
            errors[0], errors[1], errors[2]
        );
        errors
    };
    // Measured: a quarter less than blending. Motion with the wrong sign is the mutant.
    let [blended, moved, reversed] = print_errors("travelling balls", &recipe());
    assert!(moved < 0.8 * blended && blended < reversed, "blended {blended}, with motion {moved}, reversed {reversed}");
    // All of the puff travels and nothing boils: less than half the error.
    let carried = SpriteRecipe { size: 128, columns: 4, rows: 4, drift: 0.0, travel: 0.2, ..recipe() };
    let [blended, moved, reversed] = print_errors("travelling puff", &carried);
    assert!(moved < 0.5 * blended && blended < reversed, "blended {blended}, with motion {moved}, reversed {reversed}");
}
