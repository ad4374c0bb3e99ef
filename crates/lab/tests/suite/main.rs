//! The crate from outside: experiments as a host runs them, and descriptions that are nearly right.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

// The modules of `fuzz` call it so.
extern crate bidir_lab as lab;

mod experiment;
mod mutations;
