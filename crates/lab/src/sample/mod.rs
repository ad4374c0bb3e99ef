//! The report of one sample: both subpaths, the contribution of every strategy, the chosen shadow rays,
//! and their visibility.
//!
//! A [`SampleReport`] is made from a [`Replay`](bidir::driver::Replay) of the driver. It can be written as
//! JSON, as a text (`Display`), and as a [drawing](SampleReport::drawing).

mod drawing;
mod report;
mod text;
mod training;
mod view;

pub use report::SampleReport;
pub use training::TrainingReport;

#[cfg(test)]
mod tests;
