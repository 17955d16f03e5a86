//! Bind groups of a system's textures.

/// Bind groups by what they are for, kept until the textures are others.
#[derive(Debug, Default)]
pub(crate) struct InputGroups(Vec<(&'static str, wgpu::BindGroup)>);

impl InputGroups {
    /// Returns the bind group of this name; creates it on first use.
    pub fn get(&mut self, name: &'static str, create: impl FnOnce() -> wgpu::BindGroup) -> wgpu::BindGroup {
        if let Some((_, group)) = self.0.iter().find(|(known, _)| *known == name) {
            return group.clone();
        }
        let group = create();
        self.0.push((name, group.clone()));
        group
    }

    /// Forgets all groups.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}
