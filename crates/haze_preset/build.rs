//! Finds the built-in files: beside this package once it is packed, otherwise at the top of the repository.

use std::path::PathBuf;

fn main() {
    let package = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    // Links to the folders, which are files where links are not supported.
    let folder = if package.join("ramps").is_dir() { package } else { package.join("../..") };
    println!("cargo::rustc-env=HAZE_BUILTIN_FOLDER={}", folder.display());
    println!("cargo::rerun-if-changed=build.rs");
}
