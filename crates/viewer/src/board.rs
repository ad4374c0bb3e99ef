//! What a renderer and those who watch it share. Whoever renders puts the newest of everything on
//! the [`Board`], and takes requests between passes at its [`Desk`]; who watches looks at the board,
//! and asks through a [`Link`]. Nobody waits for anybody: what is not looked at is replaced, and a
//! request that finds no room is refused.

use crate::command::Command;
use crate::frame::Frame;
use crate::status::{LaneId, Status};
use axum::body::Bytes;
use bidir::driver::Session;
use formats::film::FilmHeader;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Requests that wait; more are refused.
const REQUESTS: usize = 64;
/// Lines that are kept of what was told.
const LOG_LINES: usize = 1000;

/// A frame of a lane, shared by all who look at it.
#[derive(Debug)]
pub struct Shown {
    /// Which lane.
    pub lane: LaneId,
    /// The lane's, when it was made.
    pub generation: u32,
    /// The picture.
    pub frame: Frame,
    /// The rays of all samples of each pixel. None: the film does not keep them.
    pub rays: Option<Vec<f32>>,
    /// What clients are sent, when the first of them has asked for it.
    message: OnceLock<Bytes>,
}

impl Shown {
    /// A frame of a lane.
    pub(crate) fn new(lane: LaneId, generation: u32, frame: Frame, rays: Option<Vec<f32>>) -> Self {
        Self {
            lane,
            generation,
            frame,
            rays,
            message: OnceLock::new(),
        }
    }

    /// What clients are sent: `BDF1`, then as u32 the lane, its generation, the passes, width and
    /// height of the whole film, left, top, width and height of the crop, then red, green and blue of
    /// each pixel as f32, row by row from the top left; all little endian.
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
        let head = head.into_iter().flat_map(u32::to_le_bytes);
        message.extend(head);
        for value in values {
            message.extend_from_slice(&value.to_le_bytes());
        }
        message
    }
}

/// A lane as it is between two passes.
pub struct Subject<'a> {
    /// What renders it.
    pub session: &'a Session<'a>,
    /// Grows whenever the lane begins anew.
    pub generation: u32,
    /// What files say of it.
    pub header: &'a dyn Fn() -> FilmHeader,
}

