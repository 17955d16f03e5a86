//! Path-traced puff of a medium beside the same puff lit by the system's ramps, with the error, while lights rotate.

use std::cell::Cell;
use std::f32::consts::TAU;

use eframe::egui::{self, Align2, Color32, ColorImage, Rect, TextureHandle, TextureOptions, Ui, pos2, vec2};
use glam::{UVec2, Vec3, vec3};
use haze::{Light, LightKind, MaterialAssets};
use haze_author::path_trace::{MEDIA, Medium, PathTrace};
use haze_author::ramp::response::{DiffuseRamps, LIGHTS, Puff, Response};
use haze_author::sprite::bake::SpriteRecipe;
use haze_author::sprite::six_way::BakedSixWay;
use haze_core::error::{AssetError, Error};
use haze_core::settings::{Backlight, Settings};
use haze_export::puff_sheet::{ComparedImages, image_pairs};
use haze_export::sprite_by_name::{default_sprite, sprite_recipe};
use serde::{Deserialize, Serialize};

use crate::platform::portable_job::PortableJob;
use crate::platform::worker::{Ticket, Worker};
use crate::session::Session;
use crate::session::light_view::LightTurn;

/// Fine enough to judge; takes some seconds on two cores.
const PATH_TRACE: PathTrace = PathTrace { size: 48, samples: 64, seed: 1 };
/// Side of a puff in the window, points.
const SIDE: f32 = 112.0;

/// Path-traced reference, and the comparison with it.
pub struct PathTracedPuff {
    worker: Option<Worker<<TracePuff as PortableJob>::Output>>,
    /// Index into [`MEDIA`].
    medium: usize,
    asked: Option<(Wanted, Ticket)>,
    traced: Option<(Wanted, TracedPuff)>,
    compared: Option<Compared>,
    failed: Option<String>,
}

/// Reason why nothing was traced: an error, or `None` if the job was cancelled.
type Stopped = Option<Error>;

/// Path tracing job: index of the medium, and true if six-way maps are needed too.
type Wanted = (usize, bool);

#[derive(Serialize, Deserialize)]
pub struct TracedPuff {
    puff: Puff,
    maps: Option<BakedSixWay>,
}

/// Job that traces a puff of a medium.
#[derive(Serialize, Deserialize)]
pub struct TracePuff {
    /// Index into [`MEDIA`].
    medium: usize,
    is_six_way: bool,
}

impl PortableJob for TracePuff {
    const NAME: &'static str = "trace_puff";
    /// The inner `None`: stopped.
    type Output = Result<TracedPuff, Option<String>>;

    fn run(self, progress: &dyn Fn(u32) -> bool) -> Self::Output {
        let steps = Cell::new(0);
        let go_on = || {
            steps.set(steps.get() + 1);
            if progress(steps.get()) { Ok(()) } else { Err(None) }
        };
        TracedPuff::of(&MEDIA[self.medium].medium, self.is_six_way, go_on)
            .map_err(|stopped: Stopped| stopped.map(|error| error.to_string()))
    }
}

/// Both puffs under all lights.
struct Compared {
    of: (Wanted, bool),
    material: MaterialAssets,
    /// Image with one column per light: the reference above, the ramps' result below.
    sheet: TextureHandle,
    response: Response,
}

/// Starts with ash, the most common medium.
impl Default for PathTracedPuff {
    fn default() -> Self {
        let medium = MEDIA.iter().position(|named| named.name == "ash").unwrap_or_default();
        Self { worker: None, medium, asked: None, traced: None, compared: None, failed: None }
    }
}

