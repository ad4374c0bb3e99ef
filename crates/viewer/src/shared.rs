//! The state that a renderer shares with its clients. The renderer replaces the newest status and
//! frames of the [`SharedState`], and takes requests from its [`RequestQueue`] between passes; clients
//! read the state, and send requests through a [`ClientHandle`]. Neither side waits: new frames replace
//! frames that no client took, and a full queue refuses requests.

use crate::command::Command;
use crate::frame::Frame;
use crate::status::{LaneId, Status};
use axum::body::Bytes;
use bidir::driver::Stop;
use formats::film::Render;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Maximum number of waiting requests. Further ones are refused.
const REQUESTS: usize = 64;
/// Maximum number of lines of the log.
const LOG_LINES: usize = 1000;

/// A frame of a lane, shared by all clients.
#[derive(Debug)]
pub struct SentFrame {
    /// The lane.
    pub lane: LaneId,
    /// The generation of the lane.
    pub generation: u32,
    /// The picture.
    pub frame: Frame,
    /// The rays of all samples of each pixel. None: the film does not keep them.
    pub rays: Option<Vec<f32>>,
    /// The message to clients, which the first use encodes.
    message: OnceLock<Bytes>,
}

impl SentFrame {
    /// Makes a frame of a lane.
    pub(crate) fn new(lane: LaneId, generation: u32, frame: Frame, rays: Option<Vec<f32>>) -> Self {
        Self {
            lane,
            generation,
            frame,
            rays,
            message: OnceLock::new(),
        }
    }

    /// Returns the message to clients: `BDF1`; then as u32 the lane, its generation, the number of passes,
    /// width and height of the whole film, left, top, width and height of the crop; then red, green and blue
    /// of each pixel as f32, row by row from the top left. All numbers are little-endian.
    pub(crate) fn message(&self) -> Bytes {
        self.message.get_or_init(|| self.encode().into()).clone()
    }

    fn encode(&self) -> Vec<u8> {
        let (film, crop) = (&self.frame.film, &self.frame.film.crop);
        let head = [
            self.lane.index() as u32,
            self.generation,
            u32::try_from(self.frame.passes).unwrap_or(u32::MAX),
            film.resolution[0],
            film.resolution[1],
            crop.min[0],
            crop.min[1],
            crop.width(),
            crop.height(),
        ];
        let values = self.frame.pixels.as_flattened();
        let mut message = Vec::with_capacity(4 + 4 * (head.len() + values.len()));
        message.extend_from_slice(b"BDF1");
        message.extend(head.into_iter().flat_map(u32::to_le_bytes));
        for value in values {
            message.extend_from_slice(&value.to_le_bytes());
        }
        message
    }
}

/// A lane between two passes.
pub(crate) struct Lane<'a> {
    /// The render of the lane.
    pub(crate) render: &'a Render,
    /// A number that grows whenever the lane begins anew.
    pub(crate) generation: u32,
}

