//! Live images of a running render. The renderer shares a [`Frame`] between passes, and never waits for a
//! client.
//!
//! In [`interactive`], clients command the render; a [`RenderMonitor`] shows a render that clients only watch.
//! Both replace the newest status and frames of a [`SharedState`], which [`web`] serves. [`tev`] sends
//! frames to the image viewer tev.

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
