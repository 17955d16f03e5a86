//! Answers all questions about a set of sheets, and names the sources of the images.

use glam::{UVec2, Vec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::assets::sprite::{MAX_FRAMES, Sprite};
use haze_core::error::AssetError;

use super::super::y_direction::y_direction;
use super::answer::Answer;
use super::assemble::{Channel, DepthMap, HeatSource, LightMaps, MotionMap, NormalMap, ReadSprite, Sources, assemble};
use super::color::{ColorCode, GivenCode, decode, find_light_code, find_normal_code};
use super::depth::{DepthWhite, find_white};
use super::file_name::sides_of;
use super::find_roles::find_roles;
use super::frame_grid::{FrameGrid, FrameOrder};
use super::frame_order::find_order;
use super::grid::{activity, count_frames, find_cells};
use super::motion::{GivenMotion, find_motion};
use super::options::{ReadOptions, SecondAlpha};
use super::playback::find_playback;
use super::report::SheetAnswers;
use super::role::Role;
use super::sheet_file::SheetFile;
use super::six_way::{SmallLight, find_sides};
use super::small_frames::SmallFrames;

/// Most files of a set. Each may take 64 MiB.
pub const MAX_FILES: usize = 12;

/// A set of sheets that was read.
#[derive(Clone, Debug)]
pub struct SheetReading {
    /// Answers to all questions.
    pub answers: SheetAnswers,
    /// Images.
    pub sprite: ReadSprite,
    /// Files, or channels of files, that nothing was made of.
    pub unread: Vec<String>,
}

fn refuse(file: &SheetFile, reason: String) -> AssetError {
    AssetError::Image { path: file.path.clone(), reason }
}

/// Files by their contents.
struct FilesByRole<'a> {
    opacity: Option<&'a SheetFile>,
    normals: Option<&'a SheetFile>,
    light: Option<[&'a SheetFile; 2]>,
    motion: Option<&'a SheetFile>,
    emission: Option<&'a SheetFile>,
    heat: Option<&'a SheetFile>,
    depth: Option<&'a SheetFile>,
    color: Option<&'a SheetFile>,
}

impl<'a> FilesByRole<'a> {
    fn new(files: &'a [SheetFile], roles: &[Answer<Role>]) -> Result<Self, AssetError> {
        let of_role = |wanted: Role| -> Vec<&SheetFile> {
            files.iter().zip(roles).filter(|(_, role)| role.value == wanted).map(|(file, _)| file).collect()
        };
        let one = |role: Role| match of_role(role)[..] {
            [] => Ok(None),
            [file] => Ok(Some(file)),
            [file, other, ..] => {
                let name = role.name();
                let problem = format!("{name}, as {} is; expected one: give --role {name}=FILE", other.path.display());
                Err(refuse(file, problem))
            }
        };
        let light = match of_role(Role::SixWay)[..] {
            [] => None,
            [first, second] => Some([first, second]),
            [file, ..] => {
                let count = of_role(Role::SixWay).len();
                let expected = "two light maps of three sides each: give --role six_way=FILE for both";
                return Err(refuse(file, format!("{count} light maps; expected {expected}")));
            }
        };
        Ok(Self {
            opacity: one(Role::Opacity)?,
            normals: one(Role::Normals)?,
            light,
            motion: one(Role::Motion)?,
            emission: one(Role::Emission)?,
            heat: one(Role::Heat)?,
            depth: one(Role::Depth)?,
            color: one(Role::Color)?,
        })
    }

    /// Returns the channel that holds the amount, if any does.
    fn opacity(&self) -> Option<Channel<'a>> {
        let with_alpha =
            [self.light.map(|[first, _]| first), self.normals, self.color, self.light.map(|[_, second]| second)];
        match self.opacity {
            Some(file) => Some(Channel { file, index: if file.has_alpha { 3 } else { 0 } }),
            None => with_alpha.into_iter().flatten().find(|file| file.has_alpha).map(|file| Channel { file, index: 3 }),
        }
    }
}

