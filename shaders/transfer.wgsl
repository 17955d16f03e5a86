// transfer: lights the accumulated smoke once per pixel over the system's bounding box.
// Reads   accumulation target, reduced depth, scene depth, lights, ramps, baked diffuse light.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE_MINUS_SRC_ALPHA (premultiplied over the scene).
// Source  OTEE "Transfer & lighting", "Diffuse lighting", "Soft scattering".
// Space   Lighting in view space, on the plane through the middle of the smoke that faces the viewer.

#import "lib/lit_smoke.wgsl"
#import "lib/shadow_views.wgsl"
#import "lib/bounding_box.wgsl"
#import "lib/coverage.wgsl"
#import "lib/color.wgsl"
#import "lib/blending.wgsl"

// True: there is no reduced depth; sprites were compared with the host's own depth.
override HOST_DEPTH: bool = false;

const DEBUG_VIEW_FINAL: u32 = 0u;
const DEBUG_VIEW_COMBINED: u32 = 1u;
const DEBUG_VIEW_DIFFUSE: u32 = 2u;
const DEBUG_VIEW_SOFT_SCATTER: u32 = 3u;
const DEBUG_VIEW_SPECULAR_SCATTER: u32 = 4u;
const DEBUG_VIEW_NORMALS: u32 = 5u;
const DEBUG_VIEW_AMOUNT: u32 = 6u;
const DEBUG_VIEW_OVERDRAW: u32 = 7u;
const DEBUG_VIEW_REDUCED_DEPTH: u32 = 8u;
const DEBUG_VIEW_SHADOW: u32 = 9u;
const DEBUG_VIEW_SHADOW_SLICE: u32 = 10u;
override DEBUG_VIEW: u32 = DEBUG_VIEW_FINAL;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return box_position(index);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy - view.origin;
    if DEBUG_VIEW == DEBUG_VIEW_REDUCED_DEPTH {
        var depth = 0.0;
        if HOST_DEPTH {
            depth = scene_view_depth(pixel);
        } else {
            let texel = pixel / f32(system.scale) - system.target_origin;
            depth = textureLoad(reduced_depth, vec2i(texel), 0).r * system.depth_limit;
        }
        let gray = 1.0 - saturate((depth - system.bounds_near) / (system.depth_limit - system.bounds_near));
        return vec4f(vec3f(gray), 1.0);
    }
    if DEBUG_VIEW == DEBUG_VIEW_SHADOW_SLICE {
        return slice_of_light(pixel);
    }
    let accumulated = sample_target(accumulation, pixel);
    let amount = accumulated.a;
    if amount <= 0.0 {
        discard;
    }
    if DEBUG_VIEW == DEBUG_VIEW_OVERDRAW {
        return vec4f(overdraw_color(amount * 255.0), 1.0);
    }
    // White smoke: over black, the amount of all systems.
    if DEBUG_VIEW == DEBUG_VIEW_AMOUNT {
        return vec4f(amount);
    }
    let covered = smoke_coverage(amount);
    let surface = shaded_surface(accumulated, sample_attachments(pixel), pixel);
    if DEBUG_VIEW == DEBUG_VIEW_NORMALS {
        return vec4f(surface.normal * 0.5 + 0.5, 1.0) * covered;
    }
    if DEBUG_VIEW == DEBUG_VIEW_SHADOW {
        return vec4f(fractions_of_lights(surface.shade.optical_depths, surface.shade.visible), 1.0) * covered;
    }

    var light = vec3f(0.0);
    if DEBUG_VIEW != DEBUG_VIEW_SOFT_SCATTER {
        light += diffuse(surface, amount, lit_position(surface, pixel));
    }
    if DEBUG_VIEW != DEBUG_VIEW_DIFFUSE {
        light += soft_scatter(amount) * surface.tint;
    }
    if DEBUG_VIEW != DEBUG_VIEW_SOFT_SCATTER && DEBUG_VIEW != DEBUG_VIEW_DIFFUSE {
        light += fire_light(surface, amount);
    }
    return deferred_fragment(ADDITIVE, bounded_light(light), covered);
}
