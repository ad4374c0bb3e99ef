//! One sample, told: both subpaths, what every strategy gave, which shadow rays were chosen, and what
//! was in their way.
//!
//! A [`SampleReport`] is made of a [`Replay`](bidir::driver::Replay) of the driver. It is written as
//! JSON, as a text (`Display`), and as a [picture](SampleReport::drawing).

mod drawing;
mod report;
mod subpath;
mod term;
mod text;
mod training;

pub use report::SampleReport;
pub use training::{RaysByKind, TrainingReport};

#[cfg(test)]
mod tests;
