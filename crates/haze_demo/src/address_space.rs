//! Limit of the process's address space (`ulimit -v`), for graphics drivers.

use haze_core::error::Error;

/// Address space of a driver and its first frames, MiB. Below 950 MiB, Mesa 22.3 crashes while LLVM compiles a shader
/// (llvmpipe, 2 processors, 1280x720); below 1150 MiB a readback of 1920x1080 pixels aborts the program.
const BASE_MIB: u64 = 1536;
/// Address space of a thread, MiB: a stack of 8 MiB and the two heaps of 64 MiB that glibc reserves for its allocations.
const THREAD_MIB: u64 = 136;

/// Refuses to open a graphics driver in too little address space: software drivers crash when an allocation fails.
///
/// Reads `/proc`; other systems than Linux set no such limit.
///
/// # Errors
/// [`Error::NoDevice`] with the limit and the value that is needed.
pub fn check_address_space() -> Result<(), Error> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    check(&limits, BASE_MIB + THREAD_MIB * threads)
}

fn check(limits: &str, needed_mib: u64) -> Result<(), Error> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"));
    // The first number is the limit in force; `unlimited` is no number.
    let bytes = line.and_then(|line| line.split_whitespace().next()).and_then(|soft| soft.parse::<u64>().ok());
    match bytes.map(|bytes| bytes >> 20) {
        Some(mib) if mib < needed_mib => Err(Error::NoDevice(format!(
            "the address space is limited to {mib} MiB (`ulimit -v`), too little for a graphics driver; expected at least \
             {needed_mib} MiB, or no limit"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_low_limit_is_refused_with_the_value_that_is_needed() {
        let limits = |soft: &str| {
            let header = "Limit                     Soft Limit           Hard Limit           Units     ";
            format!(
                "{header}\nMax cpu time              unlimited            unlimited            seconds\n\
                     Max address space         {soft:20} unlimited            bytes     \n"
            )
        };
        for fine in ["unlimited", "2097152000", "99999999999999999999"] {
            assert!(check(&limits(fine), 2000).is_ok(), "{fine}");
        }
        assert!(check("", 2000).is_ok());
        let error = check(&limits("2097151999"), 2000).unwrap_err().to_string();
        assert!(error.contains("limited to 1999 MiB") && error.contains("at least 2000 MiB"), "{error}");
    }
}
