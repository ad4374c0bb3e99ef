//! Tests of the public interface, with and without Open Image Denoise.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test")]

mod library;
mod missing;