/// Looks at a lane between two passes; None: there is no such lane now.
pub(crate) type Look = Box<dyn FnOnce(Option<&Subject<'_>>) + Send>;

/// What a renderer is asked for.
pub(crate) enum Request {
    /// To do something.
    Command(Command),
    /// To put the newest frame of a lane on the board.
    Show(LaneId),
    /// To let somebody look.
    Look(LaneId, Look),
    /// To end.
    Close,
}

/// The newest of everything.
#[derive(Debug)]
pub struct Board {
    status: watch::Sender<Arc<Status>>,
    frames: [watch::Sender<Option<Arc<Shown>>>; 2],
    log: Mutex<VecDeque<String>>,
    start: Instant,
}

impl Board {
    fn new(first: Status) -> Self {
        Self {
            status: watch::Sender::new(Arc::new(first)),
            frames: [watch::Sender::default(), watch::Sender::default()],
            log: Mutex::default(),
            start: Instant::now(),
        }
    }

    /// Replaces what is told.
    pub(crate) fn tell(&self, status: Status) {
        self.status.send_replace(Arc::new(status));
    }

    /// What is told.
    pub(crate) fn status(&self) -> Arc<Status> {
        self.status.borrow().clone()
    }

    /// Tells of every change of the status, but not of those that were replaced meanwhile.
    pub(crate) fn watch_status(&self) -> watch::Receiver<Arc<Status>> {
        self.status.subscribe()
    }

    /// Replaces the frame of a lane. None: the lane is gone.
    pub(crate) fn show(&self, lane: LaneId, shown: Option<Arc<Shown>>) {
        self.frames[lane.index()].send_replace(shown);
    }

    /// The frame of a lane.
    pub(crate) fn shown(&self, lane: LaneId) -> Option<Arc<Shown>> {
        self.frames[lane.index()].borrow().clone()
    }

    /// Tells of every new frame of a lane, but not of those that were replaced meanwhile.
    pub(crate) fn watch_frames(&self, lane: LaneId) -> watch::Receiver<Option<Arc<Shown>>> {
        self.frames[lane.index()].subscribe()
    }

    /// Whether anybody looks at frames.
    pub(crate) fn is_watched(&self) -> bool {
        self.frames[0].receiver_count() > 0
    }

    /// Adds a line to what was told; the oldest are forgotten.
    pub fn log(&self, line: &str) {
        let seconds = self.start.elapsed().as_secs_f64();
        let mut log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.push_back(format!("{seconds:10.3}  {line}\n"));
        if log.len() > LOG_LINES {
            log.pop_front();
        }
    }

    /// Everything that was told, a line each, with the seconds since the start.
    pub(crate) fn log_text(&self) -> String {
        let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.iter().map(String::as_str).collect()
    }
}

/// Why a pass that is running is not wanted any more.
#[derive(Debug, Default)]
pub(crate) struct Interrupts {
    moved: AtomicBool,
    changed: AtomicBool,
}

impl Interrupts {
    /// True where the camera was moved since the last [`Self::clear`].
    pub(crate) fn is_moved(&self) -> bool {
        self.moved.load(Ordering::Relaxed)
    }

    /// True where anything else was asked for that ends a pass.
    pub(crate) fn is_changed(&self) -> bool {
        self.changed.load(Ordering::Relaxed)
    }

    /// Forgets all, before requests are taken: what comes later sets it again.
    pub(crate) fn clear(&self) {
        self.moved.store(false, Ordering::Relaxed);
        self.changed.store(false, Ordering::Relaxed);
    }

    fn note(&self, command: &Command) {
        if command.is_move() {
            self.moved.store(true, Ordering::Relaxed);
        } else if command.ends_pass() {
            self.changed.store(true, Ordering::Relaxed);
        }
    }
}

/// Where a renderer takes requests.
pub struct Desk {
    requests: Receiver<Request>,
    /// That leads here.
    link: Link,
}

/// Through which a renderer is asked.
#[derive(Clone, Debug)]
pub struct Link {
    board: Arc<Board>,
    requests: SyncSender<Request>,
    interrupts: Arc<Interrupts>,
}

/// A desk with the link to it.
///
/// `first` is told until the renderer tells more.
pub fn desk(first: Status) -> (Desk, Link) {
    let (sender, receiver) = sync_channel(REQUESTS);
    let link = Link {
        board: Arc::new(Board::new(first)),
        requests: sender,
        interrupts: Arc::default(),
    };
    let desk = Desk {
        requests: receiver,
        link: link.clone(),
    };
    (desk, link)
}

impl Desk {
    /// What is shared.
    pub fn board(&self) -> &Board {
        &self.link.board
    }

    pub(crate) fn link(&self) -> Link {
        self.link.clone()
    }

    pub(crate) fn interrupts(&self) -> &Interrupts {
        &self.link.interrupts
    }

    /// The next request that waits.
    pub(crate) fn take(&self) -> Option<Request> {
        self.requests.try_recv().ok()
    }

    /// The next request, which is waited for so long. None: there was none.
    pub(crate) fn wait(&self, at_most: Duration) -> Option<Request> {
        self.requests.recv_timeout(at_most).ok()
    }
}

/// The renderer has too many requests already, or is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Refused;

impl Link {
    /// What is shared.
    pub fn board(&self) -> &Board {
        &self.board
    }

    pub(crate) fn ask(&self, request: Request) -> Result<(), Refused> {
        let ends = match &request {
            Request::Command(command) => Some(command.clone()),
            Request::Show(_) | Request::Look(..) | Request::Close => None,
        };
        self.requests.try_send(request).map_err(|_| Refused)?;
        // Only now: who sees it finds the command.
        if let Some(command) = ends {
            self.interrupts.note(&command);
        }
        Ok(())
    }

    /// Asks the renderer to end, and waits until there is room for it.
    pub(crate) fn close(&self) {
        self.interrupts.note(&Command::Stop {});
        // Where the renderer is gone there is nobody to end.
        let _ = self.requests.send(Request::Close);
    }
}
