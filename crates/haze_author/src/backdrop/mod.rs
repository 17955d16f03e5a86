//! Backdrop of a shot: an artist's own scene and sky around the smoke, from the files that a preset names.

mod bvh;
mod color_texture;
#[cfg(not(target_arch = "wasm32"))]
mod covered_triangles;
#[cfg(not(target_arch = "wasm32"))]
mod decode_problem;
#[cfg(not(target_arch = "wasm32"))]
mod exr_header;
mod file_limits;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_accessor;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_files;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_import;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_json;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_problem;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_shape;
#[cfg(not(target_arch = "wasm32"))]
mod gltf_view;
#[cfg(not(target_arch = "wasm32"))]
mod name_list;
mod scene_mesh;
mod sky_image;
#[cfg(not(target_arch = "wasm32"))]
mod sky_import;
mod sky_light;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use haze_core::error::AssetError;
#[cfg(not(target_arch = "wasm32"))]
use haze_core::error::{FieldError, display_path};
use haze_core::settings::BackdropKind;
use haze_preset::{AssetFolders, Camera, Environment, Preset};
#[cfg(not(target_arch = "wasm32"))]
use haze_preset::{backdrop_endings, backdrop_file_path};

pub use bvh::{Bvh, BvhNode, Ray, RayHit, RayTriangle};
pub use color_texture::{ColorTexture, Wrap};
pub use file_limits::MAX_BACKDROP_FILE_BYTES;
#[cfg(not(target_arch = "wasm32"))]
pub use gltf_import::{MAX_TEXTURE_BYTES, MAX_TEXTURE_SIDE, MAX_TRIANGLES, load_scene};
pub use scene_mesh::{MASK_SIDE, SceneCamera, SceneMaterial, SceneMesh, SceneVertex, SurfacePoint};
pub use sky_image::{MAX_SKY_WIDTH, SkyImage, uv as sky_uv};
#[cfg(not(target_arch = "wasm32"))]
pub use sky_import::load_sky;
pub use sky_light::SkyLight;

/// `environment.sky_rotation` of a panorama that is the world of a Blender scene, beside the glTF file of that scene. The middle
/// of such a panorama lies in the direction +X of Blender, +x of the file; that of haze's in -z.
pub const BLENDER_SKY_ROTATION: f32 = 90.0;

/// Scene and sky that a preset names. Clones share them. Two are equal if they share them: files are not compared.
#[derive(Clone, Debug, Default)]
pub struct Backdrop {
    /// Scene instead of the demo scene.
    pub scene: Option<Arc<SceneMesh>>,
    /// Sky instead of the sky's colors.
    pub sky: Option<Arc<SkyImage>>,
}

