//! Tests of the crate's promises, from outside.

#![allow(
    clippy::disallowed_methods,
    reason = "oracles compute with what the system has"
)]

mod answers;
mod bits;
mod degenerate;
mod instances;
mod many;
mod oracle;
mod quadrics;
mod scenes;
mod trees;
mod watertight;
