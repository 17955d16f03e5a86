// transfer_lit: draws smoke that light_target has lit over the system's bounding box.
// Reads   lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE_MINUS_SRC_ALPHA (premultiplied over the scene).
// Source  OTEE "Transfer & lighting", option 1: lighting at the target's resolution.

#import "lib/lit_target.wgsl"
#import "lib/bounding_box.wgsl"
#import "lib/coverage.wgsl"
#import "lib/color.wgsl"

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return box_position(index);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let lit = sample_lit(position.xy - view.origin);
    let amount = lit.a;
    if amount <= 0.0 {
        discard;
    }
    // Light of the texels, weighted by their amounts. Amounts below a millionth are invisible, and must not divide.
    return vec4f(bounded_light(lit.rgb / max(amount, 1.0e-6)), 1.0) * smoke_coverage(amount);
}
