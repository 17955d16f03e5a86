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
//! Renderer::render     screen_shadow      darkens the host's image, if it calls render_scene_shadow
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
//! use haze::{
//!     Context, RendererDescriptor, FrameInput, Light, MaterialAssets, ParticleSystem, Particles, Renderer, SceneDepth, Settings,
//! };
//!
//! // Once.
//! let context = Context::new(&device, &queue);
//! let mut smoke = Renderer::new(&context, &RendererDescriptor::default())?;
//! let material = context.create_material(&MaterialAssets::default())?;
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
//! # Ok::<(), haze::PrepareError>(())
//! ```
//!
//! # Versions
//! haze follows semantic versioning; before 1.0 the minor version takes the place of the major one. wgpu's and glam's types
//! are part of the interface, so a new version of either that changes types comes with a new major version of haze;
//! [`wgpu`] and [`glam`] are the versions in use. A new major version may add fields and variants; structs that are created with
//! `..Default::default()` or `..FrameInput::new(…)`, and a `match` with a wildcard arm, compile with it as they are. Types that are
//! `non_exhaustive` may gain fields and variants in a minor version too: errors, and what haze reports ([`PathModel`],
//! [`MemoryUse`], [`TargetViews`] and others). Messages of errors may change in any version.
//!
//! # Features
//! - `preset` (default): [`preset`] and [`builtin`], and with them 1.7 MB of images. [`MaterialAssets::default`] needs neither.
//! - `schema`: JSON schemas of settings and presets.
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

mod frame;
mod renderer;

pub use haze_core::{emitter, fire};

#[doc(inline)]
pub use frame::{AliveCount, FrameInput, Material, ParticleBuffer, ParticleSystem, Particles, SceneDepth, ShadowMap};
#[doc(inline)]
pub use haze_core::assets::material_assets::MaterialAssets;
#[doc(inline)]
pub use haze_core::error::{AssetError, FieldError, PrepareError};
#[doc(inline)]
pub use haze_core::formula::ambient::hemisphere_light;
#[doc(inline)]
pub use haze_core::formula::shadow_map::MAX_SHADOW_LAYERS;
#[doc(inline)]
pub use haze_core::frame::{
    Bounds, EmitterPaths, EmitterSnapshot, Light, LightKind, LightRole, MAX_LIGHTS, MAX_MAGNITUDE, Particle,
    ShadowProjection, SpriteExtent, View, particle_bounds,
};
#[doc(inline)]
pub use haze_core::settings::Settings;
#[doc(inline)]
pub use haze_core::view_setup::{AttachmentRole, AttachmentSet, LightingChoice, ScaleChoice};
#[cfg(feature = "preset")]
#[doc(inline)]
pub use haze_preset::builtin;
pub use renderer::{
    Context, FrameCounts, FrameTimes, MemoryUse, Overdraw, PassTime, PathChoice, PathCosts, PathModel, PathModelSource,
    PathReason, PathWorkload, Renderer, RendererDescriptor, SceneDepthKind, TargetViews, TiledMemory, Timing,
    TimingDetail, WarmUp, read_only_depth_is_supported, shader,
};

/// Images in memory, and reading of PNG files.
pub mod image {
    #[doc(inline)]
    pub use haze_core::assets::image::{
        Image, MAX_BYTES, MAX_SIDE, color_conversion_notes, decode_color_png, decode_png, read_color_png, read_png,
    };
}

/// Tiling 3D noise.
pub mod noise {
    #[doc(inline)]
    pub use haze_core::assets::noise::{MAX_SIZE, NoiseVolume};
}

/// Presets: a camera, lights and particle systems in a JSON file.
#[cfg(feature = "preset")]
pub mod preset {
    #[doc(inline)]
    pub use haze_preset::{
        AnimatedPreset, AssetFolders, Camera, Ease, EndBehavior, Environment, Flicker, ImageCache, ImageSource,
        KeyValue, Keyframe, MAX_IMAGE_BYTES, MAX_KEYFRAMES, MAX_SYSTEMS, MAX_TIME, MaterialSources, PRESET_VERSION,
        ParticleFiles, Preset, PresetSystem, SceneName, Track, UpAxis,
    };
}

/// Ramps: light, heat and coverage as an artist painted them.
pub mod ramp {
    #[doc(inline)]
    pub use haze_core::assets::ramp::{Ramp, RampRole};
}

/// Flipbooks of normal maps.
pub mod sprite {
    #[doc(inline)]
    pub use haze_core::assets::sprite::{MAX_FRAMES, Sprite, SpriteLayout, six_way_layout};
}

/// Settings of one particle system: plain data with units and ranges. Every slider moves one of their fields.
pub mod settings {
    #[doc(inline)]
    pub use haze_core::settings::{
        Accumulate, AccumulationFormat, Ambient, BackdropKind, Backlight, BlendMode, BlendOrder, Budget,
        COARSEST_AUTO_SCALE, Choice, CoverageMode, Curve, CurveError, DebugSettings, DebugView, DepthDownsample,
        DepthSource, Diffuse, DiffuseMode, Exponential, FadeCurve, FieldHeading, FieldRef, FieldValue, FieldVisitor,
        Fields, Fire, Grain, ImageRole, Lighting, LightingResolution, MAX_CURVE_POINTS, NormalDecode, NormalEncoding,
        ParseChoiceError, PathStep, RampFilter, RenderPath, ScaleBudget, ScaleMode, Shadow, SoftFade, SoftScatter,
        SoftScatterMode, SpecularScatter, SphericalBillboard, SpriteAnimation, SpriteSettings, Technique, Traversal,
        Upsample, Volumetric, field_path, field_values, for_each_field, set_field, validate, write_field_path,
    };
}

pub use haze_core::glam;
pub use wgpu;

/// Compiles the code in the documents as a test.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/recipes.md")]
    struct Recipes;
}
