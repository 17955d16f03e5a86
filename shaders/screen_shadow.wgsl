// screen_shadow: darkens the host's lit image by the shadow of the smoke, for hosts whose shaders do not read it.
// Reads   scene depth, lights, shadow maps of the three brightest lights, optical depths towards the lights, shadow ramp.
// Writes  the host's color target.
// Blend   DST, ZERO (multiply).
// Space   View space, and cells of the density grid.

#import "lib/view.wgsl"
#import "lib/depth.wgsl"
#import "lib/lighting.wgsl"
#import "lib/haze_transmittance.wgsl"
#import "lib/screen_shadow.wgsl"
#import "lib/shadow_map_lookup.wgsl"

struct ScreenShadow {
    world_from_view: mat4x4f,
    // Light that reaches every surface, as a white matte one shows it.
    ambient: vec3f,
    light_count: u32,
}

@group(1) @binding(0) var<uniform> view: View;
// Depth buffer, or linear view depth.
@group(1) @binding(1) var scene_depth: texture_2d<f32>;

@group(2) @binding(0) var<uniform> screen: ScreenShadow;
// View space; all lights of the frame, in its order. `shadow_slot` from 4 on has no shadow map.
@group(2) @binding(1) var<uniform> lights: array<Light, 128>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the view.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Point of the scene at a pixel of the view, view space.
fn scene_point(pixel: vec2i) -> vec3f {
    let inside = clamp(pixel, vec2i(0), vec2i(view.size) - 1);
    let stored = textureLoad(scene_depth, inside + vec2i(view.origin), 0).r;
    let depth = view_depth_from_ndc_depth(stored, view.depth_coefficients);
    let ray = ndc_from_pixel(vec2f(pixel) + 0.5, view.size) * view.ray_scale + view.ray_offset;
    return view_position(ray, depth, view.orthographic);
}

// Fraction of a light that reaches a point past the scene.
fn scene_fraction(slot: f32, world: vec3f) -> f32 {
    if slot < 0.5 || slot > 3.5 {
        return 1.0;
    }
    let position = (world - haze_scene_shadow.origin) * haze_scene_shadow.cells_per_metre;
    return map_visibility(u32(slot) - 1u, position);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy - view.origin);
    let point = scene_point(pixel);
    if -point.z >= SKY_VIEW_DEPTH || haze_scene_shadow.strength <= 0.0 {
        discard;
    }
    let normal = scene_normal(
        point,
        scene_point(pixel - vec2i(1, 0)),
        scene_point(pixel + vec2i(1, 0)),
        scene_point(pixel - vec2i(0, 1)),
        scene_point(pixel + vec2i(0, 1)),
    );
    let world = (screen.world_from_view * vec4f(point, 1.0)).xyz;
    // A pixel off the surface, which must not shade itself.
    let pixels = pixels_per_metre(view.size.y, view.ray_scale.y, -point.z, view.orthographic);
    let above = (screen.world_from_view * vec4f(point + normal * (2.0 / pixels), 1.0)).xyz;
    var full = screen.ambient;
    var shaded = screen.ambient;
    for (var i = 0u; i < screen.light_count; i++) {
        let light = sample_light(lights[i], point);
        let facing = light.attenuation * saturate(dot(normal, light.direction));
        if facing <= 0.0 {
            continue;
        }
        let arriving = lights[i].color * (facing * scene_fraction(lights[i].shadow_slot, above));
        full += arriving;
        shaded += arriving * haze_transmittance(world, i);
    }
    return vec4f(fraction_of_light(full, shaded), 1.0);
}
