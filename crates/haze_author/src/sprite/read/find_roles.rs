//! Contents of each file of a set: opacity, light maps, normals, motion …

use glam::Vec3;
use haze_core::formula::color::linear_from_srgb;

use super::answer::Answer;
use super::file_name::role_of;
use super::role::Role;
use super::sheet_file::SheetFile;

/// Confidence of a name that the texels do not contradict.
const NAMED: f32 = 0.9;

/// Most that the mean normal of a sheet leans to a side.
const MAX_LEAN: f32 = 0.35;

fn is_unit(color: Vec3) -> bool {
    color.z > 0.45 && ((color * 2.0 - 1.0).length() - 1.0).abs() < 0.15
}

/// Fractions of the texels of a file that fit each kind of contents.
struct Contents {
    is_gray: bool,
    unit_length: f32,
    resting: f32,
    rest: [u8; 3],
    /// True if blue is the same everywhere, while red and green are about a half in the mean.
    is_pair: bool,
    fiery: f32,
}

impl Contents {
    fn new(file: &SheetFile) -> Self {
        let rest = most_frequent_color(file);
        let background = file.background();
        let mut count = 0.0_f32;
        let mut unit_length = 0.0;
        let mut visible = 0.0_f32;
        let mut lean = Vec3::ZERO;
        let mut resting = 0.0;
        let mut fiery = 0.0;
        let mut lit = 0.0_f32;
        let mut blues = [u8::MAX, u8::MIN];
        let mut sum = Vec3::ZERO;
        for texel in samples(file) {
            let [r, g, b, a] = texel;
            count += 1.0;
            resting += f32::from([r, g, b] == rest);
            let color = Vec3::from([r, g, b].map(f32::from)) / 255.0;
            blues = [blues[0].min(b), blues[1].max(b)];
            sum += color;
            if a > 20 && [r, g, b] != background {
                visible += 1.0;
                let codes = color;
                let decoded = Vec3::from(color.to_array().map(linear_from_srgb));
                let undone = color / (f32::from(a) / 255.0);
                if let Some(color) = [codes, decoded, undone].into_iter().find(|color| is_unit(*color)) {
                    unit_length += 1.0;
                    lean += color * 2.0 - 1.0;
                }
            }
            if color.max_element() > 0.1 {
                lit += 1.0;
                fiery += f32::from(r >= g && g >= b && r - b > 40);
            }
        }
        // Puffs are round: their normals lean to all sides.
        if (lean / f32::max(unit_length, 1.0)).truncate().abs().max_element() > MAX_LEAN {
            unit_length = 0.0;
        }
        let mean = sum / count.max(1.0);
        let is_half = |value: f32| (0.3..0.7).contains(&value);
        let is_pair = blues[1] - blues[0] <= 2 && is_half(mean.x) && is_half(mean.y);
        Self {
            is_gray: file.is_gray,
            is_pair,
            unit_length: unit_length / visible.max(1.0),
            resting: resting / count.max(1.0),
            rest,
            fiery: fiery / lit.max(1.0),
        }
    }

    /// True for vectors: blue is not used, or most texels rest at a half, in codes of linear or of sRGB values.
    fn is_motion(&self) -> bool {
        let [r, g, _] = self.rest;
        let rests = |code: u8| code.abs_diff(128) <= 2 || code.abs_diff(188) <= 2;
        let is_resting = self.resting > 0.15 && rests(r) && rests(g) && self.unit_length < 0.7;
        !self.is_gray && (is_resting || self.is_pair)
    }
}

/// Texels of a file, at most some ten thousands.
fn samples(file: &SheetFile) -> impl Iterator<Item = [u8; 4]> + '_ {
    let texels = file.image.as_raw().len() / 4;
    // Odd, so that columns of texels do not repeat.
    let step = (texels / 40_000) | 1;
    file.image.pixels().step_by(step).map(|texel| texel.0)
}

fn most_frequent_color(file: &SheetFile) -> [u8; 3] {
    let mut colors: Vec<_> = samples(file).map(|[r, g, b, _]| [r, g, b]).collect();
    colors.sort_unstable();
    let runs = colors.chunk_by(|a, b| a == b);
    runs.max_by_key(|run| run.len()).and_then(|run| run.first().copied()).unwrap_or_default()
}

