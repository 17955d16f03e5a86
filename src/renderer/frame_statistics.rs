//! Targets, memory, counts and choices of a renderer's last frame.

use haze_core::view_setup::{LightingChoice, ScaleChoice};

use super::Renderer;
use super::auto::PathChoice;
use super::counts::{FrameCounts, Overdraw};
use super::memory_use::MemoryUse;
use super::resolved_depth::ResolvedDepth;
use super::system::SystemState;
use super::targets::TargetViews;

impl Renderer {
    /// Returns the view depth of a system's smoke, metres, by which [`render`](Self::render) sorts: `ParticleSystem::depth`, or
    /// the measured one. `None` if the system with this key is out of sight.
    pub fn depth_of(&self, key: u64) -> Option<f32> {
        let visible = self.order.iter().find(|visible| self.states[visible.state].key == key)?;
        Some(self.states[visible.state].lit_depth())
    }

    /// Returns the targets of the system with this key, as the last [`prepare`](Self::prepare) fills them, for tools
    /// and for a host's own passes. `None` if the system is out of sight or drawn forward.
    pub fn targets(&self, key: u64) -> Option<TargetViews<'_>> {
        self.states.iter().find(|state| state.key == key)?.target_views()
    }

    /// Returns the GPU memory that this renderer holds, in bytes.
    pub fn memory_use(&self) -> MemoryUse {
        let targets = self.resolved_depth.as_ref().map_or(0, ResolvedDepth::bytes);
        let buffers = self.bindings.bytes() + self.scene_shadow.bytes();
        let shadow = self.shadow_volume.bytes() + self.sliced_shadow.bytes() + self.screen_shadow.bytes();
        let own = MemoryUse { targets, buffers, shadow, ..MemoryUse::default() };
        self.states.iter().map(SystemState::memory_use).chain([own]).sum()
    }

    /// Counts the systems, sprites and texels that [`render`](Self::render) draws after the last
    /// [`prepare`](Self::prepare).
    pub fn counts(&self) -> FrameCounts {
        self.order.iter().map(|visible| self.states[visible.state].counts()).sum()
    }

    /// Returns the path that `auto` chose in the last [`prepare`](Self::prepare) for the system with this key, with the
    /// reason. `None` if the system is out of sight or its path setting is not `auto`.
    pub fn path_choice(&self, key: u64) -> Option<PathChoice> {
        self.states.iter().find(|state| state.key == key)?.choice()
    }

    /// Returns the lighting resolution that `auto` chose in the last [`prepare`](Self::prepare) for the system with this
    /// key, with the reason. `None` if the system is out of sight, drawn `forward`, or its setting is not `auto`.
    pub fn lighting_choice(&self, key: u64) -> Option<LightingChoice> {
        self.states.iter().find(|state| state.key == key)?.lighting_choice()
    }

    /// Returns the scale that `scale_mode` `auto` chose in the last [`prepare`](Self::prepare) for the system with this key,
    /// with the reason. `None` if the system is out of sight, drawn `forward`, or its scale is fixed.
    pub fn scale_choice(&self, key: u64) -> Option<ScaleChoice> {
        self.states.iter().find(|state| state.key == key)?.scale_choice()
    }

    /// Computes the overdraw of the sprites of the last [`prepare`](Self::prepare), on the CPU: about 0.5 ms for
    /// 10,000 sprites. At most 4096 sprites of a slice are counted.
    pub fn overdraw(&self) -> Overdraw {
        let Some(view) = self.view.map(|view| view.uniform(false)) else { return Overdraw::default() };
        self.order.iter().map(|visible| self.states[visible.state].overdraw(&view)).sum()
    }
}