/// A function that reads a lane between two passes. It gets None if there is no such lane now.
pub(crate) type Query = Box<dyn FnOnce(Option<&Lane<'_>>) + Send>;

/// A request to a renderer.
pub(crate) enum Request {
    /// Execute a command.
    Command(Command),
    /// Share the newest frame of a lane.
    Show(LaneId),
    /// Answer a query about a lane.
    Query(LaneId, Query),
    /// End the render.
    Close,
}

/// The newest status, frames and log lines.
#[derive(Debug)]
pub struct SharedState {
    status: watch::Sender<Arc<Status>>,
    frames: [watch::Sender<Option<Arc<SentFrame>>>; 2],
    log: Mutex<VecDeque<String>>,
    start: Instant,
}

impl SharedState {
    fn new(first: Status) -> Self {
        Self {
            status: watch::Sender::new(Arc::new(first)),
            frames: [watch::Sender::default(), watch::Sender::default()],
            log: Mutex::default(),
            start: Instant::now(),
        }
    }

    /// Replaces the status by the one that `make` returns for it.
    pub(crate) fn update(&self, make: impl FnOnce(Status) -> Status) {
        let status = make(Status::clone(&self.status()));
        self.status.send_replace(Arc::new(status));
    }

    /// Returns the status.
    pub(crate) fn status(&self) -> Arc<Status> {
        self.status.borrow().clone()
    }

    /// Returns a receiver of statuses. It skips those that are replaced before it reads them.
    pub(crate) fn watch_status(&self) -> watch::Receiver<Arc<Status>> {
        self.status.subscribe()
    }

    /// Replaces the frame of a lane. None: the lane is gone.
    pub(crate) fn show(&self, lane: LaneId, shown: Option<Arc<SentFrame>>) {
        self.frames[lane.index()].send_replace(shown);
    }

    /// Returns the frame of a lane.
    pub(crate) fn shown(&self, lane: LaneId) -> Option<Arc<SentFrame>> {
        self.frames[lane.index()].borrow().clone()
    }

    /// Returns a receiver of a lane's frames. It skips those that are replaced before it reads them.
    pub(crate) fn watch_frames(&self, lane: LaneId) -> watch::Receiver<Option<Arc<SentFrame>>> {
        self.frames[lane.index()].subscribe()
    }

    /// Returns true if a client receives frames.
    pub(crate) fn is_watched(&self) -> bool {
        self.frames[0].receiver_count() > 0
    }

    /// Adds a line to the log. If the log is full, it drops the oldest line.
    pub fn log(&self, line: &str) {
        let seconds = self.start.elapsed().as_secs_f64();
        let mut log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.push_back(format!("{seconds:10.3}  {line}\n"));
        if log.len() > LOG_LINES {
            log.pop_front();
        }
    }

    /// Returns the log, each line with the seconds since the start.
    pub(crate) fn log_text(&self) -> String {
        let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.iter().map(String::as_str).collect()
    }
}

/// The commands since the last [`clear`](Self::clear) that interrupt a running pass, or training.
#[derive(Debug, Default)]
pub(crate) struct Interrupts {
    any: AtomicBool,
    changed: AtomicBool,
}

impl Interrupts {
    /// Returns a stop for the commands that move the camera or end the pass.
    pub(crate) fn stop(&self) -> Stop<'_> {
        Stop::when(&self.any)
    }

    /// Returns a stop for the commands that end the pass and do not move the camera.
    pub(crate) fn stop_unless_moved(&self) -> Stop<'_> {
        Stop::when(&self.changed)
    }

    /// Forgets all commands. The renderer calls it before it takes requests, so that it misses no later command.
    pub(crate) fn clear(&self) {
        self.any.store(false, Ordering::Relaxed);
        self.changed.store(false, Ordering::Relaxed);
    }

    fn note(&self, command: &Command) {
        let is_move = command.is_move();
        if !is_move && command.ends_pass() {
            self.changed.store(true, Ordering::Relaxed);
        }
        if is_move || command.ends_pass() {
            self.any.store(true, Ordering::Relaxed);
        }
    }
}

/// The requests to a renderer.
pub struct RequestQueue {
    requests: Receiver<Request>,
    handle: ClientHandle,
}

/// The access of clients to a renderer.
#[derive(Clone, Debug)]
pub struct ClientHandle {
    state: Arc<SharedState>,
    requests: SyncSender<Request>,
    interrupts: Arc<Interrupts>,
}

/// Returns a queue, and the handle of its clients. `first` is the status until the renderer replaces it.
pub fn request_queue(first: Status) -> (RequestQueue, ClientHandle) {
    let (sender, receiver) = sync_channel(REQUESTS);
    let handle = ClientHandle {
        state: Arc::new(SharedState::new(first)),
        requests: sender,
        interrupts: Arc::default(),
    };
    let queue = RequestQueue {
        requests: receiver,
        handle: handle.clone(),
    };
    (queue, handle)
}

impl RequestQueue {
    /// Returns the shared state.
    pub fn state(&self) -> &SharedState {
        &self.handle.state
    }

    pub(crate) fn handle(&self) -> ClientHandle {
        self.handle.clone()
    }

    pub(crate) fn interrupts(&self) -> &Interrupts {
        &self.handle.interrupts
    }

    /// Takes the next request, without waiting. None: there is none.
    pub(crate) fn take(&self) -> Option<Request> {
        self.requests.try_recv().ok()
    }

    /// Waits at most this long for the next request. None: none came.
    pub(crate) fn wait(&self, at_most: Duration) -> Option<Request> {
        self.requests.recv_timeout(at_most).ok()
    }
}

/// The error of a request: the renderer has too many requests already, or is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Refused;

impl ClientHandle {
    /// Returns the shared state.
    pub fn state(&self) -> &SharedState {
        &self.state
    }

    pub(crate) fn ask(&self, request: Request) -> Result<(), Refused> {
        let ends = match &request {
            Request::Command(command) => Some(command.clone()),
            Request::Show(_) | Request::Query(..) | Request::Close => None,
        };
        self.requests.try_send(request).map_err(|_| Refused)?;
        // Only now: a renderer that sees it finds the command.
        if let Some(command) = ends {
            self.interrupts.note(&command);
        }
        Ok(())
    }

    /// Asks the renderer to end. Waits until the queue has room for the request.
    pub(crate) fn close(&self) {
        self.interrupts.note(&Command::Stop {});
        // A renderer that is gone has ended.
        let _ = self.requests.send(Request::Close);
    }
}
