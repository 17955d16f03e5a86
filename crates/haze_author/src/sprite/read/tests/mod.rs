//! Sheets of haze's own bakes, coded in every way that other tools use: each must be read back.

use std::path::Path;

use glam::{IVec2, UVec2, UVec3, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::formula::color::srgb_from_linear;
use haze_core::formula::six_way::{SixWay, six_way_from_texel};
use image::{Rgba, RgbaImage};

use super::*;
use crate::path_trace::{MEDIA, Medium};
use crate::simulation::{SimRecipe, Simulation};
use crate::sprite::bake::SpriteRecipe;
use haze_core::assets::json;
use haze_core::error::FieldError;
use haze_core::formula::sprite::detail_from_texel;

/// One baked frame.
struct Frame {
    normals: Image<Vec3>,
    amount: Image<f32>,
    light: Image<SixWay>,
    /// Motion to the next frame, in sides, y down.
    motion: Image<Vec2>,
}

/// A bake, frame by frame.
struct Bake {
    name: &'static str,
    frames: Vec<Frame>,
    playback: Playback,
}

/// Sheets as the bakers write them.
struct BakedSheets {
    image: RgbaImage,
    detail: RgbaImage,
    six_way: RgbaImage,
    side: u32,
    columns: u32,
    rows: u32,
}

impl Bake {
    fn cut(name: &'static str, sheets: &BakedSheets, playback: Playback) -> Self {
        let BakedSheets { image, detail, six_way, side, columns, rows } = sheets;
        let (side, columns) = (*side, *columns);
        let height = side * rows;
        let frames = (0..columns * rows).map(|frame| {
            let origin = UVec2::new(frame % columns, frame / columns) * side;
            let color = |sheet: &RgbaImage, at: UVec2| {
                Vec3::from_array(std::array::from_fn(|channel| {
                    f32::from(sheet.get_pixel(at.x, at.y).0[channel]) / 255.0
                }))
            };
            let mut frame = Frame {
                normals: Image::new(UVec2::splat(side), Vec3::Z),
                amount: Image::new(UVec2::splat(side), 0.0),
                light: Image::new(UVec2::splat(side), SixWay::default()),
                motion: Image::new(UVec2::splat(side / 4), Vec2::ZERO),
            };
            frame.normals.for_each(|at, normal| *normal = color(image, origin + at) * 2.0 - 1.0);
            frame.amount.for_each(|at, amount| {
                *amount = f32::from(image.get_pixel(origin.x + at.x, origin.y + at.y).0[3]) / 255.0;
            });
            frame.light.for_each(|at, light| {
                let at = origin + at;
                *light = SixWay {
                    positive: six_way_from_texel(color(six_way, at)),
                    negative: six_way_from_texel(color(six_way, at + UVec2::new(0, height))),
                };
            });
            frame.motion.for_each(|at, motion| {
                let detail = detail_from_texel(color(detail, origin / 4 + at));
                *motion = Vec2::new(detail.y, detail.z);
            });
            frame
        });
        Self { name, frames: frames.collect(), playback }
    }

    fn of_recipe(name: &'static str, recipe: &SpriteRecipe, medium: &str, samples: u32) -> Self {
        let baked = recipe.bake(|_| Ok::<_, FieldError>(())).unwrap();
        let medium = medium_of(medium);
        let light = recipe.bake_six_way(&medium, samples, |_, _| Ok::<_, FieldError>(())).unwrap();
        let SpriteRecipe { size: side, columns, rows, .. } = *recipe;
        let sheets =
            BakedSheets { image: baked.image, detail: baked.detail, six_way: light.image, side, columns, rows };
        Self::cut(name, &sheets, Playback::Loop)
    }

    fn of_simulation(name: &'static str, recipe: &SimRecipe, medium: &str, samples: u32) -> Self {
        let recording = Simulation::new(recipe).unwrap().finish();
        let baked = recording.bake();
        let medium = medium_of(medium);
        let light = recording.bake_six_way(&medium, samples, |_, _| Ok::<_, FieldError>(())).unwrap();
        let sheets = BakedSheets {
            image: baked.sprite.image,
            detail: baked.sprite.detail,
            six_way: light.image,
            side: recipe.sheet.size,
            columns: recipe.sheet.columns,
            rows: recipe.sheet.rows,
        };
        let is_loop = recipe.time.frame_loop != crate::simulation::FrameLoop::Once;
        Self::cut(name, &sheets, if is_loop { Playback::Loop } else { Playback::Once })
    }
}

fn medium_of(name: &str) -> Medium {
    MEDIA.iter().find(|medium| medium.name == name).unwrap().medium
}

fn sprite_recipe(name: &str, size: u32, columns: u32, rows: u32) -> SpriteRecipe {
    let recipe = haze_preset::builtin::find(haze_preset::builtin::SPRITES, name).unwrap();
    let recipe = SpriteRecipe::of_builtin(recipe).unwrap();
    SpriteRecipe { size, columns, rows, travel: 0.15, tolerance: 2, ..recipe }
}

fn simulation(text: &str, size: u32, columns: u32, rows: u32) -> SimRecipe {
    let mut recipe: SimRecipe = json::parse(Path::new("a.sim.json"), text).unwrap();
    recipe.grid.width = 32;
    recipe.grid.height = 48;
    recipe.grid.depth = 32;
    recipe.sheet.size = size;
    recipe.sheet.columns = columns;
    recipe.sheet.rows = rows;
    recipe
}

/// A way to code a bake, drawn by a seed.
#[derive(Debug)]
struct Coding {
    cells: UVec2,
    order: FrameOrder,
    /// Frames on the sheet; cells after them are clear.
    frames: u32,
    contents: Contents,
    alpha: AlphaMode,
    space: CodeSpace,
    sides: SideOrder,
    has_own_opacity: bool,
    white_where_clear: bool,
    y_down: bool,
    motion: Option<(MotionAxes, f32)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Contents {
    Normals,
    Light,
}

impl Coding {
    fn new(seed: u32, bake: &Bake) -> Self {
        let draw = |salt: u32, count: usize| (unit(pcg3d(UVec3::new(seed, salt, 7)).x) * count as f32) as usize;
        let all = bake.frames.len() as u32;
        let missing = if draw(1, 3) == 0 { 1 + draw(2, 2) as u32 } else { 0 };
        let frames = all - missing;
        let grids: Vec<_> = (2..=frames)
            .map(|columns| UVec2::new(columns, frames.div_ceil(columns)))
            // No row or column is clear as a whole.
            .filter(|cells| cells.element_product() < frames + cells.min_element() && cells.max_element() <= 16)
            .collect();
        let cells = grids[draw(3, grids.len())];
        let order = if cells.min_element() > 2 { FrameOrder::ALL[draw(4, 5).min(2)] } else { FrameOrder::Rows };
        let contents = if draw(5, 4) == 0 { Contents::Normals } else { Contents::Light };
        let alpha = AlphaMode::ALL[draw(6, 2)];
        let axes: Vec<_> = MotionAxes::all().collect();
        let longest =
            bake.frames.iter().flat_map(|frame| &frame.motion.texels).map(|motion| motion.abs().max_element());
        let longest = longest.fold(0.01, f32::max);
        let has_own_opacity = draw(9, 2) == 0;
        Self {
            cells,
            order,
            frames,
            contents,
            alpha,
            space: if contents == Contents::Light { CodeSpace::ALL[draw(7, 2)] } else { CodeSpace::Linear },
            sides: SideOrder::all().nth(draw(8, 720)).unwrap(),
            has_own_opacity,
            white_where_clear: has_own_opacity && alpha == AlphaMode::Straight && draw(10, 2) == 0,
            y_down: draw(11, 2) == 0,
            motion: (draw(12, 2) == 0)
                .then(|| (axes[draw(13, 8)], longest * (1.0 + unit(pcg3d(UVec3::new(seed, 14, 7)).x)))),
        }
    }

    /// Draws a sheet. `texel` gives the texel of a frame.
    fn sheet(&self, side: u32, clear: [u8; 4], texel: impl Fn(usize, IVec2) -> [u8; 4]) -> RgbaImage {
        let mut sheet = RgbaImage::from_pixel(self.cells.x * side, self.cells.y * side, Rgba(clear));
        let grid = FrameGrid { cells: self.cells, order: self.order };
        for frame in 0..self.frames {
            let origin = grid.cell(frame) * side;
            for at in (0..side * side).map(|index| UVec2::new(index % side, index / side)) {
                let value = texel(frame as usize, at.as_ivec2());
                sheet.put_pixel(origin.x + at.x, origin.y + at.y, Rgba(value));
            }
        }
        sheet
    }

    /// Codes the bake as files without telling names.
    fn files(&self, bake: &Bake) -> Vec<SheetFile> {
        let side = bake.frames[0].amount.size.x;
        let code = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        let amount = |frame: usize, at| bake.frames[frame].amount.load(at);
        let color = |color: Vec3, amount: f32| {
            let color = if self.alpha == AlphaMode::Premultiplied { color * amount } else { color };
            let color = match self.space {
                CodeSpace::Linear => color,
                CodeSpace::Srgb => Vec3::from(color.to_array().map(srgb_from_linear)),
            };
            let [r, g, b] = color.to_array().map(code);
            let is_white = self.white_where_clear && amount <= 0.0;
            if is_white { [255; 3] } else { [r, g, b] }
        };
        let with_alpha =
            |[r, g, b]: [u8; 3], amount: f32| [r, g, b, if self.has_own_opacity { 255 } else { code(amount) }];
        let clear = match (self.has_own_opacity, self.white_where_clear) {
            (true, true) => [255; 4],
            (true, false) => [0, 0, 0, 255],
            (false, _) => [0; 4],
        };
        let mut sheets = Vec::new();
        match self.contents {
            Contents::Normals => sheets.push(self.sheet(side, clear, |frame, at| {
                let normal = bake.frames[frame].normals.load(at);
                let normal = if self.y_down { normal.with_y(-normal.y) } else { normal };
                let amount = amount(frame, at);
                with_alpha(color(normal * 0.5 + 0.5, amount), amount)
            })),
            Contents::Light => sheets.extend([0, 1].map(|map| {
                self.sheet(side, clear, |frame, at| {
                    let light = self.sides.texels(bake.frames[frame].light.load(at))[map];
                    let amount = amount(frame, at);
                    with_alpha(color(light, amount), amount)
                })
            })),
        }
        if self.has_own_opacity {
            sheets.push(self.sheet(side, [0, 0, 0, 255], |frame, at| {
                let amount = code(amount(frame, at));
                [amount, amount, amount, 255]
            }));
        }
        if let Some((axes, scale)) = self.motion {
            sheets.push(self.sheet(side / 4, [128, 128, 0, 255], |frame, at| {
                let [r, g] = (axes.vector(bake.frames[frame].motion.load(at)) / scale * 0.5 + 0.5).to_array().map(code);
                [r, g, 0, 255]
            }));
        }
        (0..).zip(sheets).map(|(index, sheet)| SheetFile::new(Path::new(&format!("{index}.png")), sheet)).collect()
    }

    /// Wrong answers, with true for those that are called unsure.
    fn wrong(&self, bake: &Bake, answers: &SheetAnswers) -> Vec<(&'static str, bool)> {
        let mut wrong = Vec::new();
        fn check<T: PartialEq>(wrong: &mut Vec<(&'static str, bool)>, name: &'static str, found: &Answer<T>, value: T) {
            if found.value != value {
                wrong.push((name, !found.is_sure()));
            }
        }
        check(&mut wrong, "grid", &answers.cells, self.cells);
        check(&mut wrong, "order", &answers.order, self.order);
        check(&mut wrong, "frames", &answers.frames, self.frames);
        match self.contents {
            Contents::Normals => {
                let Some((code, y_down)) = answers.normals.zip(answers.y_down) else { return vec![("normals", false)] };
                check(&mut wrong, "alpha", &code.alpha, self.alpha);
                check(&mut wrong, "codes", &code.space, self.space);
                check(&mut wrong, "y_down", &y_down, self.y_down);
            }
            Contents::Light => {
                let Some((code, sides)) = answers.light.zip(answers.sides) else { return vec![("light", false)] };
                check(&mut wrong, "alpha", &code.alpha, self.alpha);
                check(&mut wrong, "codes", &code.space, self.space);
                check(&mut wrong, "sides", &sides, self.sides);
            }
        }
        if let Some((axes, scale)) = self.motion {
            let Some((found, found_scale)) = answers.motion.zip(answers.motion_scale) else {
                return vec![("motion", false)];
            };
            check(&mut wrong, "motion", &found, axes);
            if !(0.75..1.35).contains(&(found_scale.value / scale)) {
                wrong.push(("motion_scale", !found_scale.is_sure()));
            }
        }
        // A loop without its last frames is none.
        if self.frames as usize == bake.frames.len() {
            check(&mut wrong, "playback", &answers.playback, bake.playback);
        }
        wrong
    }
}

/// Reads codings of bakes. Returns how many were right, unsure and wrong.
fn read_codings(bakes: &[Bake], seeds: std::ops::Range<u32>, prints: bool) -> [usize; 3] {
    let mut counts = [0; 3];
    for seed in seeds {
        let bake = &bakes[seed as usize % bakes.len()];
        let coding = Coding::new(seed, bake);
        let wrong = match read_sheets(&coding.files(bake), &ReadOptions::default()) {
            Ok(reading) => coding.wrong(bake, &reading.answers),
            Err(error) => {
                println!("{seed}: {error}");
                vec![("error", false)]
            }
        };
        let kind = match () {
            () if wrong.is_empty() => 0,
            () if wrong.iter().all(|(_, is_unsure)| *is_unsure) => 1,
            () => 2,
        };
        counts[kind] += 1;
        if prints && kind > 0 {
            println!("{seed} {}: {wrong:?} {coding:?}", bake.name);
        }
    }
    counts
}

#[test]
fn codings_of_a_bake_are_read_back() {
    let recipe = sprite_recipe("billow", 48, 4, 2);
    let bakes = [Bake::of_recipe("billow", &recipe, "ash", 8)];
    let [right, unsure, wrong] = read_codings(&bakes, 0..24, true);
    assert!(wrong == 0 && right >= 23, "{right} right, {unsure} unsure, {wrong} wrong");
}

#[test]
#[ignore = "a few minutes: prints how many of 1,000 codings are read back"]
fn prints_how_many_codings_are_read_back() {
    let puff = simulation(include_str!("../../../../../../simulations/puff.sim.json"), 64, 6, 4);
    let column = simulation(include_str!("../../../../../../simulations/rising_column.sim.json"), 64, 4, 4);
    let bakes = [
        Bake::of_recipe("puff", &sprite_recipe("puff", 64, 4, 4), "ash", 16),
        Bake::of_recipe("billow", &sprite_recipe("billow", 64, 4, 3), "steam", 16),
        Bake::of_recipe("wisp", &sprite_recipe("wisp", 64, 4, 4), "dust", 16),
        Bake::of_recipe("cauliflower", &sprite_recipe("cauliflower", 64, 5, 3), "soot", 16),
        Bake::of_simulation("simulated puff", &puff, "ash", 16),
        Bake::of_simulation("simulated column", &column, "diesel", 16),
    ];
    let [right, unsure, wrong] = read_codings(&bakes, 0..1000, true);
    println!("{right} right, {unsure} unsure, {wrong} wrong");
    assert!(right >= 990 && wrong == 0);
}
