//! Tells whether the folders of built-in files are beside this package: once it is packed, or as links in a checkout. Where links are
//! not supported, they are files, and the folders are at the top of the repository.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(has_folders)");
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default();
    if Path::new(&package).join("ramps").is_dir() {
        println!("cargo::rustc-cfg=has_folders");
    }
}
