// demo scene: samples
// What    The four samples of a pixel in two groups. At the outline of an object, smoke is drawn over the surfaces behind it alone,
//         and the object's samples are added after it with the smoke in front of them: scene_outline.wgsl.
// Reads   depth at 2x2 samples per pixel, in addition to scene.wgsl.
// Writes  depth buffer and linear view depth, of the surfaces behind outlines.
// Space   outline.rs implements the same functions on the CPU.

@group(1) @binding(7) var sample_depth: texture_2d<f32>;

// Depths whose ratio is below this are one surface.
const OUTLINE_RATIO: f32 = 1.05;

// The layer of objects in front; the other is that of the surfaces behind them.
const FRONT: u32 = 1u;

struct LayerVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) layer: u32,
}

// Draws a triangle over the image for each layer: one pipeline for both, because drivers take long to compile their light.
@vertex
fn layer_vertex(@builtin(vertex_index) index: u32) -> LayerVertex {
    return LayerVertex(fullscreen_corner(index % 3u), index / 3u);
}

struct SampleGroups {
    // Samples of the object in front; none if all are one surface.
    is_front: vec4<bool>,
    // Depth buffer values: means, which are those of the pixel's center on a plane.
    front: f32,
    back: f32,
}

fn scene_view_depth(ndc_depth: f32) -> f32 {
    return view_depth_from_ndc_depth(ndc_depth, scene.depth_coefficients);
}

fn sample_groups(pixel: vec2i) -> SampleGroups {
    var ndc = vec4f();
    var depths = vec4f();
    for (var i = 0; i < 4; i++) {
        ndc[i] = textureLoad(sample_depth, pixel * 2 + vec2i(i & 1, i >> 1u), 0).r;
        depths[i] = scene_view_depth(ndc[i]);
    }
    let nearest = min(min(depths.x, depths.y), min(depths.z, depths.w));
    let farthest = max(max(depths.x, depths.y), max(depths.z, depths.w));
    let limit = nearest * OUTLINE_RATIO;
    let is_front = depths < vec4f(select(nearest, limit, farthest >= limit));
    let front = select(vec4f(0.0), vec4f(1.0), is_front);
    let back = vec4f(1.0) - front;
    return SampleGroups(
        is_front,
        dot(ndc, front) / max(dot(front, vec4f(1.0)), 1.0),
        dot(ndc, back) / dot(back, vec4f(1.0)),
    );
}

// Number of samples in a group, as a fraction of the four.
fn group_fraction(is_in_group: vec4<bool>) -> f32 {
    return dot(select(vec4f(0.0), vec4f(0.25), is_in_group), vec4f(1.0));
}

struct SceneDepths {
    @location(0) linear: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn linear_fragment(@builtin(position) position: vec4f) -> SceneDepths {
    let depth = sample_groups(vec2i(position.xy)).back;
    return SceneDepths(vec4f(scene_view_depth(depth), 0.0, 0.0, 1.0), depth);
}

@fragment
fn depth_fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    return sample_groups(vec2i(position.xy)).back;
}
