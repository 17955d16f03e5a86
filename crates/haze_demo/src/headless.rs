//! Device without a window, and read-back of images, for tests, tools and examples.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use glam::{UVec2, Vec4};
use half::f16;

use haze_core::error::Error;

use super::adapter_choice::find_adapter;
pub use super::address_space::check_address_space;

/// Time to wait for a callback after the GPU is done. Far longer than it takes.
const READ_BACK_TIMEOUT: Duration = Duration::from_secs(10);

/// Longest time to wait for one submission. A frame of 8192x8192 pixels with a hundred layers of smoke takes minutes on one
/// slow core; a device that takes longer than this does not work at all.
pub const WAIT_LIMIT: Duration = Duration::from_secs(30 * 60);
/// Longest time to wait for the first submission, which clears a few pixels: milliseconds, also on a busy machine.
const FIRST_WAIT_LIMIT: Duration = Duration::from_secs(20);

/// Device that records its failures: nothing panics when the driver fails.
#[derive(Debug)]
pub struct Headless {
    /// Selected adapter.
    pub adapter: wgpu::Adapter,
    /// Device of the adapter.
    pub device: wgpu::Device,
    /// Queue of the device.
    pub queue: wgpu::Queue,
    failures: Arc<Failures>,
}

#[derive(Debug, Default)]
struct Failures {
    /// Set once the device is lost. After that it must not be polled, because wgpu panics.
    lost: AtomicBool,
    /// Message of the first failure.
    message: Mutex<Option<String>>,
}

impl Failures {
    fn record(&self, message: String) {
        self.message.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
    }
}

impl Headless {
    /// Opens the fastest adapter; `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` select another.
    ///
    /// # Errors
    /// [`Error::NoDevice`] with the command that installs a software adapter, or if the limit of the process's address
    /// space is too low for a driver; [`Error::Field`] if one of the variables selects something that does not exist;
    /// [`Error::Device`] if the device does not clear a texture within 20 seconds.
    pub fn new() -> Result<Self, Error> {
        Self::with(wgpu::Limits::default(), wgpu::Features::empty())
    }

