// demo scene: mesh
// What    Triangles of a scene file with matte materials, of scene.wgsl. Light of a sample is blocked along one ray, so that
//         shadows are hard, with edges as smooth as those of surfaces.
// Reads   vertices, base color texture of a material, in addition to scene.wgsl; the light pass also reads normals, depth and
//         a hierarchy of all triangles.
// Writes  paint: alpha is 1; normals in world space, towards the viewer.
// Source  bvh.rs of haze_author. mesh_caster.rs implements the same on the CPU.

struct MeshMaterial {
    // Alpha below which it is cut out; 0: solid.
    cutoff: f32,
    // Added to the level of the texture: fewer levels fit on the device.
    level_bias: f32,
    padding: vec2f,
}

@group(1) @binding(8) var base_color: texture_2d<f32>;
@group(1) @binding(9) var base_sampler: sampler;
@group(1) @binding(10) var<uniform> material: MeshMaterial;

struct MeshVertex {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec3f,
    // Texels per metre.
    @location(4) @interpolate(flat, either) texel_density: f32,
    // Multiplies the alpha of the texture.
    @location(5) alpha: f32,
}

@vertex
fn mesh_vertex(
    @location(0) position_u: vec4f,
    @location(1) normal_v: vec4f,
    @location(2) color_density: vec4f,
    @location(3) alpha: f32,
) -> MeshVertex {
    let world = position_u.xyz * scene.mesh_scale;
    return MeshVertex(
        scene.clip_from_world * vec4f(world, 1.0),
        world,
        normal_v.xyz,
        vec2f(position_u.w, normal_v.w),
        color_density.rgb,
        color_density.w / scene.mesh_scale,
        alpha,
    );
}

fn is_cut_out(uv: vec2f, alpha: f32) -> bool {
    return material.cutoff > 0.0 && textureSampleLevel(base_color, base_sampler, uv, 0.0).a * alpha < material.cutoff;
}

struct MeshPaint {
    @location(0) paint: vec4f,
    @location(1) normal: vec4f,
}

@fragment
fn mesh_paint_fragment(in: MeshVertex, @builtin(front_facing) is_front: bool) -> MeshPaint {
    if is_cut_out(in.uv, in.alpha) {
        discard;
    }
    let length_squared = dot(in.normal, in.normal);
    let normal = select(vec3f(0.0, 1.0, 0.0), in.normal * inverseSqrt(length_squared), length_squared > 0.0);
    let to_point = in.world - scene.eye;
    let view_depth = (scene.clip_from_world * vec4f(in.world, 1.0)).w;
    let facing = abs(dot(normal, to_point)) / max(length(to_point), 1.0e-6);
    let level = texture_level(in.texel_density, view_depth, facing) + material.level_bias;
    let paint = in.color * textureSampleLevel(base_color, base_sampler, in.uv, level).rgb;
    return MeshPaint(vec4f(paint, 1.0), vec4f(select(-normal, normal, is_front), 0.0));
}

// Level of a texture for a sample, of which 2x2 make a pixel. Between the sharp axis and the long one on slanted surfaces.
fn texture_level(texel_density: f32, view_depth: f32, facing: f32) -> f32 {
    let sample = 0.5 * scene.pixel_size * view_depth / sqrt(max(facing, 0.05));
    return log2(max(texel_density * sample, 1.0e-6));
}

// Writes depth alone.
@fragment
fn mesh_depth_fragment(in: MeshVertex) {
    if is_cut_out(in.uv, in.alpha) {
        discard;
    }
}

@group(1) @binding(6) var normals: texture_2d<f32>;

@group(2) @binding(0) var nodes: texture_2d<f32>;
@group(2) @binding(1) var triangles: texture_2d<f32>;
@group(2) @binding(2) var masks: texture_2d_array<f32>;

// Texels of a row of `nodes` and `triangles`.
const ROW_BITS: u32 = 11u;
// Distance beyond everything, metres.
const MESH_SUN_DISTANCE: f32 = 1.0e6;

fn texel_of(index: u32) -> vec2u {
    return vec2u(index & ((1u << ROW_BITS) - 1u), index >> ROW_BITS);
}

// True if the ray meets the triangle at a distance from 0 to `far`, where it is not cut out. (Möller and Trumbore, 1997)
fn blocks(index: u32, origin: vec3f, direction: vec3f, far: f32) -> bool {
    let corner = textureLoad(triangles, texel_of(5u * index), 0);
    let first = textureLoad(triangles, texel_of(5u * index + 1u), 0);
    let second = textureLoad(triangles, texel_of(5u * index + 2u), 0);
    let across = cross(direction, second.xyz);
    let determinant = dot(first.xyz, across);
    if abs(determinant) < 1.0e-12 {
        return false;
    }
    let from_corner = origin - corner.xyz;
    let u = dot(from_corner, across) / determinant;
    let around = cross(from_corner, first.xyz);
    let v = dot(direction, around) / determinant;
    let distance = dot(second.xyz, around) / determinant;
    if u < 0.0 || v < 0.0 || u + v > 1.0 || distance < 0.0 || distance > far {
        return false;
    }
    if corner.w < 0.0 {
        return true;
    }
    let others = textureLoad(triangles, texel_of(5u * index + 3u), 0);
    let uv_corner = vec2f(first.w, second.w);
    let uv = uv_corner + (others.xy - uv_corner) * u + (others.zw - uv_corner) * v;
    let side = vec2f(textureDimensions(masks));
    let at = min(vec2u(fract(uv) * side), vec2u(side) - 1u);
    let alphas = textureLoad(triangles, texel_of(5u * index + 4u), 0);
    let alpha = alphas.x + (alphas.y - alphas.x) * u + (alphas.z - alphas.x) * v;
    return textureLoad(masks, at, u32(corner.w), 0).r * alpha >= alphas.w;
}

