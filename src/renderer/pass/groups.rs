//! Bind groups that the passes of a system share.

/// Bind groups 0 to 2 of a system's passes.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    pub frame: wgpu::BindGroup,
    pub system: wgpu::BindGroup,
    pub material: wgpu::BindGroup,
    /// The part of the material that the passes that light accumulated smoke read.
    pub lighting: wgpu::BindGroup,
}

impl Groups {
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.bind_with(pass, &self.material);
    }

    /// Binds the groups of a pass that lights accumulated smoke.
    pub fn bind_for_lighting(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.bind_with(pass, &self.lighting);
    }

    fn bind_with(&self, pass: &mut wgpu::RenderPass<'_>, material: &wgpu::BindGroup) {
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_bind_group(1, &self.system, &[]);
        pass.set_bind_group(2, material, &[]);
    }

    pub fn bind_to_compute(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.bind_to_compute_with(pass, &self.material);
    }

    /// As [`bind_for_lighting`](Self::bind_for_lighting), for a compute pass.
    pub fn bind_to_compute_for_lighting(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.bind_to_compute_with(pass, &self.lighting);
    }

    fn bind_to_compute_with(&self, pass: &mut wgpu::ComputePass<'_>, material: &wgpu::BindGroup) {
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_bind_group(1, &self.system, &[]);
        pass.set_bind_group(2, material, &[]);
    }
}
