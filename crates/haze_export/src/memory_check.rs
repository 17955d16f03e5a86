//! Checks that an image fits into memory.

use glam::UVec2;
use haze_core::error::{AssetError, Error};

/// Bytes of memory per pixel between rendering and the file. The CPU renderer takes 40: color 16, depth 4, and at full
/// scale accumulation 16 and reduced depth 4. A readback from the GPU takes 32: two buffers of 8, then 16. Half as much
/// again allows for the allocator's overhead. Texture memory is checked by the driver.
pub const BYTES_PER_PIXEL: u64 = 60;

/// Refuses an image that does not fit into memory, with so many bytes per pixel. Without this check, running out during the
/// work would abort the program. `option` is the option that asked for the size.
pub fn check_memory(option: &str, size: UVec2, bytes_per_pixel: u64) -> Result<(), Error> {
    let bytes = u64::from(size.x) * u64::from(size.y) * bytes_per_pixel;
    let mut allocation = Vec::<u8>::new();
    let fits = usize::try_from(bytes).is_ok_and(|bytes| allocation.try_reserve_exact(bytes).is_ok());
    // Without this the compiler may remove the unused allocation.
    std::hint::black_box(&allocation);
    if fits {
        return Ok(());
    }
    let reason = format!("out of memory: it needs {} MiB; expected a smaller size", bytes >> 20);
    let error = std::io::Error::new(std::io::ErrorKind::OutOfMemory, reason);
    Err(Error::from(AssetError::Io { path: format!("{option} {}x{}", size.x, size.y).into(), error }))
}