// True if a surface lies at a distance from 0 to `far`. In units of the mesh.
fn is_blocked(origin: vec3f, direction: vec3f, far: f32) -> bool {
    let inverse = 1.0 / select(direction, vec3f(1.0e-12), abs(direction) < vec3f(1.0e-12));
    let count = u32(textureLoad(nodes, vec2u(0u), 0).w);
    var at = 0u;
    while at < count {
        let low = textureLoad(nodes, texel_of(2u * at), 0);
        let high = textureLoad(nodes, texel_of(2u * at + 1u), 0);
        let a = (low.xyz - origin) * inverse;
        let b = (high.xyz - origin) * inverse;
        let near = min(a, b);
        let away = max(a, b);
        let enter = max(near.x, max(near.y, near.z));
        let leave = min(away.x, min(away.y, away.z));
        if enter > leave || enter > far || leave < 0.0 {
            at = u32(low.w);
            continue;
        }
        let leaf = u32(high.w);
        for (var i = 0u; i < leaf % 8u; i++) {
            if blocks(leaf / 8u + i, origin, direction, far) {
                return true;
            }
        }
        at++;
    }
    return false;
}

// Fraction of a light that reaches a point, 0 or 1.
fn mesh_visibility(world: vec3f, normal: vec3f, view_depth: f32, light: Light, sample: LightSample) -> f32 {
    if dot(normal, sample.direction) <= 0.0 || sample.attenuation <= 0.0 {
        return 1.0;
    }
    // Above the rounding of depth.
    let origin = world + normal * (2.0e-3 + 1.0e-4 * view_depth);
    var distance = MESH_SUN_DISTANCE;
    if light.directional < 0.5 {
        distance = length(light.position - world) - LIGHT_GAP;
    }
    let is_dark = is_blocked(origin / scene.mesh_scale, sample.direction, distance / scene.mesh_scale);
    return select(1.0, 0.0, is_dark);
}

// Light of a group of samples.
fn light_at(position: vec2f, is_in_group: vec4<bool>) -> Lit {
    let first = vec2i(position) * 2;
    var paints = array<vec4f, 4>();
    var lit = array<Lit, 4>();
    var worlds = array<vec3f, 4>();
    var facings = array<vec3f, 4>();
    var depths = array<f32, 4>();
    for (var i = 0; i < 4; i++) {
        let at = first + vec2i(i & 1, i >> 1u);
        paints[i] = textureLoad(paint, at, 0);
        facings[i] = normalize(textureLoad(normals, at, 0).xyz + vec3f(0.0, 1.0e-8, 0.0));
        depths[i] = scene_view_depth(textureLoad(sample_depth, at, 0).r);
        let ray = ray_at_unit_depth((vec2f(at) + 0.5) / vec2f(textureDimensions(paint)));
        worlds[i] = scene.eye + ray * depths[i];
        if paints[i].a < 0.0 {
            lit[i] = lit_by(sky(normalize(ray)));
        } else {
            lit[i] = lit_by(ambient_light(facings[i]));
        }
    }
    // On one even surface, two samples that agree tell of the other two.
    let nearest = min(min(depths[0], depths[1]), min(depths[2], depths[3]));
    let farthest = max(max(depths[0], depths[1]), max(depths[2], depths[3]));
    var is_even = farthest < nearest * 1.05;
    for (var i = 1; i < 4; i++) {
        is_even = is_even && dot(facings[0], facings[i]) > 0.95;
    }
    let has_surface = max(max(paints[0].a, paints[1].a), max(paints[2].a, paints[3].a)) > 0.0;
    let light_count = select(0u, scene.light_count, has_surface);
    var order = array<i32, 4>(0, 3, 1, 2);
    for (var index = 0u; index < light_count; index++) {
        var visible = array<f32, 4>(1.0, 1.0, 1.0, 1.0);
        for (var turn = 0; turn < 4; turn++) {
            let i = order[turn];
            if paints[i].a < 0.0 || !is_in_group[i] {
                continue;
            }
            let sample = sample_light(lights[index], worlds[i]);
            if turn > 1 && is_even && visible[0] == visible[3] {
                visible[i] = visible[0];
            } else {
                visible[i] = mesh_visibility(worlds[i], facings[i], depths[i], lights[index], sample);
            }
            let facing = max(dot(facings[i], sample.direction), 0.0);
            lit[i] = add_light(lit[i], index, lights[index].color * (facing * sample.attenuation * visible[i]));
        }
    }
    return average(paints, lit, is_in_group);
}