/// Checks that all files have frames of one grid and shape.
fn check_grid(files: &[SheetFile], cells: UVec2, is_given: bool) -> Result<(), AssetError> {
    for file in files {
        let size = file.size();
        if size % cells != UVec2::ZERO {
            let UVec2 { x: columns, y: rows } = cells;
            let from = if is_given { ", as --grid says" } else { "" };
            let problem = format!("{}x{} pixels do not divide into {columns}x{rows} frames{from}", size.x, size.y);
            return Err(refuse(file, format!("{problem}; expected files of one grid")));
        }
    }
    Ok(())
}

/// Checks that all files have the shape of the first.
fn check_shapes(files: &[SheetFile]) -> Result<(), AssetError> {
    let Some(first) = files.first() else { return Ok(()) };
    let wide = first.size();
    for file in files {
        let size = file.size();
        if size.min_element() < 8 {
            return Err(refuse(file, format!("{}x{} pixels; expected at least 8x8", size.x, size.y)));
        }
        if u64::from(size.x) * u64::from(wide.y) != u64::from(size.y) * u64::from(wide.x) {
            let expected = format!("the shape of {}, {}x{}", first.path.display(), wide.x, wide.y);
            return Err(refuse(file, format!("{}x{} pixels; expected {expected}: files of one grid", size.x, size.y)));
        }
    }
    Ok(())
}

