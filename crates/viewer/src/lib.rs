//! A running render, shown to those who watch: who renders gives a [`Frame`] now and then, and never
//! waits for anybody who looks at it.
//!
//! [`studio`] renders what a browser plays with, a [`Stage`] shows a render that goes its own way; both
//! put the newest of it on a [`Board`], which [`web`] serves. [`tev`] sends frames to another program.

mod board;
mod command;
mod exhibit;
mod frame;
mod stage;
mod status;

pub mod studio;
pub mod tev;
pub mod web;

pub use board::{Board, Desk, Link, Shown, Subject, desk};
pub use command::{Command, Walk};
pub use exhibit::{Course, Exhibit};
pub use frame::Frame;
pub use stage::{Stage, StageSettings};
pub use status::{CameraStatus, Choices, FilmStatus, LaneId, LaneStatus, RayRates, State, Status};
