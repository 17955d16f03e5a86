// depth_sort
// Sorts a host's particles back to front, for the paths that blend: computes the sort keys before the sort, and moves
// each particle to its position after it.
//
// Reads   particles; after the sort, the sorted particle indices.
// Writes  keys and particle indices; after the sort, sorted particles.
// Space   View space.

#import "lib/bindings.wgsl"
#import "lib/particle.wgsl"
#import "lib/tiles.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
// PARTICLE_VECTORS per particle.
@group(3) @binding(1) var<storage, read> particles: array<vec4u>;
@group(3) @binding(2) var<storage, read_write> keys: array<u32>;
@group(3) @binding(3) var<storage, read_write> indices: array<u32>;
@group(3) @binding(4) var<storage, read_write> sorted_particles: array<vec4u>;

@compute @workgroup_size(64)
fn depth_keys(@builtin(global_invocation_id) invocation: vec3u) {
    let index = invocation.x;
    if index >= tiles.count {
        return;
    }
    let position = bitcast<vec3f>(particles[tiles.first + PARTICLE_VECTORS * index].xyz);
    let view_z = (system.view_from_particles * vec4f(position, 1.0)).z;
    // Particles that are not drawn come last: their indices are higher than those of drawn ones with the same key.
    keys[index] = select(0xffffffffu, ~front_to_back_bits(view_z), index < system.alive_count);
    indices[index] = index;
}

@compute @workgroup_size(64)
fn gather_particles(@builtin(global_invocation_id) invocation: vec3u) {
    let position = invocation.x;
    if position >= tiles.count {
        return;
    }
    let at = tiles.first + PARTICLE_VECTORS * indices[position];
    for (var i = 0u; i < PARTICLE_VECTORS; i++) {
        sorted_particles[PARTICLE_VECTORS * position + i] = particles[at + i];
    }
}
