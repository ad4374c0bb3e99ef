//! Experiments run by a host.

mod common;
mod descriptions;
mod pyramid;
mod records;
mod references;
