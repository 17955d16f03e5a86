//! OpenVDB files: sparse volumes of smoke simulations, read and written without the OpenVDB library.
//!
//! Reads versions 222 to 224 of the format (OpenVDB 2.0 to 12): trees of 5, 4 and 3 levels of float, half, double and
//! vectors of them; compressed by Zip or Blosc, with or without active masks. A file is taken as hostile: no allocation
//! follows an unchecked number, and [`MAX_FILE_BYTES`] and [`MAX_NUMBERS`] bound the memory.
//!
//! Source: <https://github.com/AcademySoftwareFoundation/openvdb>, `openvdb/openvdb/io/` and `tree/`.

mod blosc;
mod sparse_grid;
mod tree_reader;
mod values;
mod vdb_file;
mod writer;

pub use sparse_grid::{GridTransform, Sampler, SparseGrid};
pub use tree_reader::MAX_NUMBERS;
pub use vdb_file::{GridInfo, VdbFile};
pub use writer::{GridToWrite, VdbWriter};

/// Size limit of one file, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

#[cfg(test)]
mod tests;
