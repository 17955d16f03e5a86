//! Limits of the files of a backdrop.

/// Maximum size of a file, bytes.
pub const MAX_BACKDROP_FILE_BYTES: u64 = 512 << 20;
/// Maximum size of a scene file, and of each file beside it, bytes.
#[cfg(not(target_arch = "wasm32"))]
pub(super) const MAX_SCENE_FILE_BYTES: u64 = 256 << 20;
/// Maximum distance of a scene's parts from the origin, metres. As of lights and cameras.
#[cfg(not(target_arch = "wasm32"))]
pub(super) const MAX_DISTANCE: f32 = 1.0e5;
