//! What the targets call: one function for each kind of input, which must return whatever the bytes.
//!
//! The same functions are called by the mutation tests of `formats` and `lab`.

pub mod experiments;
pub mod inputs;
pub mod mutation;
