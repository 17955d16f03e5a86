// emit
// Evaluates the particles of an emitter, one per invocation.
//
// Reads   the emitter at a time.
// Writes  particles, in the order of their births; those that are not alive have amount 0.
// Space   World space.

#import "lib/emitter.wgsl"

@group(0) @binding(0) var<uniform> emitter: Emitter;
@group(0) @binding(1) var<storage, read_write> particles: array<EmittedParticle>;

@compute @workgroup_size(64)
fn emit(@builtin(global_invocation_id) invocation: vec3u) {
    if invocation.x < emitter.count {
        particles[invocation.x] = emitted_particle(emitter, invocation.x);
    }
}
