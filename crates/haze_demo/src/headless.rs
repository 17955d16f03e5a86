//! Device without a window, and read-back of images, for tests, tools and examples.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

use glam::{UVec2, Vec4};
use half::f16;

use haze::error::{Error, FieldError};

/// Time to wait for a callback after the GPU is done. Far longer than it takes.
const READ_BACK_TIMEOUT: Duration = Duration::from_secs(10);

/// Hint for machines without an adapter.
const NO_ADAPTER_HINT: &str = "no graphics adapter was found; on Debian and Ubuntu \
    `apt-get install mesa-vulkan-drivers` installs a software one";

/// Returns the fastest adapter, or the one that `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` select.
fn find_adapter() -> Result<wgpu::Adapter, Error> {
    let variable = |name| std::env::var_os(name).unwrap_or_default().to_string_lossy().into_owned();
    let (backends, name) = (variable("WGPU_BACKEND"), variable("WGPU_ADAPTER_NAME"));
    let built_in = wgpu::Instance::enabled_backend_features();
    let list = || {
        let names: Vec<_> = wgpu::Backend::ALL.into_iter().filter(|&b| built_in.contains(b.into())).collect();
        names.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    };
    let mut wanted = wgpu::Backends::all();
    if !backends.is_empty() {
        wanted = wgpu::Backends::from_comma_list(&backends);
        if wanted.is_empty() {
            return Err(
                FieldError::new("WGPU_BACKEND", format!("{backends:?}"), format!("one or more of {}", list())).into()
            );
        }
    }
    let mut others = Vec::new();
    // OpenGL last: opening it prints warnings on machines without a display.
    for group in [wgpu::Backends::PRIMARY, wgpu::Backends::SECONDARY] {
        let group = group & wanted & built_in;
        if group.is_empty() {
            continue;
        }
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: group,
            ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
        });
        if name.is_empty() {
            let options = wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                ..Default::default()
            };
            if let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) {
                return Ok(adapter);
            }
        } else {
            for adapter in pollster::block_on(instance.enumerate_adapters(group)) {
                let info = adapter.get_info();
                if info.name.to_lowercase().contains(&name.to_lowercase()) {
                    return Ok(adapter);
                }
                others.push(format!("{:?} ({})", info.name, info.backend));
            }
        }
    }
    if !others.is_empty() {
        let expected = format!("a part of a name: {}", others.join(" or "));
        return Err(FieldError::new("WGPU_ADAPTER_NAME", format!("{name:?}"), expected).into());
    }
    let mut reason = NO_ADAPTER_HINT.to_owned();
    if !backends.is_empty() {
        reason += &format!("; WGPU_BACKEND allows only {backends:?} of {}", list());
    }
    Err(Error::NoDevice(reason))
}

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
    /// [`Error::NoDevice`] with the command that installs a software adapter; [`Error::Field`] if one of the variables
    /// selects something that does not exist.
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
                wgpu::Error::OutOfMemory { .. } => "out of memory; a smaller picture needs less".into(),
                error => error.to_string(),
            });
        }));
        Ok(Self { adapter, device, queue, failures })
    }

    /// Adapter, backend and driver, and a note for software adapters, in one line.
    pub fn description(&self) -> String {
        let info = self.adapter.get_info();
        let driver = format!("{} {}", info.driver, info.driver_info);
        let software = if info.device_type == wgpu::DeviceType::Cpu { ", software" } else { "" };
        format!("{} ({:?}, {}{software})", info.name, info.backend, driver.trim())
    }

    /// True if the adapter can draw to a format. OpenGL does not guarantee that for every format.
    pub fn can_draw_to(&self, format: wgpu::TextureFormat) -> bool {
        let usages = self.adapter.get_texture_format_features(format).allowed_usages;
        usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
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
        self.wait()
    }

    fn wait(&self) -> Result<(), Error> {
        while !self.failures.lost.load(Ordering::SeqCst) {
            match self.device.poll(wgpu::PollType::wait_indefinitely()) {
                Ok(_) => break,
                // On OpenGL wgpu waits for four seconds at most.
                Err(wgpu::PollError::Timeout) => {}
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
        self.wait()?;
        // Another thread's poll may run the callback, a moment after this thread's poll has returned.
        let mapped = mapped.recv_timeout(READ_BACK_TIMEOUT).map_err(|error| Error::Device(error.to_string()))?;
        mapped.map_err(|error| Error::Device(error.to_string()))?;
        let bytes = read.get_mapped_range(..).map_err(|error| Error::Device(error.to_string()))?.to_vec();
        read.unmap();
        Ok(bytes)
    }
}
