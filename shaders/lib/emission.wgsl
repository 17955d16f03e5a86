// Light of fire, shared by the passes that light smoke.

#import "lib/bindings.wgsl"
#import "lib/fire.wgsl"
#import "lib/ramp.wgsl"

// Light that hot smoke gives, per share of the scene that all smoke hides. `fire`: as from fire_from_moments().
fn emission(fire: vec2f, amount: f32) -> vec3f {
    let at = vec2f(fire.x, coverage(amount * fire.y, system.boost));
    return sample_ramp_2d(fire_ramp, linear_sampler, at) * (system.fire_intensity * fire.y);
}
