// depth_sort
// Sorts a host's particles back to front, for the paths that blend: computes the sort keys before the sort, and moves
// each particle to its place after it.
//
// Reads   particles; after the sort, the sorted particle indices.
// Writes  keys and particle indices; after the sort, sorted particles.
// Space   View space.

#import "lib/bindings.wgsl"
#import "lib/tiles.wgsl"

@group(3) @binding(0) var<uniform> tiles: Tiles;
// Two per particle, as in Particle.
@group(3) @binding(1) var<storage, read> particles: array<vec4f>;
@group(3) @binding(2) var<storage, read_write> keys: array<u32>;
@group(3) @binding(3) var<storage, read_write> indices: array<u32>;
@group(3) @binding(4) var<storage, read_write> sorted_particles: array<vec4f>;

@compute @workgroup_size(64)
fn depth_keys(@builtin(global_invocation_id) invocation: vec3u) {
    let index = invocation.x;
    if index >= tiles.count {
        return;
    }
    let position = particles[tiles.first + 2u * index].xyz;
    let view_z = (system.view_from_particles * vec4f(position, 1.0)).z;
    // Particles that are not drawn come last: their indices are higher than those of drawn ones with the same key.
    keys[index] = select(0xffffffffu, ~front_to_back_bits(view_z), index < system.alive_count);
    indices[index] = index;
}

@compute @workgroup_size(64)
fn gather_particles(@builtin(global_invocation_id) invocation: vec3u) {
    let place = invocation.x;
    if place >= tiles.count {
        return;
    }
    let at = tiles.first + 2u * indices[place];
    sorted_particles[2u * place] = particles[at];
    sorted_particles[2u * place + 1u] = particles[at + 1u];
}
