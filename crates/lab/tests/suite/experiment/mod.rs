//! Experiments as a host runs them.

mod common;
mod descriptions;
mod pyramid;
mod records;
mod references;
