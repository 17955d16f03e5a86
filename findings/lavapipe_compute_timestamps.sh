#!/bin/sh
# Mesa 22.3.6, lavapipe (Vulkan on the CPU): once a render pass has run on a device, the timestamps of a compute pass no longer
# enclose its work. Both are taken after it: a pass of a second reads as 0.02 ms. Before the first render pass they are right.
# One expects the pass's own time at any point of a program. Times of haze's compute passes on lavapipe are wrong in the same way:
# docs/bench.md, "Method".
# Seen with wgpu-py 0.32.0.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/python"
"$folder/python/bin/pip" install --quiet wgpu==0.32.0
"$folder/python/bin/python" - <<'PYTHON'
import struct
import sys
import time

import wgpu

INVOCATIONS = 1 << 16
WGSL = """
@group(0) @binding(0) var<storage, read_write> results: array<f32>;

@compute @workgroup_size(64)
fn work(@builtin(global_invocation_id) id: vec3u) {
    var value = f32(id.x);
    for (var round = 0u; round < 2000u; round++) {
        value = fract(sin(value) * 43758.5);
    }
    results[id.x] = value;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment() -> @location(0) vec4f {
    return vec4f(1.0);
}
"""

adapters = [adapter for adapter in wgpu.gpu.enumerate_adapters_sync()
            if "llvmpipe" in adapter.info["device"] and adapter.info["backend_type"] == "Vulkan"]
if not adapters:
    sys.exit("no lavapipe: install mesa-vulkan-drivers")
print(adapters[0].info["device"], adapters[0].info["description"])
device = adapters[0].request_device_sync(required_features=["timestamp-query"])
module = device.create_shader_module(code=WGSL)
results = device.create_buffer(size=4 * INVOCATIONS, usage=wgpu.BufferUsage.STORAGE)
compute = device.create_compute_pipeline(layout="auto", compute={"module": module, "entry_point": "work"})
group = device.create_bind_group(layout=compute.get_bind_group_layout(0),
                                 entries=[{"binding": 0, "resource": {"buffer": results}}])
target = device.create_texture(size=(64, 64, 1), format="rgba8unorm", usage=wgpu.TextureUsage.RENDER_ATTACHMENT)
render = device.create_render_pipeline(
    layout="auto", vertex={"module": module, "entry_point": "vertex"},
    fragment={"module": module, "entry_point": "fragment", "targets": [{"format": "rgba8unorm"}]})
queries = device.create_query_set(type="timestamp", count=2)
resolved = device.create_buffer(size=16, usage=wgpu.BufferUsage.QUERY_RESOLVE | wgpu.BufferUsage.COPY_SRC)


def draw():
    encoder = device.create_command_encoder()
    attachment = {"view": target.create_view(), "load_op": "clear", "store_op": "store", "clear_value": (0, 0, 0, 0)}
    drawing = encoder.begin_render_pass(color_attachments=[attachment])
    drawing.set_pipeline(render)
    drawing.draw(3)
    drawing.end()
    device.queue.submit([encoder.finish()])


def fraction_of_wall_time():
    """Measures the compute pass: its time by timestamps, divided by that of the submission by the clock."""
    start = time.perf_counter()
    encoder = device.create_command_encoder()
    work = encoder.begin_compute_pass(timestamp_writes={
        "query_set": queries, "beginning_of_pass_write_index": 0, "end_of_pass_write_index": 1})
    work.set_pipeline(compute)
    work.set_bind_group(0, group)
    work.dispatch_workgroups(INVOCATIONS // 64)
    work.end()
    encoder.resolve_query_set(queries, 0, 2, resolved, 0)
    device.queue.submit([encoder.finish()])
    begin, end = struct.unpack("QQ", device.queue.read_buffer(resolved))
    wall = 1000 * (time.perf_counter() - start)
    print(f"  {(end - begin) / 1e6:.3f} ms by timestamps, {wall:.1f} ms by the clock")
    return (end - begin) / 1e6 / wall


fraction_of_wall_time()
print("before the first render pass:")
before = fraction_of_wall_time()
draw()
print("after it:")
after = fraction_of_wall_time()
if before < 0.5 or after > 0.1:
    sys.exit("changed: timestamps no longer lose the work of compute passes, or they never have it")
PYTHON
echo "as described"
