//! One function for each kind of input, which must return whatever the bytes.
//!
//! The mutation tests of `formats` and `lab` call the same functions, and so does the example
//! `mutations` of `lab`, for `tools/attack`.

pub mod check;
pub mod experiments;
pub mod inputs;
pub mod mutation;