/// Finds the contents of every file: by its name, by its texels, and by what the other files leave.
pub(super) fn find_roles(files: &[SheetFile], given: &[Option<Role>]) -> Vec<Answer<Role>> {
    let contents: Vec<_> = files.iter().map(Contents::new).collect();
    let mut roles: Vec<Option<Answer<Role>>> = (0..files.len())
        .map(|index| {
            if let Some(role) = given.get(index).copied().flatten() {
                return Some(Answer::given(role));
            }
            let found = &contents[index];
            let named = role_of(&files[index].stem()).filter(|role| match role {
                // Fire is the subject of a set as often as the contents of a file.
                Role::Emission => found.is_gray || found.fiery > 0.5,
                Role::Normals | Role::SixWay | Role::Motion => !found.is_gray,
                Role::Color | Role::Opacity | Role::Depth | Role::Heat => true,
            });
            let named = named.map(|role| if role == Role::Emission && found.is_gray { Role::Heat } else { role });
            if let Some(role) = named {
                return Some(Answer::found(role, NAMED));
            }
            if found.is_gray {
                return None;
            }
            if found.is_motion() {
                return Some(Answer::found(Role::Motion, if found.is_pair { 0.9 } else { 0.4 + found.resting * 0.6 }));
            }
            (found.unit_length > 0.7).then(|| Answer::found(Role::Normals, (found.unit_length - 0.5) * 2.0))
        })
        .collect();
    // A set has one map of normals: two that look so are light maps.
    let look_so: Vec<_> = (0..files.len())
        .filter(|&index| {
            let is_named = role_of(&files[index].stem()) == Some(Role::Normals);
            !is_named && roles[index].is_some_and(|role| role.value == Role::Normals && !role.is_given)
        })
        .collect();
    // Beside another colored file, one that barely looks so is the other light map.
    let has_other = roles.iter().zip(files).any(|(role, file)| role.is_none() && !file.is_gray);
    let is_clear = |index: &usize| contents[*index].unit_length > 0.9;
    if look_so.len() > 1 || (has_other && !look_so.iter().all(is_clear)) {
        look_so.into_iter().for_each(|index| roles[index] = None);
    }
    name_colored_files(files, &contents, &mut roles);
    name_gray_files(files, &mut roles);
    name_premultiplied_normals(files, &mut roles);
    roles.into_iter().map(|role| role.unwrap_or(Answer::found(Role::Color, 0.2))).collect()
}

/// Two colored files without a name are light maps, one is the color of lit smoke, and a further one is fire if it looks so.
fn name_colored_files(files: &[SheetFile], contents: &[Contents], roles: &mut [Option<Answer<Role>>]) {
    let named = roles.iter().flatten().filter(|role| role.value == Role::SixWay).count();
    let mut unknown: Vec<_> =
        (0..files.len()).filter(|&index| roles[index].is_none() && !files[index].is_gray).collect();
    // A map of front, top and back is as red as fire: fire is what is left beside two maps.
    while named + unknown.len() != 2 {
        let fiery = |index: &usize| contents[*index].fiery;
        let found = unknown.iter().copied().max_by(|a, b| fiery(a).total_cmp(&fiery(b)));
        let Some(index) = found.filter(|index| fiery(index) > 0.85) else { break };
        roles[index] = Some(Answer::found(Role::Emission, (fiery(&index) - 0.75) * 4.0));
        unknown.retain(|other| *other != index);
    }
    let are_maps = named + unknown.len() == 2;
    for &index in &unknown {
        let (role, sure) = if are_maps { (Role::SixWay, 0.7) } else { (Role::Color, 0.2) };
        roles[index] = Some(Answer::found(role, sure));
    }
}

/// A colored file whose normals have unit length if the opacity of another file is divided out holds normals.
fn name_premultiplied_normals(files: &[SheetFile], roles: &mut [Option<Answer<Role>>]) {
    let is = |role: &Option<Answer<Role>>, wanted| role.is_some_and(|role| role.value == wanted);
    let Some(opacity) = files.iter().zip(&*roles).find(|(_, role)| is(role, Role::Opacity)).map(|(file, _)| file)
    else {
        return;
    };
    for (file, role) in files.iter().zip(roles) {
        let is_guess = is(role, Role::Color) && role.is_some_and(|role| !role.is_sure());
        if !is_guess || file.size() != opacity.size() {
            continue;
        }
        let mut visible = 1.0e-6_f32;
        let mut unit_length = 0.0;
        for ([r, g, b, _], [amount, ..]) in samples(file).zip(samples(opacity)).filter(|(_, [amount, ..])| *amount > 40)
        {
            visible += 1.0;
            unit_length += f32::from(is_unit(Vec3::from([r, g, b].map(f32::from)) / f32::from(amount)));
        }
        if unit_length > 0.7 * visible {
            *role = Some(Answer::found(Role::Normals, (unit_length / visible - 0.5) * 2.0));
        }
    }
}

/// The first gray file without a name is the opacity if nothing else has it; others are heat.
fn name_gray_files(files: &[SheetFile], roles: &mut [Option<Answer<Role>>]) {
    let mut has_opacity = roles.iter().flatten().any(|role| role.value == Role::Opacity)
        || files.iter().zip(&*roles).any(|(file, role)| {
            let may_have = role.as_ref().is_some_and(|role| {
                matches!(role.value, Role::Normals | Role::SixWay | Role::Color)
                    && (role.is_given || role.confidence > 0.0)
            });
            may_have && file.has_alpha
        });
    let unknown: Vec<_> = (0..files.len()).filter(|&index| roles[index].is_none()).collect();
    // Opacity covers all that the other maps show: it is the brightest.
    let brightness = |index: usize| samples(&files[index]).map(|[r, _, _, a]| u64::from(r) * u64::from(a)).sum::<u64>();
    let mut by_brightness = unknown.clone();
    by_brightness.sort_by_key(|&index| std::cmp::Reverse(brightness(index)));
    for index in by_brightness {
        let sure = if unknown.len() == 1 { 0.8 } else { 0.25 };
        let role = if has_opacity { Role::Heat } else { Role::Opacity };
        roles[index] = Some(Answer::found(role, if has_opacity { 0.25 } else { sure }));
        has_opacity = true;
    }
}