impl PathTracedPuff {
    /// Shows both puffs in the lower left corner of the image while lights rotate.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, session: &Session) {
        let Some(turn) = session.view.lights.turn else { return };
        let preset = &session.document.preset;
        let index = session.view.system;
        let materials = session.loaded_materials.of(preset);
        let Some((system, material)) = preset.systems.get(index).zip(materials.get(index)) else { return };
        let leading = session.view.lights.selected.or(session.view.lights.key_light(preset, index)).unwrap_or(0);
        let Some(light) = preset.lights.get(leading).or(preset.lights.first()) else { return };
        let corner = rect.left_bottom() + vec2(6.0, -6.0);
        let area = egui::Area::new(ui.scope_id().with("puff")).pivot(Align2::LEFT_BOTTOM).fixed_pos(corner);
        area.constrain_to(rect).order(egui::Order::Middle).show(ui.ctx(), |ui| {
            let fill = ui.visuals().panel_fill;
            egui::Frame::new().fill(fill).corner_radius(4.0).inner_margin(6.0).show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.label("Puff of");
                    let list = egui::ComboBox::from_id_salt("medium").selected_text(MEDIA[self.medium].name);
                    list.show_ui(ui, |ui| {
                        for (position, medium) in MEDIA.iter().enumerate() {
                            ui.selectable_value(&mut self.medium, position, medium.name)
                                .on_hover_text(medium.description);
                        }
                    });
                });
                self.follow(session, &system.settings, material, ui.ctx());
                let angle = angle(&turn, light, preset.camera.position);
                match (&self.failed, &self.compared) {
                    (Some(failed), _) => drop(ui.colored_label(ui.visuals().error_fg_color, failed)),
                    (None, Some(compared)) => compared.show(ui, angle),
                    (None, None) => drop(ui.weak("Path tracing…")),
                }
            });
        });
    }

    /// Requests path tracing and compares the result.
    fn follow(&mut self, session: &Session, settings: &Settings, material: &MaterialAssets, context: &egui::Context) {
        let wanted = (self.medium, settings.is_six_way());
        if self.asked.as_ref().is_none_or(|(asked, _)| *asked != wanted) {
            if let Err(error) = self.ask(wanted, session) {
                self.failed = Some(error.to_string());
                return;
            }
            self.compared = None;
            self.failed = None;
        }
        match self.worker.as_ref().and_then(Worker::poll) {
            Some(Some(Ok(traced))) => self.traced = Some((wanted, traced)),
            Some(Some(Err(error))) => self.failed = error,
            Some(None) => self.failed = Some("Path tracing failed: internal error".into()),
            None => {}
        }
        let of = (wanted, settings.diffuse.backlight == Backlight::Ramp);
        let Some((_, traced)) = self.traced.as_ref().filter(|(of, _)| *of == wanted) else { return };
        let is_made = |made: &Compared| made.of == of && made.material.shares_memory(material);
        if !self.compared.as_ref().is_some_and(is_made) {
            let (sheet, response) = traced.compared(material, of.1, context);
            self.compared = Some(Compared { of, material: material.clone(), sheet, response });
        }
    }

    fn ask(&mut self, wanted: Wanted, session: &Session) -> Result<(), Error> {
        if let Some((_, ticket)) = self.asked.take() {
            ticket.cancel();
        }
        let worker = match &self.worker {
            Some(worker) => worker,
            None => {
                let wake = session.repaint.clone();
                let worker = Worker::new("puff", move || wake.call());
                self.worker
                    .insert(worker.map_err(|error| Error::from(AssetError::Io { path: "a thread".into(), error }))?)
            }
        };
        let (medium, is_six_way) = wanted;
        let ticket = worker.submit_portable(TracePuff { medium, is_six_way }, |_| true, |traced| traced);
        self.asked = Some((wanted, ticket));
        Ok(())
    }
}

impl TracedPuff {
    fn of(medium: &Medium, is_six_way: bool, go_on: impl Fn() -> Result<(), Stopped>) -> Result<Self, Stopped> {
        let progress = |_| go_on();
        let recipe = sprite_recipe(&default_sprite())?;
        let puff = Puff::trace(&recipe, medium, &PATH_TRACE, progress)?;
        let recipe = SpriteRecipe { size: PATH_TRACE.size, columns: 1, rows: 1, tolerance: 0, ..recipe };
        let bake = || recipe.bake_six_way(medium, PATH_TRACE.samples, |_, path| progress(path));
        Ok(Self { puff, maps: is_six_way.then(bake).transpose()? })
    }

    fn compared(&self, material: &MaterialAssets, backlit: bool, context: &egui::Context) -> (TextureHandle, Response) {
        let backlight = backlit.then_some(&material.backlight_ramp);
        let ramps = DiffuseRamps { diffuse: &material.diffuse_ramp, backlight };
        let light = |light| match &self.maps {
            Some(maps) => self.puff.shown_six_way(maps, light),
            None => self.puff.shown(ramps, light),
        };
        let response = self.puff.compare_images(light);
        let pairs = image_pairs(&self.puff, &ComparedImages { light: &light, exposure: response.exposure });
        let side = PATH_TRACE.size;
        let sheet = image::RgbImage::from_fn(side * LIGHTS, 2 * side, |x, y| {
            let pair = &pairs[(x / side) as usize];
            *pair[(y / side) as usize].get_pixel(x % side, y % side)
        });
        let size = [sheet.width() as usize, sheet.height() as usize];
        let image = ColorImage::from_rgb(size, sheet.as_raw());
        (context.load_texture("puffs", image, TextureOptions::LINEAR), response)
    }
}

