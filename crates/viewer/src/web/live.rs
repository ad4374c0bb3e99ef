//! The WebSocket: sends a client the newest status and frames, as fast as it takes them, and receives its
//! commands.

use super::Site;
use super::error::Refusal;
use crate::command::Command;
use crate::shared::{Request, SentFrame};
use crate::status::{LaneId, Status};
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::response::Response;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tokio::time::{Instant, MissedTickBehavior, interval, sleep, sleep_until, timeout};

/// Maximum number of clients at once.
const CLIENTS: usize = 64;
/// Maximum size of a client's message. Unit: bytes.
const LARGEST_MESSAGE: usize = 4 << 10;
/// Maximum size of a message that is read. After a larger one, the connection may end before the client
/// gets the reason. Unit: bytes.
const MOST_READ: usize = 64 << 10;
/// The time limit for a client to close a connection that the server ended.
const FAREWELL: Duration = Duration::from_secs(2);
/// The least time between two statuses.
const STATUS_GAP: Duration = Duration::from_millis(250);
/// The time between two pings of a client.
const PING_GAP: Duration = Duration::from_secs(20);
/// Maximum number of attempts to pass a command to a busy renderer.
const TRIES: usize = 500;
const TRY_GAP: Duration = Duration::from_millis(20);

/// The permits of clients, [`CLIENTS`] in all.
pub(super) struct Clients(Arc<Semaphore>);

impl Default for Clients {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(CLIENTS)))
    }
}

/// Begins the connection of a client.
pub(super) async fn live(
    State(site): State<Arc<Site>>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Refusal> {
    let socket = upgrade.map_err(|error| Refusal::new(error.status(), error.body_text()))?;
    let full = |_| Refusal::busy("too many clients are connected");
    let place = Arc::clone(&site.live.0).try_acquire_owned().map_err(full)?;
    Ok(socket
        .max_message_size(MOST_READ)
        .max_frame_size(MOST_READ)
        .write_buffer_size(0)
        .on_upgrade(move |socket| Client::new(socket, site, place).talk()))
}

/// A client.
struct Client {
    socket: WebSocket,
    site: Arc<Site>,
    status: watch::Receiver<Arc<Status>>,
    frames: [watch::Receiver<Option<Arc<SentFrame>>>; 2],
    _place: OwnedSemaphorePermit,
}

/// The reason why a connection ends.
enum End {
    /// The client ended the connection, or cannot be reached.
    Gone,
    /// The server ends the connection, for this reason.
    Refused(CloseFrame),
}

impl Client {
    fn new(socket: WebSocket, site: Arc<Site>, place: OwnedSemaphorePermit) -> Self {
        let state = site.client.state();
        let mut status = state.watch_status();
        let mut frames = LaneId::ALL.map(|lane| state.watch_frames(lane));
        // The present status and frames are new to it.
        status.mark_changed();
        frames.iter_mut().for_each(watch::Receiver::mark_changed);
        Self {
            socket,
            status,
            frames,
            site,
            _place: place,
        }
    }

    async fn talk(mut self) {
        for lane in LaneId::ALL {
            // A renderer that is too busy for it shows its next frame anyway.
            let _ = self.site.client.ask(Request::Show(lane));
        }
        if let Err(End::Refused(reason)) = self.exchange().await {
            // A client that cannot receive the reason is disconnected all the same.
            let _ = self.socket.send(Message::Close(Some(reason))).await;
            // Messages on their way here would otherwise discard the reason.
            let rest = async { while let Some(Ok(_)) = self.socket.recv().await {} };
            let _ = timeout(FAREWELL, rest).await;
        }
    }

    /// Sends statuses and frames, and passes commands to the renderer, until the connection ends.
    async fn exchange(&mut self) -> Result<(), End> {
        let mut status_due = Instant::now();
        let mut ping = interval(PING_GAP);
        ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            let [a, b] = &mut self.frames;
            tokio::select! {
                message = self.socket.recv() => {
                    let command = heard(message)?;
                    self.pass_on(command).await?;
                }
                changed = a.changed() => self.send_frame(changed, LaneId::A).await?,
                changed = b.changed() => self.send_frame(changed, LaneId::B).await?,
                changed = changed_after(&mut self.status, status_due) => {
                    changed.map_err(gone)?;
                    let status = self.status.borrow_and_update().clone();
                    let text = serde_json::to_string(&*status).map_err(|_| End::Gone)?;
                    self.send(Message::Text(text.into())).await?;
                    status_due = Instant::now() + STATUS_GAP;
                }
                _ = ping.tick() => self.send(Message::Ping(Bytes::new())).await?,
            }
        }
    }

    async fn send(&mut self, message: Message) -> Result<(), End> {
        self.socket.send(message).await.map_err(|_| End::Gone)
    }

    async fn send_frame(
        &mut self,
        changed: Result<(), watch::error::RecvError>,
        lane: LaneId,
    ) -> Result<(), End> {
        changed.map_err(gone)?;
        let shown = self.frames[lane.index()].borrow_and_update().clone();
        match shown {
            Some(shown) => self.send(Message::Binary(shown.message())).await,
            None => Ok(()),
        }
    }

    /// Passes a command to the renderer. While the renderer is too busy, no further message of the client is read.
    async fn pass_on(&mut self, command: Option<Command>) -> Result<(), End> {
        let Some(command) = command else {
            return Ok(());
        };
        if !self.status.borrow().controls {
            return Err(close(close_code::POLICY, "this render takes no commands"));
        }
        for _ in 0..TRIES {
            let request = Request::Command(command.clone());
            if self.site.client.ask(request).is_ok() {
                return Ok(());
            }
            sleep(TRY_GAP).await;
        }
        Err(close(close_code::AGAIN, "the render is busy"))
    }
}