/// Answers all questions about the files of one flipbook, and builds the images.
///
/// # Errors
/// [`AssetError::Image`] if files do not belong together, if none has the opacity, or if a given answer does not fit.
pub fn read_sheets(files: &[SheetFile], options: &ReadOptions) -> Result<SheetReading, AssetError> {
    let Some(first) = files.first() else {
        return Err(AssetError::Image { path: "".into(), reason: "no sheet; expected one".into() });
    };
    if files.len() > MAX_FILES {
        return Err(refuse(first, format!("{} files; expected at most {MAX_FILES}", files.len())));
    }
    check_shapes(files)?;
    let roles = find_roles(files, &options.roles);
    let by_role = FilesByRole::new(files, &roles)?;
    let Some(opacity) = by_role.opacity() else {
        let reason = "no opacity: alpha is the same everywhere, and no file is gray; expected the amount in alpha, or in a gray \
                      file: --role opacity=FILE";
        return Err(refuse(first, reason.into()));
    };
    let amounts = match opacity.index {
        3 => activity(opacity.file),
        _ => gray(opacity.file),
    };
    let cells = Answer::given_or(options.cells, || find_cells(&amounts, files));
    check_grid(files, cells.value, cells.is_given)?;
    let all = cells.value.element_product();
    if all > MAX_FRAMES {
        let UVec2 { x, y } = cells.value;
        return Err(refuse(first, format!("{x}x{y} frames; expected at most {MAX_FRAMES} frames: --grid")));
    }
    let by_rows = FrameGrid { cells: cells.value, order: FrameOrder::Rows };
    let in_rows = amount_frames(opacity, &by_rows, all);
    let order = Answer::given_or(options.order, || find_order(&in_rows, cells.value).within(&cells));
    let grid = FrameGrid { cells: cells.value, order: order.value };
    if let Some(frames) = options.frames.filter(|frames| !(1..=all).contains(frames)) {
        return Err(refuse(first, format!("{frames} frames, as --frames says; expected 1 to {all}")));
    }
    let frames = Answer::given_or(options.frames, || count_frames(&amounts, &grid).within(&cells).within(&order));
    let amount = amount_frames(opacity, &grid, frames.value);
    if amount.frames.iter().all(|frame| frame.texels.iter().all(|texel| texel.w <= 0.0)) {
        return Err(refuse(opacity.file, "clear everywhere; expected smoke".into()));
    }
    let small = |file: &SheetFile| SmallFrames::new(file, &grid, frames.value, amount.size);
    let given = GivenCode { alpha: options.alpha, space: options.space };

    let normals = by_role.normals.map(|file| {
        let small = small(file);
        let code = find_normal_code(&small, &amount, given);
        (file, small, code)
    });
    let y_down =
        normals.as_ref().map(|(_, small, code)| Answer::given_or(options.y_down, || find_y_down(small, &amount, code)));
    let light = by_role.light.map(|maps| {
        let [first, second] = maps.map(small);
        let code = find_light_code([&first, &second], &amount, given);
        let [first, second] = [first, second].map(|map| straight(&map, &amount, &code));
        let light = SmallLight { first: &first, second: &second, amount: &amount };
        let named = maps.map(|map| sides_of(&map.stem()));
        let sides = Answer::given_or(options.sides, || find_sides(&light, named));
        (maps, code, sides)
    });
    let second_alpha = light.as_ref().and_then(|([_, second], ..)| {
        let answer = || find_second_alpha(second, &small(second), &amount);
        second.has_alpha.then(|| Answer::given_or(options.second_alpha, answer))
    });
    let smoke = premultiplied(&amount, normals.as_ref().map(|(_, small, _)| small));
    let moved = by_role.motion.map(|file| {
        let rest = rest(file, &grid, &amount);
        let vectors = small(file);
        let vectors = vectors.map(|frame, at| {
            let code = vectors.frames[frame].load(at);
            ((code.truncate().truncate() - rest) * 2.0).extend(0.0).extend(0.0)
        });
        let given = GivenMotion { axes: options.motion, scale: options.motion_scale };
        (file, rest, find_motion(&vectors, &smoke, given))
    });
    let depth =
        by_role.depth.map(|file| (file, Answer::given_or(options.depth_white, || find_white(&small(file), &amount))));
    let playback = Answer::given_or(options.playback, || find_playback(&smoke));

    let is_emission = second_alpha.is_some_and(|alpha| alpha.value == SecondAlpha::Emission);
    let in_second = light.as_ref().filter(|_| is_emission).map(|([_, file], ..)| Channel { file, index: 3 });
    let heat = match (by_role.heat, by_role.emission, in_second) {
        (Some(file), ..) => Some(HeatSource::Channel(Channel { file, index: 0 })),
        (None, Some(file), _) => Some(HeatSource::Luminance(file)),
        (None, None, channel) => channel.map(HeatSource::Channel),
    };
    let shown = [by_role.light.map(|[first, _]| first), by_role.normals, Some(opacity.file), by_role.color];
    let finest = shown.into_iter().flatten().map(|file| file.size() / cells.value).max_by_key(|size| size.x);
    let sources = Sources {
        grid,
        frames: frames.value,
        size: finest.unwrap_or(UVec2::ONE),
        playback: playback.value,
        opacity,
        normals: normals.as_ref().zip(y_down).map(|((file, _, code), y_down)| NormalMap {
            file,
            alpha: code.alpha.value,
            space: code.space.value,
            y_down: y_down.value,
        }),
        light: light.as_ref().map(|(maps, code, sides)| LightMaps {
            maps: *maps,
            sides: sides.value,
            alpha: code.alpha.value,
            space: code.space.value,
        }),
        motion: moved.as_ref().map(|(file, rest, code)| MotionMap {
            file,
            rest: *rest,
            axes: code.axes.value,
            scale: code.scale.value,
        }),
        heat,
        depth: depth.map(|(file, white)| DepthMap { file, white_is_near: white.value == DepthWhite::Near }),
        strength: options.strength,
    };
    let sprite = assemble(&sources);
    let answers = SheetAnswers {
        roles: files.iter().zip(roles).map(|(file, role)| (file.path.clone(), role)).collect(),
        cells,
        order,
        frames,
        light: light.as_ref().map(|(_, code, _)| *code),
        sides: light.as_ref().map(|(.., sides)| *sides),
        second_alpha,
        normals: normals.as_ref().map(|(.., code)| *code),
        y_down,
        motion: moved.map(|(.., code)| code.axes),
        motion_scale: moved.map(|(.., code)| code.scale),
        depth_white: depth.map(|(_, white)| white),
        playback,
    };
    let heats = [
        by_role.heat.map(|file| file.path.display().to_string()),
        by_role.emission.map(|file| file.path.display().to_string()),
        in_second.map(|Channel { file, .. }| format!("{}, alpha", file.path.display())),
    ];
    // One of them becomes the heat.
    let mut unread: Vec<_> = heats.into_iter().flatten().skip(1).collect();
    unread.extend(by_role.color.map(|file| {
        let is_opacity = std::ptr::eq(opacity.file, file);
        format!("{}{}", file.path.display(), if is_opacity { ", red, green and blue" } else { "" })
    }));
    Ok(SheetReading { answers, sprite, unread })
}

