// Prefix sums over a workgroup.

const SCAN_SIZE: u32 = 256u;

var<workgroup> scan_sums: array<u32, SCAN_SIZE>;

// Returns the sum of the values of all invocations up to and including this one. Must be called by every invocation of
// the workgroup. (Hillis and Steele, "Data parallel algorithms", 1986)
fn inclusive_sum(local: u32, value: u32) -> u32 {
    workgroupBarrier();
    scan_sums[local] = value;
    workgroupBarrier();
    for (var step = 1u; step < SCAN_SIZE; step *= 2u) {
        var before = 0u;
        if local >= step {
            before = scan_sums[local - step];
        }
        workgroupBarrier();
        scan_sums[local] += before;
        workgroupBarrier();
    }
    return scan_sums[local];
}
