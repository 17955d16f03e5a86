//! Deferred particle shading for wgpu: smoke is accumulated as *normal and amount* into a small offscreen target, then
//! lit **once per pixel** from ramp textures that an artist can paint.
//!
//! ```text
//! host:                opaque scene ─► scene color (HDR) + scene depth
//!                                                              │ sampled
//! Renderer::prepare    measure            extent of particles in a host's buffer
//!   (host's encoder)   sort               particles ─► back to front (a slice by the CPU, a buffer by the GPU: depth_sort)
//!                      density_splat      sprites ─► density grid, if a system receives shadow
//!                      shadow_visibility  a host's shadow maps ─► visibility of lights from each cell
//!                      shadow_march       density grid ─► optical depths towards lights, openness to sky and ground
//!                                         (without compute: shadow_march_slice, shadow_visibility_slice)
//!                      depth_resolve      multisampled scene depth ─► farthest sample of each pixel
//!                      depth_downsample   scene depth ─► reduced depth, linear view metres
//!                      diffuse_bake       lights ─► cubemap or motif, if a system uses one
//!                      accumulate         sprites × normal map × soft fade ─► premultiplied normal, amount
//!                                         (path tiled: emit, tile_project, sort, tile_gather, tile_bin, tile_refine,
//!                                         tile_accumulate)
//!                      light_target       normal, amount ─► lit smoke, if light is per texel
//!                      depth_slopes       lit smoke ─► its slope over depth, for upsampling
//!                      mark_cells         lit smoke, slopes ─► cells that hold any, if they are drawn
//!                      upsample_lit       lit smoke ─► pixels, where a GPU computes far faster than it draws
//! Renderer::render     screen_shadow      darkens the host's picture, if it calls render_scene_shadow
//!   (host's pass)      transfer           the system's bounding box: decode, light, upsample, blend on the scene
//!                                         (transfer_lit: the same with lit smoke)
//!                      specular_scatter   the glow of lights behind the smoke
//!                      forward            or: every fragment lit and blended at full resolution
//! ```
//!
//! # Limits
//! - It never creates a device, submits, tonemaps, or requires a device feature.
//! - It does not simulate. [`emitter`] is a closed-form source of particles; hosts with their own simulation pass a slice or a
//!   GPU buffer. The crate `haze_author` reads the particles of a simulation from files.
//!
//! # Quick start
//! ```no_run
//! # use haze::{glam, wgpu};
//! # fn host() -> (wgpu::Device, wgpu::Queue, wgpu::CommandEncoder, wgpu::TextureView, haze::View) { unimplemented!() }
//! # fn pass_with_read_only_depth(_: &mut wgpu::CommandEncoder) -> wgpu::RenderPass<'_> { unimplemented!() }
//! # let (device, queue, mut encoder, scene_depth, view) = host();
//! use haze::{Context, Descriptor, FrameInput, Light, ParticleSystem, Particles, Renderer, SceneDepth, Settings};
//!
//! // Once.
//! let context = Context::new(&device, &queue, None);
//! let mut smoke = Renderer::new(&context, &Descriptor::default())?;
//! let assets = haze::preset::MaterialNames::default().load("".as_ref())?;
//! let material = context.create_material(&assets)?;
//! let settings = Settings::default();
//!
//! // Every frame, after the opaque scene.
//! let mut particles = Vec::new();
//! haze::emitter::Emitter::default().evaluate(2.0, &mut particles);
//! let frame = FrameInput {
//!     lights: &[Light { position: glam::vec3(-3.0, 3.0, 2.0), intensity: 20.0, ..Light::default() }],
//!     systems: &[ParticleSystem::new(0, Particles::Slice(&particles), &settings, &material)],
//!     ..FrameInput::new(view, SceneDepth::Buffer(&scene_depth))
//! };
//! smoke.prepare(&mut encoder, &frame)?;
//! smoke.render(&mut pass_with_read_only_depth(&mut encoder));
//! # Ok::<(), haze::Error>(())
//! ```
//!
//! # Versions
//! haze follows semantic versioning; before 1.0 the minor version takes the place of the major one. wgpu's and glam's types
//! are part of the interface, so a new version of either that changes types comes with a new major version of haze;
//! [`wgpu`] and [`glam`] are the versions in use. A minor version may add fields and variants: create structs with
//! `..Default::default()` or `..FrameInput::new(…)`, and give every `match` a wildcard arm. Messages of errors, the feature
//! `exhaustive`, and items that these pages do not show may change in any version.
//!
//! # Conventions
//! Metres, seconds, radians; angles in settings are degrees. World and view space are the host's, left- or
//! right-handed. Internally, view space has x to the right, y up and z towards the viewer. Depth is linear *view
//! depth*, positive in front of the camera. Color is linear; ramps are sRGB images, decoded when loaded. NDC depth is
//! 0..1, in any of the usual conventions, which is derived from the projection. `shaders/README.md` and
//! `ramps/README.md` have the details.
//!
//! # Sources
//! - OTEE: N. Francis, *Deferred Particle Shading* (over the edge entertainment).
//! - NV: T. Lorach, *Soft Particles*, NVIDIA, 2007.
//! - BLOG: *Soft Particles*, after Umenhoffer et al., *Spherical Billboards*, 2006.
//! - MS: the DirectX 10 *SoftParticles* sample.

#[doc(hidden)]
pub mod assets;
pub mod emitter;
pub mod error;
pub mod fire;
#[doc(hidden)]
pub mod formula;
pub mod frame;
pub mod preset;
mod renderer;
pub mod settings;
#[doc(hidden)]
pub mod view_setup;

pub use assets::material_assets::MaterialAssets;
#[doc(inline)]
pub use assets::{builtin, image, noise, ramp, sprite};
pub use error::{Error, FieldError};
pub use frame::{
    AliveCount, Bounds, EmitterSnapshot, FrameInput, Light, LightKind, LightRole, Material, Particle, ParticleBuffer,
    ParticleSystem, Particles, SceneDepth, ShadowMap, ShadowProjection, SpriteExtent, View,
};
pub use renderer::{
    Context, Descriptor, FrameCounts, FrameTimes, MemoryUse, Overdraw, PassTime, PathChoice, PathCosts, PathModel,
    PathModelSource, PathReason, PathWorkload, Renderer, SceneDepthKind, TargetViews, TiledMemory, Timing,
    TimingDetail, WarmUp, read_only_depth_is_supported, shader,
};
pub use settings::{ScaleBudget, Settings};
pub use view_setup::{AttachmentRole, AttachmentSet, LightingChoice, ScaleChoice};

pub use glam;
pub use wgpu;

/// Compiles the code in the documents as a test.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/recipes.md")]
    struct Recipes;
}