fn gray(file: &SheetFile) -> Image<f32> {
    let mut image = Image::new(file.size(), 0.0);
    image.for_each(|at, value| *value = f32::from(file.image.get_pixel(at.x, at.y).0[0]) / 255.0);
    image
}

/// Reduced frames with the amount in alpha.
fn amount_frames(opacity: Channel<'_>, grid: &FrameGrid, count: u32) -> SmallFrames {
    let frames = SmallFrames::new(opacity.file, grid, count, SmallFrames::size_for(opacity.file, grid));
    frames.map(|frame, at| Vec4::ZERO.with_w(frames.frames[frame].load(at)[opacity.index]))
}

/// Amount, and normals times the amount: what moves from frame to frame.
fn premultiplied(amount: &SmallFrames, normals: Option<&SmallFrames>) -> SmallFrames {
    amount.map(|frame, at| {
        let amount = amount.frames[frame].load(at).w;
        let normal = normals.and_then(|normals| normals.frames.get(frame));
        let normal = normal.map_or(Vec4::ZERO, |normals| normals.load(at) * 2.0 - 1.0);
        (normal.truncate() * amount).extend(amount)
    })
}

/// Decoded light in the size of the amount, which is kept in alpha.
fn straight(map: &SmallFrames, amount: &SmallFrames, code: &ColorCode) -> SmallFrames {
    amount.map(|frame, at| {
        let amount = amount.frames[frame].load(at).w;
        let color = map.frames[frame].load(at).truncate();
        decode(color, amount, code.alpha.value, code.space.value).extend(amount)
    })
}

fn find_y_down(normals: &SmallFrames, amount: &SmallFrames, code: &ColorCode) -> Answer<bool> {
    let side = normals.size.min_element().min(amount.size.min_element());
    let texels = normals.frames.iter().zip(&amount.frames).flat_map(|(normals, amount)| {
        (0..side * side).map(move |index| {
            let at = UVec2::new(index % side, index / side).as_ivec2();
            let amount = amount.load(at).w;
            let normal = decode(normals.load(at).truncate(), amount, code.alpha.value, code.space.value);
            normal.extend(amount).to_array().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8)
        })
    });
    let sprite = Sprite::with_levels(side, normals.frames.len() as u32, texels.collect());
    y_direction(&sprite).map_or(Answer::found(false, 0.0), |found| Answer::found(found.is_down, found.confidence))
}

/// Alpha of the second light map is emission unless it is the amount.
fn find_second_alpha(file: &SheetFile, small: &SmallFrames, amount: &SmallFrames) -> Answer<SecondAlpha> {
    if !file.has_alpha {
        return Answer::found(SecondAlpha::Amount, 1.0);
    }
    let mut off = 0.0;
    let mut all = 1.0e-6;
    for (frame, amount) in small.frames.iter().zip(&amount.frames) {
        for (texel, amount) in frame.texels.iter().zip(&amount.texels) {
            off += (texel.w - amount.w).abs();
            all += amount.w;
        }
    }
    let off = off / all;
    let alpha = if off > 0.1 { SecondAlpha::Emission } else { SecondAlpha::Amount };
    Answer::found(alpha, (off / 0.1).max(1.0e-3).log2().abs())
}

/// Code of rest: that of clear texels, usually a half.
fn rest(file: &SheetFile, grid: &FrameGrid, amount: &SmallFrames) -> Vec2 {
    let mut codes = [Vec::new(), Vec::new()];
    for (index, amount) in (0..).zip(&amount.frames) {
        for at in (0..amount.size.element_product()).map(|i| UVec2::new(i % amount.size.x, i / amount.size.x)) {
            if amount.load(at.as_ivec2()).w <= 0.0 {
                let code = file.texel(grid, index, at, amount.size);
                codes[0].push(code.x);
                codes[1].push(code.y);
            }
        }
    }
    let median = |mut codes: Vec<f32>| {
        codes.sort_by(f32::total_cmp);
        codes.get(codes.len() / 2).copied()
    };
    let [x, y] = codes.map(median);
    // Maps whose clear texels are black, or continue the vectors of the smoke, rest at a half.
    let near = |code: Option<f32>| code.filter(|code| (0.45..0.55).contains(code)).unwrap_or(0.5);
    Vec2::new(near(x), near(y))
}
