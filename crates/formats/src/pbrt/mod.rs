//! Scene files of pbrt-v4.
//!
//! Reading has two steps. [`parse_file`] parses text into a [`SceneDescription`]: the contents of the text as
//! plain data, in which all names are known and all numbers valid. [`build()`] builds a scene from it and reads
//! the meshes and images; [`load`] does both.
//!
//! Departures from the reference program, which all give more specific errors: an unknown name is an error
//! that suggests the nearest known one; a file of version 3 is recognised by its first mark; a matrix with
//! perspective, a degenerate transformation, and a name that is used and never defined are errors with
//! their places.

mod build;
mod decode;
mod definitions;
mod directives;
mod inclusion;
mod inputs;
mod known;
mod lexer;
mod parameters;
mod parser;
mod scene;
mod state;
mod transform;
mod v3;

#[cfg(test)]
mod tests;

pub use crate::import::{Crop, LoadOptions, Loaded, SceneDigest, SceneSettings, Summary, Warning};
pub use build::{build, load, load_from};
pub(crate) use known::is_directive;
pub use parameters::{Parameter, ParameterList, ParameterType, Values};
pub use parser::{parse_file, parse_file_from, parse_text};
pub use scene::{
    CameraDescription, ColorSpace, Entity, FilmDescription, InstanceDescription, LightDescription,
    MaterialDescription, MediumDescription, MediumInterface, MediumReference, ObjectDescription,
    OptionDescription, SceneDescription, ShapeDescription, TextureDescription, TextureKind,
};
pub use transform::Transforms;
