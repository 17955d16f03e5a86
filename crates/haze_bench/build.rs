//! Reads the version of wgpu from the lock file: wgpu has no constant for it, and benchmark reports state it.

use std::path::Path;

fn main() {
    let package = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    // The workspace's lock file, or the package's own once it is published.
    let lock = Path::new(&package).ancestors().map(|folder| folder.join("Cargo.lock")).find(|file| file.is_file());
    let text = lock.as_ref().and_then(|file| std::fs::read_to_string(file).ok()).unwrap_or_default();
    let version = text.split("name = \"wgpu\"\nversion = \"").nth(1).and_then(|rest| rest.split('"').next());
    println!("cargo::rustc-env=HAZE_WGPU_VERSION={}", version.unwrap_or("unknown"));
    if let Some(lock) = lock {
        println!("cargo::rerun-if-changed={}", lock.display());
    }
}