/// Files of a backdrop as a preset names them: kind, field and name.
pub fn backdrop_names(environment: &Environment) -> [(BackdropKind, &'static str, &str); 2] {
    [
        (BackdropKind::Scene, "environment.scene_file", &environment.scene_file),
        (BackdropKind::Sky, "environment.sky_file", &environment.sky_file),
    ]
}

impl Backdrop {
    /// Loads the files that a preset names. They are searched for like images; `path`, the preset's file, is only named in
    /// errors.
    ///
    /// # Errors
    /// [`AssetError::JsonField`] for a name that is not valid, else that of the file in [`AssetError::Named`], with its field.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn load(preset: &Preset, path: &Path, folders: &AssetFolders) -> Result<Self, AssetError> {
        let mut backdrop = Self::default();
        for (kind, field, name) in backdrop_names(&preset.environment) {
            if !name.is_empty() {
                let named_by = || format!("{}: {field}", display_path(path));
                let of_file = |error| AssetError::Named { named_by: named_by(), error: Box::new(error) };
                let Some(file) = backdrop_file_path(name, kind) else {
                    let expected =
                        format!("a .{} file inside the preset's folder", backdrop_endings(kind).join(" or ."));
                    let error = FieldError::new(field, format!("{name:?}"), expected);
                    return Err(AssetError::JsonField { path: path.into(), error });
                };
                folders.find(file).and_then(|file| backdrop.load_file(kind, &file)).map_err(of_file)?;
            }
        }
        Ok(backdrop)
    }

    /// A page reads no scene and sky files, whose decoders would double its size: nothing is loaded.
    ///
    /// # Errors
    /// None.
    #[cfg(target_arch = "wasm32")]
    pub fn load(_: &Preset, _: &Path, _: &AssetFolders) -> Result<Self, AssetError> {
        Ok(Self::default())
    }

    /// A page reads no scene and sky files: nothing is loaded.
    ///
    /// # Errors
    /// None.
    #[cfg(target_arch = "wasm32")]
    pub fn load_file(&mut self, _: BackdropKind, _: &Path) -> Result<(), AssetError> {
        Ok(())
    }

    /// Loads a file instead of that of its kind.
    ///
    /// # Errors
    /// As [`load_scene`] and [`load_sky`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn load_file(&mut self, kind: BackdropKind, file: &Path) -> Result<(), AssetError> {
        match kind {
            BackdropKind::Scene => self.scene = Some(Arc::new(load_scene(file)?)),
            BackdropKind::Sky => self.sky = Some(Arc::new(load_sky(file)?)),
        }
        Ok(())
    }
    /// Files that it was read from: those that a preset names, and those beside a scene that it names.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let of_scene = self.scene.iter().flat_map(|scene| &scene.files);
        of_scene.chain(self.sky.iter().map(|sky| &sky.file)).map(PathBuf::as_path)
    }

    /// Scene, if any. A page has none: what uses it is left out of its program.
    pub fn mesh(&self) -> Option<&SceneMesh> {
        self.scene.as_deref().filter(|_| !cfg!(target_arch = "wasm32"))
    }

    /// Parts of the scene file that are not shown, and a sky that may be turned wrong beside it, each in a line that begins with
    /// the file's name.
    pub fn notes(&self, environment: &Environment) -> Vec<String> {
        let Some(scene) = self.mesh() else { return Vec::new() };
        let file = scene.files.first().and_then(|file| file.file_name()).unwrap_or_default().to_string_lossy();
        let mut notes: Vec<_> = scene.notes.iter().map(|note| format!("{file}: {note}")).collect();
        if scene.is_from_blender && self.sky.is_some() && environment.sky_rotation == 0.0 {
            notes.push(format!(
                "{}: environment.sky_rotation is 0; expected {BLENDER_SKY_ROTATION} if it is the world of {file}, a scene \
                 from Blender",
                environment.sky_file
            ));
        }
        notes
    }

    /// True if Blender wrote the scene file.
    pub fn is_from_blender(&self) -> bool {
        self.mesh().is_some_and(|scene| scene.is_from_blender)
    }

    /// Replaces a preset's camera by that of the scene with this name, or its first, except for the exposure. Its tracks go.
    /// False if there is none.
    pub fn take_camera(&self, name: Option<&str>, preset: &mut Preset) -> bool {
        let scale = preset.environment.scene_scale;
        let Some(camera) = self.mesh().and_then(|scene| scene.camera_at_scale(name, scale)) else { return false };
        preset.camera = Camera { exposure: preset.camera.exposure, ..camera };
        preset.animation.retain(|track| {
            let of_camera = track.setting.strip_prefix("camera.");
            of_camera.is_none_or(|field| field == "exposure")
        });
        true
    }

    /// Replaces a preset's lights by those of the scene. Their tracks go. False if it has none.
    pub fn take_lights(&self, preset: &mut Preset) -> bool {
        let scale = preset.environment.scene_scale;
        let lights = self.mesh().map(|scene| scene.lights_at_scale(scale)).unwrap_or_default();
        if lights.is_empty() {
            return false;
        }
        preset.lights = lights;
        preset.animation.retain(|track| !track.setting.starts_with("lights["));
        true
    }
}

impl PartialEq for Backdrop {
    fn eq(&self, other: &Self) -> bool {
        fn same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
            a.map(Arc::as_ptr) == b.map(Arc::as_ptr)
        }
        same(self.scene.as_ref(), other.scene.as_ref()) && same(self.sky.as_ref(), other.sky.as_ref())
    }
}

/// Files beside a scene file that it names: buffers and images. None for other files.
pub fn companion_files(file: &Path) -> Vec<PathBuf> {
    #[cfg(not(target_arch = "wasm32"))]
    if haze_preset::backdrop_kind(file) == Some(BackdropKind::Scene) {
        return gltf_files::companion_files(file);
    }
    let _ = file;
    Vec::new()
}
