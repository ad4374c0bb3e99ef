//! Experiments: images become numbers, and numbers get confidence.
//!
//! - [`experiment`]: scenes × methods × budgets × seeds, rendered and compared.
//! - [`image`]: linear pictures in memory, pairs of them, other sizes.
//! - [`metric`]: how far an image is from a reference, for every pixel and as one number.
//! - [`paper`]: the experiment of 1995, claim by claim.
//! - [`flip`]: the difference that an observer sees when two images alternate.
//! - [`results`]: what an experiment found, as it is written down.
//! - [`statistics`]: intervals over independent seeds, ratios of two methods, and whether two
//!   renders have the same expectation.
//!
//! All but [`experiment`] read no file and know no scene: who has images can ask. Everything is a
//! function of its arguments; where random numbers are drawn their seed is fixed. Nothing looks at a
//! clock: who runs an experiment has it.

pub mod experiment;
pub mod flip;
pub mod image;
pub mod metric;
pub mod paper;
pub mod results;
pub mod statistics;
