//! Plugins of the examples: Bevy's default ones. With `--screenshot FILE [--seconds N]`, an example runs without a window,
//! renders N seconds (default 3), saves the last image as a PNG file and exits.

use std::path::PathBuf;
use std::time::Duration;

use bevy::app::{PluginGroupBuilder, ScheduleRunnerPlugin};
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;

const SIZE: [u32; 2] = [1280, 720];
const FRAMES_PER_SECOND: u32 = 20;

/// `DefaultPlugins`, or with `--screenshot`, the same without a window.
pub struct ExamplePlugins;

impl PluginGroup for ExamplePlugins {
    fn build(self) -> PluginGroupBuilder {
        let plugins = DefaultPlugins.build();
        let Some(file) = argument("--screenshot") else { return plugins };
        let seconds = argument("--seconds").and_then(|seconds| seconds.parse().ok()).unwrap_or(3.0_f32);
        let frames = (seconds.max(0.0) * FRAMES_PER_SECOND as f32) as u32;
        plugins
            .disable::<WinitPlugin>()
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
            .add(ScheduleRunnerPlugin::run_loop(Duration::ZERO))
            .add(ScreenshotPlugin { file: file.into(), frames })
    }
}

fn argument(name: &str) -> Option<String> {
    std::env::args().skip_while(|argument| argument != name).nth(1)
}

struct ScreenshotPlugin {
    file: PathBuf,
    frames: u32,
}

#[derive(Resource)]
struct Progress {
    file: PathBuf,
    target: Handle<Image>,
    frames_left: u32,
    taken: bool,
}

impl Plugin for ScreenshotPlugin {
    fn build(&self, app: &mut App) {
        let mut image = Image::new_target_texture(SIZE[0], SIZE[1], TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        // Frames of equal length give the same image at each run.
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1) / FRAMES_PER_SECOND))
            .insert_resource(Progress { file: self.file.clone(), target, frames_left: self.frames, taken: false })
            .add_systems(PostStartup, redirect_cameras)
            .add_systems(Last, take_screenshot);
    }
}

/// Cameras of the window draw into the image.
fn redirect_cameras(mut targets: Query<&mut RenderTarget>, progress: Res<Progress>) {
    for mut target in &mut targets {
        if matches!(*target, RenderTarget::Window(_)) {
            *target = RenderTarget::Image(progress.target.clone().into());
        }
    }
}

fn take_screenshot(mut commands: Commands, mut progress: ResMut<Progress>, shots: Query<&Screenshot>) {
    if progress.frames_left > 0 {
        progress.frames_left -= 1;
    } else if !progress.taken {
        progress.taken = true;
        commands.spawn(Screenshot::image(progress.target.clone())).observe(save_to_disk(progress.file.clone()));
    } else if shots.is_empty() {
        commands.write_message(AppExit::Success);
    }
}
