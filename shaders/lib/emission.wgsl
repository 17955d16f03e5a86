// Light of fire, shared by the passes that light smoke.

#import "lib/bindings.wgsl"
#import "lib/fire.wgsl"
#import "lib/response.wgsl"

// Light that hot smoke gives, per fraction of the scene that all smoke hides. `fire`: as from fire_from_moments().
fn emission(fire: vec2f, amount: f32) -> vec3f {
    return fire_response(fire_ramp, linear_sampler, fire, amount, system.boost) * system.fire_intensity;
}
