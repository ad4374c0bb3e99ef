//! The server from outside: what it shows, does and refuses.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test")]
#![allow(
    unreachable_pub,
    missing_docs,
    reason = "shared by the modules of one test"
)]

mod camera;
mod common;
mod pictures;
mod refuse;
mod render;
