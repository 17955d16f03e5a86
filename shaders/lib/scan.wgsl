// Sums over a workgroup.

const SCAN_SIZE: u32 = 256u;

var<workgroup> scan_sums: array<u32, SCAN_SIZE>;

// The sum of the values up to an invocation's own. Every invocation of the workgroup must be here. (Hillis and Steele, "Data
// parallel algorithms", 1986)
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