impl Compared {
    /// Draws both puffs under a light at an angle, blended from the two nearest lights.
    fn show(&self, ui: &mut Ui, angle: f32) {
        let count = LIGHTS as usize;
        let position = angle / 360.0 * LIGHTS as f32;
        let first = position as usize % count;
        let fraction = position.fract();
        let second = (first + 1) % count;
        ui.horizontal(|ui| {
            for (row, name) in
                ["Path traced", if self.of.0.1 { "Six-way maps" } else { "These ramps" }].iter().enumerate()
            {
                ui.vertical(|ui| {
                    let (rect, _) = ui.allocate_exact_size(vec2(SIDE, SIDE), egui::Sense::hover());
                    for (light, opacity) in [(first, 1.0), (second, fraction)] {
                        let tint = Color32::WHITE.gamma_multiply(opacity);
                        ui.painter().image(self.sheet.id(), rect, part(light, row), tint);
                    }
                    ui.weak(*name);
                });
            }
        });
        let lights = &self.response.lights;
        let mix = |of: fn(&haze_author::ramp::response::LightResponse) -> f32| {
            of(&lights[first]) * (1.0 - fraction) + of(&lights[second]) * fraction
        };
        let now = mix(|light| light.shown) / mix(|light| light.truth).max(f32::MIN_POSITIVE) - 1.0;
        ui.label(format!("Light at {angle:>3.0}°: {:+.0} %", 100.0 * now));
        let Response { error, pixel_error, .. } = self.response;
        ui.label(format!("All lights: {:.1} %, pixels {:.0} %", 100.0 * error, 100.0 * pixel_error)).on_hover_text(
            "Error of the brightness, averaged over 16 lights, and RMS error of all pixels, at the best exposure. \
             `haze ramp fit` makes ramps with the least error.",
        );
    }
}

/// Returns the texture coordinates of a light's puff on the sheet. A margin of half a texel excludes its neighbours.
fn part(light: usize, row: usize) -> Rect {
    let size = UVec2::new(LIGHTS, 2).as_vec2();
    let side = PATH_TRACE.size as f32;
    let at = |x: f32, y: f32| pos2((light as f32 + x) / size.x, (row as f32 + y) / size.y);
    let margin = 0.5 / side;
    Rect::from_min_max(at(margin, margin), at(1.0 - margin, 1.0 - margin))
}

/// Returns the angle of a rotating light about the vertical, from the camera's side to the right, degrees.
fn angle(turn: &LightTurn, light: &Light, eye: Vec3) -> f32 {
    let light = turn.turned(light);
    let to_light = match light.kind {
        LightKind::Directional => -light.direction,
        _ => light.position - turn.middle,
    };
    let to_eye = (eye - turn.middle).with_y(0.0).normalize_or(Vec3::Z);
    let right = vec3(to_eye.z, 0.0, -to_eye.x);
    to_light.dot(right).atan2(to_light.dot(to_eye)).rem_euclid(TAU).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_traced_puff_is_the_same_when_it_is_sent_as_text() {
        let recipe = SpriteRecipe { size: 8, columns: 1, rows: 1, ..sprite_recipe(&default_sprite()).unwrap() };
        let path_trace = PathTrace { size: 8, samples: 1, seed: 1 };
        let medium = &MEDIA[0].medium;
        let puff = Puff::trace(&recipe, medium, &path_trace, |_| Ok::<_, ()>(())).unwrap();
        let maps = recipe.bake_six_way(medium, 1, |_, _| Ok::<_, ()>(())).ok();
        let here = TracedPuff { puff, maps };
        let there: TracedPuff = serde_json::from_str(&serde_json::to_string(&here).unwrap()).unwrap();
        let [here, there] = [here, there].map(|TracedPuff { puff, maps }| {
            let maps = maps.unwrap();
            (0..LIGHTS as usize).map(|light| puff.shown_six_way(&maps, light)).collect::<Vec<_>>()
        });
        assert_eq!(here, there);
    }
}
