//! Tests of the `bidir` command from outside: its output, files and exit codes.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test")]

mod beyond;
mod choices;
mod common;
mod compare;
mod denoise;
mod experiment;
mod failures;
#[cfg(unix)]
mod farm;
mod film;
mod help;
mod layers;
mod means;
mod messages;
mod outputs;
mod progress;
#[cfg(unix)]
mod readme;
mod reference;
mod render;
mod replay;
#[cfg(unix)]
mod signals;
#[cfg(unix)]
mod terminal;
mod tev;
mod tonemap;
#[cfg(unix)]
mod view;
