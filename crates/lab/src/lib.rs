//! Experiments: images become numbers, and numbers get confidence.
//!
//! - [`experiment`]: scenes × methods × budgets × seeds, rendered and compared.
//! - [`image`]: linear pictures in memory, pairs of them, other sizes.
//! - [`metric`]: how far an image is from a reference, for every pixel and as one number.
//! - [`flip`]: the difference that an observer sees when two images alternate.
//! - [`pyramid`]: what each strategy does, as images and figures.
//! - [`reference`](mod@reference): pictures that others are measured against, rendered by two estimators that agree.
//! - [`report`]: what an experiment found, as a page for people.
//! - [`results`]: what an experiment found, as it is written down.
//! - [`sample`]: one sample, told step by step.
//! - [`statistics`]: intervals over independent seeds, ratios of two methods, and whether two
//!   renders have the same expectation.
//!
//! All but [`experiment`], [`reference`](mod@reference) and [`sample`] read no file and know no scene: who has
//! images can ask. Where random numbers are drawn their seed is fixed. Nothing looks at a clock of its own.

mod blocks;
pub mod experiment;
pub mod flip;
pub mod image;
mod markup;
pub mod metric;
pub mod pyramid;
pub mod reference;
pub mod report;
pub mod results;
pub mod sample;
mod scenes;
mod seal;
pub mod statistics;
