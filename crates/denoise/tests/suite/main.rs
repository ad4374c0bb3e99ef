//! The crate from outside: with Open Image Denoise, and where it is missing.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test")]

mod library;
mod missing;
