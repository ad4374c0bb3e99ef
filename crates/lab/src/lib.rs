//! Experiments: renders of scenes, error metrics, and their statistics.
//!
//! - [`experiment`]: renders scenes × methods × budgets × seeds and compares the images with references.
//! - [`image`]: linear images in memory, image–reference pairs, resampling.
//! - [`metric`]: the error of an image against a reference, per pixel and as one number.
//! - [`flip`]: FLIP, the difference that an observer sees when two images alternate.
//! - [`pyramid`]: images and numbers of each strategy (s, t).
//! - [`reference`](mod@reference): reference images, rendered by two estimators that agree.
//! - [`report`]: the results of an experiment as an HTML page.
//! - [`results`]: the results of an experiment as `results.json`.
//! - [`sample`]: the replay of one sample, step by step.
//! - [`statistics`]: intervals over independent seeds, ratios of two methods, and tests for equal
//!   expectations of two renders.
//!
//! Only [`experiment`], [`reference`](mod@reference) and [`sample`] read files or scenes; all other modules
//! work on images. Random numbers have a fixed seed. No module reads a clock; hosts supply it.

mod blocks;
pub mod experiment;
pub mod flip;
pub mod image;
mod markup;
pub mod metric;
mod number;
pub mod pyramid;
pub mod reference;
pub mod report;
pub mod results;
pub mod sample;
mod scenes;
mod seal;
pub mod statistics;
