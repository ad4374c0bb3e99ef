//! Live images of a running render. The renderer gives a [`Frame`] now and then, and never waits for a
//! client.
//!
//! [`interactive`] is a render that clients command, a [`RenderMonitor`] shows one that they only watch.
//! Both replace the newest status and frames of a [`SharedState`], which [`web`] serves. [`tev`] sends
//! frames to another program.

mod command;
mod frame;
mod monitor;
mod shared;
mod status;
mod view;

pub mod interactive;
pub mod tev;
pub mod web;

pub use command::{Command, Walk};
pub use frame::Frame;
pub use monitor::RenderMonitor;
pub use shared::{ClientHandle, RequestQueue, SentFrame, SharedState, request_queue};
pub use status::{CameraStatus, Choices, FilmStatus, LaneId, LaneStatus, RayRates, State, Status};
