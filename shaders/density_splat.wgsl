// density_splat
// Adds the sprites of a system to the density grid of the frame. A workgroup adds one sprite, its invocations the cells.
//
// Reads   particles; the system's uniforms.
// Writes  optical depths across the cells, in fixed-point steps: the sum is the same in any order.
// Space   Cells of the grid.

#import "lib/bindings.wgsl"
#import "lib/density_grid.wgsl"
#import "lib/sprite_vertex.wgsl"

struct Splat {
    count: u32,
    // Start of the first particle, in units of vec4f.
    first: u32,
    // Workgroups in a row of the dispatch.
    columns: u32,
    padding: u32,
}

const WORKGROUP: u32 = 64u;

@group(3) @binding(0) var<uniform> splat: Splat;
// PARTICLE_VECTORS per particle.
@group(3) @binding(1) var<storage, read> particles: array<vec4u>;
// Two words per cell, the lower one first.
@group(3) @binding(2) var<storage, read_write> density: array<atomic<u32>>;

@compute @workgroup_size(64)
fn add_sprite(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = workgroup.y * splat.columns + workgroup.x;
    if index >= min(splat.count, system.alive_count) {
        return;
    }
    let at = splat.first + PARTICLE_VECTORS * index;
    let particle = particle_from_words(particles[at], particles[at + 1u], particles[at + 2u]);
    let in_view = (system.view_from_particles * vec4f(particle.position_radius.xyz, 1.0)).xyz;
    let center = (system.grid_from_view * vec4f(in_view, 1.0)).xyz;
    let radius = density_radius(particle);
    let depth = sprite_optical_depth(particle);
    let other = dot(abs(particle.rotation_amount_frame_age), vec4f(1.0)) + dot(abs(particle.velocity), vec3f(1.0));
    let magnitude = dot(abs(in_view), vec3f(1.0)) + abs(radius) + other;
    // False for NaN too.
    if !(magnitude < MAX_MAGNITUDE && radius > 0.0 && depth > 0.0) {
        return;
    }
    let last = system.grid_size - 1.0;
    let reach = bump_radius(radius);
    let low = vec3u(clamp(floor(center - reach), vec3f(0.0), last));
    let span = vec3u(clamp(floor(center + reach), vec3f(0.0), last)) - low + 1u;
    let size = vec3u(system.grid_size);
    for (var i = local; i < span.x * span.y * span.z; i += WORKGROUP) {
        let cell = low + vec3u(i % span.x, i / span.x % span.y, i / (span.x * span.y));
        let steps = density_steps(cell_optical_depth(vec3f(cell) - center, radius, depth));
        let word = 2u * ((cell.z * size.y + cell.y) * size.x + cell.x);
        let before = atomicAdd(&density[word], steps);
        if before > 0xffffffffu - steps {
            atomicAdd(&density[word + 1u], 1u);
        }
    }
}
