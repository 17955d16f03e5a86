// Coverage of accumulated smoke, shared by transfer and transfer_lit.

#import "lib/bindings.wgsl"
#import "lib/lighting.wgsl"
#import "lib/ramp.wgsl"

const COVERAGE_MODE_LINEAR: u32 = 0u;
const COVERAGE_MODE_RAMP: u32 = 1u;
override COVERAGE_MODE: u32 = COVERAGE_MODE_LINEAR;
// True: the smoke adds its light, and hides nothing.
override ADDITIVE: bool = false;

// Fraction of the scene that the smoke hides.
fn smoke_coverage(amount: f32) -> f32 {
    let covered = coverage(amount, system.boost);
    if COVERAGE_MODE == COVERAGE_MODE_RAMP {
        return painted_fraction(sample_ramp(coverage_ramp, linear_sampler, covered));
    }
    return covered;
}
