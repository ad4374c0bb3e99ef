//! Readers and writers: scenes of pbrt-v4 and glTF 2.0, PLY meshes, images, film files.
//!
//! No function panics, whatever the bytes: a broken file gives an [`Error`] with a place, a kind and a hint.
//! Counts are checked before memory is reserved for them.

mod bytes;
#[cfg(test)]
mod cases;
mod error;
mod files;
mod foreign;
mod import;
mod limits;
mod nanovdb;
mod repair;
mod scalar;
mod source;
mod text;

pub mod file;
pub mod film;
pub mod gltf;
pub mod image;
pub mod outputs;
pub mod pbrt;
pub mod ply;
pub mod scene;

pub use error::{Error, ErrorKind, FilePlace, Result, cannot};
pub use repair::Repairs;
pub use source::{FileId, SourceMap, Span};
pub use text::{is_obeyed, number, printable, printable_lines};
