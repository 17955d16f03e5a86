// measure
// Measures the extent of a host's particles, which the CPU cannot read.
//
// Reads   particles; the system's uniforms, whose extent is that of the bounding box.
// Writes  sums of each workgroup; the extent, which is then copied over the box's in the system's uniforms.
// Space   View space.

#import "lib/bindings.wgsl"
#import "lib/smoke_extent.wgsl"
#import "lib/sprite_vertex.wgsl"

const WORKGROUP: u32 = 256u;

struct Measure {
    count: u32,
    // Start of the first particle, in units of vec4f.
    first: u32,
    // Workgroups of `sum_particles` and of `farthest_particle`, at most WORKGROUP.
    workgroups: u32,
    // 1 if the host has chosen the depth of the center.
    keeps_depth: u32,
    // Length of the fade, metres.
    fade_distance: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32,
}

// Sums over sprites, relative to the center of the bounding box.
struct ExtentSums {
    // xyz: weighted positions; w: weights.
    positions: vec4f,
    squares: f32,
}

// The first six numbers are laid out as in System.
struct MeasuredExtent {
    center: vec3f,
    smoke_near: f32,
    smoke_far: f32,
    // Bits of a positive number, which order as an integer.
    smoke_depth_limit: atomic<u32>,
    // View depth of the measured center; `center` may have another, chosen by the host.
    mean_depth: f32,
}

@group(3) @binding(0) var<uniform> measure: Measure;
// PARTICLE_VECTORS per particle.
@group(3) @binding(1) var<storage, read> particles: array<vec4u>;
@group(3) @binding(2) var<storage, read_write> sums: array<ExtentSums>;
@group(3) @binding(3) var<storage, read_write> measured: MeasuredExtent;

var<workgroup> shared_sums: array<ExtentSums, WORKGROUP>;

// Adds up the values of all invocations of the workgroup in shared_sums[0].
fn add_up(local: u32, value: ExtentSums) {
    shared_sums[local] = value;
    workgroupBarrier();
    for (var step = WORKGROUP / 2u; step > 0u; step /= 2u) {
        if local < step {
            shared_sums[local].positions += shared_sums[local + step].positions;
            shared_sums[local].squares += shared_sums[local + step].squares;
        }
        workgroupBarrier();
    }
}

fn load_particle(index: u32) -> Particle {
    let at = measure.first + PARTICLE_VECTORS * index;
    return particle_from_words(particles[at], particles[at + 1u], particles[at + 2u]);
}

// Particle at `index` in view space, its radius in metres; radius 0 if it is not drawn.
fn sized_particle(index: u32) -> vec4f {
    let particle = load_particle(index);
    let other = particle.rotation_amount_frame_age;
    let center = (system.view_from_particles * vec4f(particle.position_radius.xyz, 1.0)).xyz;
    let radius = particle.position_radius.w * system.size;
    let motion = dot(abs(particle.velocity), vec3f(1.0));
    let finite = dot(abs(center), vec3f(1.0)) + radius + dot(abs(other), vec4f(1.0)) + motion < MAX_MAGNITUDE;
    return vec4f(center, select(0.0, radius, finite && other.y > 0.0 && radius > 0.0));
}

fn amount_of(index: u32) -> f32 {
    return load_particle(index).rotation_amount_frame_age.y;
}

@compute @workgroup_size(256)
fn sum_particles(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    var sum = ExtentSums(vec4f(0.0), 0.0);
    let count = min(measure.count, system.alive_count);
    for (var index = invocation.x; index < count; index += measure.workgroups * WORKGROUP) {
        let particle = sized_particle(index);
        if particle.w > 0.0 {
            let weight = extent_weight(amount_of(index), particle.w, -particle.z, view.near);
            let position = particle.xyz - system.center;
            sum.positions += vec4f(position, 1.0) * weight;
            sum.squares += mean_square_depth(position.z, particle.w) * weight;
        }
    }
    add_up(local, sum);
    if local == 0u {
        sums[workgroup.x] = shared_sums[0];
    }
}

@compute @workgroup_size(256)
fn combine_sums(@builtin(local_invocation_index) local: u32) {
    var sum = ExtentSums(vec4f(0.0), 0.0);
    if local < measure.workgroups {
        sum = sums[local];
    }
    add_up(local, sum);
    if local != 0u {
        return;
    }
    let total = shared_sums[0];
    let weight = total.positions.w;
    if !(weight > 0.0) {
        // No particle is in front of the viewer: the extent of the box stays.
        measured.center = system.center;
        measured.smoke_near = system.smoke_near;
        measured.smoke_far = system.smoke_far;
        measured.mean_depth = -system.center.z;
        atomicStore(&measured.smoke_depth_limit, bitcast<u32>(system.smoke_depth_limit));
        return;
    }
    let mean = total.positions.xyz / weight;
    let half = half_extent(total.squares / weight, mean.z);
    let center = system.center + mean;
    measured.center = select(center, vec3f(center.xy, system.center.z), measure.keeps_depth == 1u);
    measured.smoke_near = -center.z - half;
    measured.smoke_far = -center.z + half;
    measured.mean_depth = -center.z;
    let limit = min(-center.z + measure.fade_distance, system.depth_limit);
    atomicStore(&measured.smoke_depth_limit, bitcast<u32>(max(limit, 0.0)));
}

@compute @workgroup_size(256)
fn farthest_particle(@builtin(global_invocation_id) invocation: vec3u) {
    var reach = 0.0;
    let count = min(measure.count, system.alive_count);
    for (var index = invocation.x; index < count; index += measure.workgroups * WORKGROUP) {
        let particle = sized_particle(index);
        if particle.w > 0.0 {
            let back = -particle.z + particle.w;
            reach = max(reach, reach_behind(amount_of(index), back, measured.mean_depth));
        }
    }
    let limit = min(measured.mean_depth + reach + measure.fade_distance, system.depth_limit);
    atomicMax(&measured.smoke_depth_limit, bitcast<u32>(max(limit, 0.0)));
}
