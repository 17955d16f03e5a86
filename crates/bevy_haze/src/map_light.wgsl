// map_light: means of the light in a cube map.
//
// Reads    a cube map, first mip level
// Writes   the mean of its light, and means weighted by x, y and z of the direction
// Space    directions as Bevy's materials see the map: z is flipped, because cube maps are left-handed
// Source   directions on a Fibonacci sphere, evenly spread (Gonzalez, Measurement of areas on a sphere, 2010)

const THREADS: u32 = 64u;
// Twice as many as the texels of a face of Bevy's generated diffuse maps.
const DIRECTIONS: u32 = 2048u;
const GOLDEN_RATIO: f32 = 0.61803399;
const TAU: f32 = 6.2831853;
// Largest half float: maps of suns hold infinities.
const MAX_LIGHT: f32 = 65504.0;

@group(0) @binding(0) var map: texture_cube<f32>;
@group(0) @binding(1) var map_sampler: sampler;
@group(0) @binding(2) var<storage, read_write> means: array<vec4f, 4>;

var<workgroup> sums: array<array<vec3f, 4>, THREADS>;

@compute @workgroup_size(THREADS)
fn measure(@builtin(local_invocation_index) thread: u32) {
    var sum = array<vec3f, 4>();
    for (var index = thread; index < DIRECTIONS; index += THREADS) {
        let y = 1.0 - (2.0 * f32(index) + 1.0) / f32(DIRECTIONS);
        let angle = TAU * fract(f32(index) * GOLDEN_RATIO);
        let direction = vec3f(vec2f(cos(angle), sin(angle)) * sqrt(max(1.0 - y * y, 0.0)), y).xzy;
        let texel = textureSampleLevel(map, map_sampler, direction * vec3f(1.0, 1.0, -1.0), 0.0).rgb;
        let light = clamp(texel, vec3f(0.0), vec3f(MAX_LIGHT));
        sum[0] += light;
        sum[1] += light * direction.x;
        sum[2] += light * direction.y;
        sum[3] += light * direction.z;
    }
    sums[thread] = sum;
    workgroupBarrier();
    if thread < 4u {
        var total = vec3f();
        for (var other = 0u; other < THREADS; other++) {
            total += sums[other][thread];
        }
        means[thread] = vec4f(total / f32(DIRECTIONS), 0.0);
    }
}
