//! Tests of the public interface: experiments run by a host, mutated descriptions, and the report in a
//! browser.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

// The modules of `fuzz` use this name.
extern crate bidir_lab as lab;

mod experiment;
mod mutations;