    /// As [`Headless::new`], with a device that has no more than these limits, except for textures, which may be as
    /// large as the adapter allows, and with those of `features` that the adapter has. haze needs no features.
    ///
    /// # Errors
    /// As [`Headless::new`]; [`Error::NoDevice`] also if the adapter does not have these limits.
    pub fn with(limits: wgpu::Limits, features: wgpu::Features) -> Result<Self, Error> {
        let adapter = find_adapter()?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("haze headless"),
            required_limits: limits.using_resolution(adapter.limits()),
            required_features: features & adapter.features(),
            ..Default::default()
        }))
        .map_err(|error| Error::NoDevice(format!("{}: {error}", adapter.get_info().name)))?;

        let failures = Arc::new(Failures::default());
        let lost = failures.clone();
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                lost.lost.store(true, Ordering::SeqCst);
                lost.record(format!("the device was lost: {message}"));
            }
        });
        let errors = failures.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            errors.record(match error {
                wgpu::Error::OutOfMemory { .. } => "out of memory; a smaller image needs less".into(),
                error => error.to_string(),
            });
        }));
        let headless = Self { adapter, device, queue, failures };
        headless.clear_texture()?;
        Ok(headless)
    }

    /// Clears a small texture, which a device without its threads never finishes.
    fn clear_texture(&self) -> Result<(), Error> {
        let target = self.target("first submission", UVec2::splat(16), wgpu::TextureFormat::Rgba8Unorm);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("first submission"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        }));
        self.queue.submit([encoder.finish()]);
        self.wait(FIRST_WAIT_LIMIT)
    }

    /// Adapter, backend and driver, and a note for software adapters, in one line.
    pub fn description(&self) -> String {
        let info = self.adapter.get_info();
        let driver = format!("{} {}", info.driver, info.driver_info);
        let software = if info.device_type == wgpu::DeviceType::Cpu { ", software" } else { "" };
        format!("{} ({:?}, {}{software})", info.name, info.backend, driver.trim())
    }

    /// Checks for failures since the device was created.
    ///
    /// # Errors
    /// [`Error::Device`] with the message of the first failure.
    pub fn check(&self) -> Result<(), Error> {
        let message = self.failures.message.lock().unwrap_or_else(PoisonError::into_inner);
        message.as_ref().map_or(Ok(()), |message| Err(Error::Device(message.clone())))
    }

    /// Submits and waits until the GPU is done.
    ///
    /// # Errors
    /// [`Error::Device`] if the device has failed, now or before.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<(), Error> {
        self.queue.submit([encoder.finish()]);
        self.wait(WAIT_LIMIT)
    }

    fn wait(&self, limit: Duration) -> Result<(), Error> {
        let end = Instant::now() + limit;
        while !self.failures.lost.load(Ordering::SeqCst) {
            let timeout = Some(end.saturating_duration_since(Instant::now()));
            match self.device.poll(wgpu::PollType::Wait { submission_index: None, timeout }) {
                Ok(_) => break,
                // On OpenGL wgpu waits for four seconds at most.
                Err(wgpu::PollError::Timeout) if Instant::now() < end => {}
                Err(wgpu::PollError::Timeout) => {
                    self.failures.record(format!(
                        "{} has not finished its work after {} s; a software adapter needs a thread for each processor: \
                         raise the limit of threads (`ulimit -u`), or render on the CPU (`--backend cpu`)",
                        self.adapter.get_info().name,
                        limit.as_secs()
                    ));
                    // Dropping the last handle would wait for the device without a limit.
                    std::mem::forget((self.device.clone(), self.queue.clone()));
                    break;
                }
                Err(error) => return Err(Error::Device(error.to_string())),
            }
        }
        self.check()
    }

    /// Creates a texture that can be drawn to, sampled and read back.
    pub fn target(&self, label: &str, size: UVec2, format: wgpu::TextureFormat) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    /// Reads back a buffer with `COPY_SRC` usage.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
        let read = self.read_back_buffer(buffer.size());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &read, 0, buffer.size());
        self.map(encoder, &read)
    }

    /// Reads back an `Rgba16Float` texture, row by row from the top.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_rgba16float(&self, texture: &wgpu::Texture) -> Result<Vec<Vec4>, Error> {
        let bytes = self.read_texture(texture, 8)?;
        let channel = |bytes: &[u8]| f16::from_le_bytes([bytes[0], bytes[1]]).to_f32();
        let texel = |t: &[u8]| Vec4::new(channel(&t[0..2]), channel(&t[2..4]), channel(&t[4..6]), channel(&t[6..8]));
        Ok(bytes.chunks_exact(8).map(texel).collect())
    }

    /// Reads back a `Depth32Float` or `R32Float` texture, row by row from the top.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_r32float(&self, texture: &wgpu::Texture) -> Result<Vec<f32>, Error> {
        let bytes = self.read_texture(texture, 4)?;
        Ok(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
    }

    fn read_texture(&self, texture: &wgpu::Texture, texel_size: u32) -> Result<Vec<u8>, Error> {
        let row = texture.width() * texel_size;
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let read = self.read_back_buffer(u64::from(padded) * u64::from(texture.height()));
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &read,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
            },
            texture.size(),
        );
        let bytes = self.map(encoder, &read)?;
        let rows: Vec<_> = bytes.chunks_exact(padded as usize).map(|line| &line[..row as usize]).collect();
        Ok(rows.concat())
    }

    fn read_back_buffer(&self, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("haze read back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    fn map(&self, encoder: wgpu::CommandEncoder, read: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
        self.queue.submit([encoder.finish()]);
        let (sender, mapped) = mpsc::channel();
        read.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone only if waiting failed, which is reported.
            let _ = sender.send(result);
        });
        self.wait(WAIT_LIMIT)?;
        // Another thread's poll may run the callback, a moment after this thread's poll has returned.
        let mapped = mapped.recv_timeout(READ_BACK_TIMEOUT).map_err(|error| Error::Device(error.to_string()))?;
        mapped.map_err(|error| Error::Device(error.to_string()))?;
        let bytes = read.get_mapped_range(..).map_err(|error| Error::Device(error.to_string()))?.to_vec();
        read.unmap();
        Ok(bytes)
    }
}
