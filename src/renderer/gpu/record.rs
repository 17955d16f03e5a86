//! Recording helpers: passes that haze begins itself, and buffers.

use haze_core::glam::UVec2;

use super::timing::Timing;

/// Returns a color attachment that is cleared to zero.
pub(crate) fn color_attachment(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
    })
}

/// Returns a depth attachment that is tested, not written.
pub(crate) fn tested_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops: None }
}

/// Returns a depth attachment that is cleared to 1 and written.
pub(crate) fn written_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

pub(crate) fn begin_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &'static str,
    color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    timing: Option<&Timing>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments,
        depth_stencil_attachment,
        timestamp_writes: timing.and_then(|timing| timing.pass(label)),
        ..Default::default()
    })
}

/// Restricts a pass to a rectangle of its targets.
pub(crate) fn set_viewport_and_scissor(pass: &mut wgpu::RenderPass<'_>, origin: UVec2, size: UVec2) {
    pass.set_viewport(origin.x as f32, origin.y as f32, size.x as f32, size.y as f32, 0.0, 1.0);
    pass.set_scissor_rect(origin.x, origin.y, size.x, size.y);
}

/// Creates a buffer for one uniform block.
pub(crate) fn uniform_buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
