//! Whether there is memory for a picture.

use glam::UVec2;
use haze::Error;

/// Bytes that a pixel takes on the way to a file. On the CPU 40: colour 16, depth 4, and at full scale accumulated 16 and
/// reduced depth 4; read back from the GPU 32: twice 8, then 16. Half as much again is for what an allocator keeps to itself.
/// Textures are the driver's, which says when it has no room.
const BYTES_A_PIXEL: u64 = 60;

/// Refuses a picture that there is no memory for: later, in the midst of the work, running out ends the program. `option` asks
/// for it.
pub fn check_memory(option: &str, size: UVec2) -> Result<(), Error> {
    let bytes = u64::from(size.x) * u64::from(size.y) * BYTES_A_PIXEL;
    let mut room = Vec::<u8>::new();
    let had = usize::try_from(bytes).is_ok_and(|bytes| room.try_reserve_exact(bytes).is_ok());
    // Else the compiler sees that nobody uses it.
    std::hint::black_box(&room);
    if had {
        return Ok(());
    }
    let reason = format!("out of memory: it takes {} MiB; expected a smaller picture", bytes >> 20);
    let error = std::io::Error::new(std::io::ErrorKind::OutOfMemory, reason);
    Err(Error::Io { path: format!("{option} {}x{}", size.x, size.y).into(), error })
}
