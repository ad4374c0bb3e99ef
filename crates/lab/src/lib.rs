//! Experiments: images become numbers, and numbers get confidence.
//!
//! - [`image`]: linear pictures in memory, pairs of them, other sizes.
//! - [`metric`]: how far an image is from a reference, for every pixel and as one number.
//! - [`flip`]: the difference that an observer sees when two images alternate.
//! - [`report`]: what an experiment found, as a page for people.
//! - [`results`]: what an experiment found, as it is written down.
//! - [`statistics`]: intervals over independent seeds, ratios of two methods, and whether two
//!   renders have the same expectation.
//!
//! The library reads no file and knows no scene: who has images can ask. Everything is a function of
//! its arguments; where random numbers are drawn their seed is fixed.

pub mod flip;
pub mod image;
pub mod metric;
pub mod report;
pub mod results;
pub mod statistics;
