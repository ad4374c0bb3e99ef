//! Experiments as a host runs them.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

mod common;
mod descriptions;
mod pyramid;
mod records;
mod references;
