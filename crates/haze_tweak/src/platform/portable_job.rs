//! Work that takes seconds and needs nothing but its parameters. Natively it runs on a thread; a page, which has none, sends
//! it to a web worker as text.

use std::path::PathBuf;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Work that can be sent elsewhere.
#[cfg_attr(not(target_arch = "wasm32"), allow(dead_code, reason = "a thread needs only `run`"))]
pub trait PortableJob: Serialize + DeserializeOwned + Send + 'static {
    /// Name by which a web worker finds it.
    const NAME: &'static str;
    type Output: Serialize + DeserializeOwned + 'static;

    /// Returns the files that it reads.
    fn reads(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Returns the output of a job that `progress` has stopped. `None` if it never does.
    fn stopped() -> Option<Self::Output> {
        None
    }

    /// Does the work. `progress` gets the number of finished steps and returns false to stop.
    fn run(self, progress: &dyn Fn(u32) -> bool) -> Self::Output;
}
