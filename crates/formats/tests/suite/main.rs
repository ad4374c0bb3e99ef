//! Tests of readers and of what they read, from outside.

// By this name fuzz targets know it, whose checks tests use.
extern crate bidir_formats as formats;

mod coverage;
mod frozen_scenes;
mod limits;
mod mutations;
mod objects;
mod real_scenes;

#[path = "../../../bidir/tests/common/statistics/mod.rs"]
mod statistics;
