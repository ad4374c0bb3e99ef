//! The crate from outside: experiments as a host runs them, descriptions that are nearly right, and
//! the report in a browser.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

// The modules of `fuzz` call it so.
extern crate bidir_lab as lab;

mod experiment;
mod mutations;
mod report;