/// Waits until `due`, and then for a change.
async fn changed_after(
    status: &mut watch::Receiver<Arc<Status>>,
    due: Instant,
) -> Result<(), watch::error::RecvError> {
    sleep_until(due).await;
    status.changed().await
}

/// Returns the command in a message. None: the message has none, such as the answer to a ping.
fn heard(message: Option<Result<Message, axum::Error>>) -> Result<Option<Command>, End> {
    match message {
        None | Some(Ok(Message::Close(_))) => Err(End::Gone),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => Ok(None),
        Some(Ok(Message::Binary(_))) => Err(close(close_code::UNSUPPORTED, "commands are text")),
        Some(Ok(Message::Text(text))) if text.len() > LARGEST_MESSAGE => Err(too_large()),
        Some(Ok(Message::Text(text))) => command(&text).map(Some),
        Some(Err(error)) => Err(broken(error)),
    }
}

fn command(text: &str) -> Result<Command, End> {
    serde_json::from_str(text).map_err(|error: serde_json::Error| {
        if error.is_data() {
            close(close_code::POLICY, &format!("not a command: {error}"))
        } else {
            close(close_code::INVALID, &format!("not JSON: {error}"))
        }
    })
}

/// Returns the end of a connection whose message cannot be read.
fn broken(error: axum::Error) -> End {
    use tungstenite::Error;
    match error.into_inner().downcast_ref::<Error>() {
        Some(Error::Capacity(_)) => too_large(),
        Some(Error::Utf8(_)) => close(close_code::INVALID, "a text is UTF-8"),
        Some(Error::Protocol(_)) => close(close_code::PROTOCOL, "this is not a WebSocket"),
        _ => End::Gone,
    }
}

fn too_large() -> End {
    close(close_code::SIZE, "a message has 4096 bytes at most")
}

fn close(code: u16, reason: &str) -> End {
    // A control frame has room for 123 bytes.
    let mut end = reason.len().min(120);
    while !reason.is_char_boundary(end) {
        end -= 1;
    }
    let reason = reason[..end].into();
    End::Refused(CloseFrame { code, reason })
}

/// Returns the end of a connection whose renderer is gone.
fn gone(_: watch::error::RecvError) -> End {
    close(close_code::AWAY, "the render has ended")
}
