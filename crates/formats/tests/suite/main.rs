//! Tests of readers and of what they read, from outside.

// The sources of the fuzz targets, which some tests share, know the crate by this name.
extern crate bidir_formats as formats;

mod coverage;
mod frozen_scenes;
mod limits;
mod mutations;
mod objects;
mod real_scenes;

#[path = "../../../bidir/tests/common/statistics/mod.rs"]
mod statistics;
