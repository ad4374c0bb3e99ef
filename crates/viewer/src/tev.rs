//! Shows a render in the image viewer tev, by its protocol over TCP.
//!
//! A thread connects to tev, retries until tev listens, and always sends the newest frame. The renderer
//! develops a frame only if the thread waits for one and developing is cheap. It waits only at the end,
//! for at most two seconds.

use crate::frame::Frame;
use bidir::film::Film;
use formats::film::scene_name;
use std::fmt;
use std::io;
use std::net::{Ipv6Addr, TcpStream, ToSocketAddrs};
use std::num::NonZeroU16;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};
use tev_client::{PacketCloseImage, PacketCreateImage, PacketUpdateImage, TevClient};
use thiserror::Error;

/// The port of tev.
const PORT: u16 = 14158;
/// The least rendering time between two frames. Unit: the time of developing the last one.
const RENDERING_PER_FRAME: u32 = 50;
/// The time limit for sending the last frame.
const PATIENCE: Duration = Duration::from_secs(2);
/// The time limit for the answer of each address of a host.
const CONNECTING: Duration = Duration::from_millis(500);
/// Maximum number of addresses of a host that are tried.
const ADDRESSES: usize = 4;
/// The time between two attempts to connect.
const RETRY: Duration = Duration::from_secs(2);
/// The time without reading after which tev counts as stalled.
const STALLED: Duration = Duration::from_secs(1);
/// The least time between two frames.
const SHORTEST_GAP: Duration = Duration::from_millis(250);
/// The pause of the thread after a frame, as sending takes time from the render. Unit: the time of sending.
const REST_PER_FRAME: u32 = 40;
/// Maximum number of values in a packet: large pictures are sent in bands of rows.
const BAND: usize = 1 << 20;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// The reason why tev does not show the last frame.
#[derive(Debug, Error)]
pub enum TevError {
    /// There is no such host, or tev does not listen there.
    #[error("cannot connect to {0}: {1}")]
    Absent(TevAddress, io::Error),
    /// The connection broke, or tev did not read.
    #[error("{0} does not accept images: {1}")]
    Broken(TevAddress, io::Error),
    /// tev did not take the last frame in time.
    #[error("{0} did not take the last image within {seconds} seconds", seconds = PATIENCE.as_secs())]
    Late(TevAddress),
}

/// A render that tev shows.
pub struct Tev {
    address: TevAddress,
    frames: Sender<Frame>,
    /// True while the thread waits for a frame.
    is_wanted: Arc<AtomicBool>,
    result: Receiver<Result<(), TevError>>,
    /// The time before which no frame is developed.
    next: Instant,
}

impl Tev {
    /// Begins to show a render of the scene file `scene` at `address`.
    ///
    /// Errors: the system cannot start a thread.
    pub fn start(address: TevAddress, scene: &str) -> io::Result<Self> {
        let (frames, received) = channel();
        let (report, result) = channel();
        let is_wanted = Arc::<AtomicBool>::default();
        let mut thread = Thread {
            address: address.clone(),
            // Names end with a zero on their way.
            image: scene_name(scene).replace('\0', "\u{fffd}"),
            frames: received,
            is_wanted: Arc::clone(&is_wanted),
            next: None,
            is_over: false,
        };
        thread::Builder::new()
            .name("tev".to_owned())
            // Without a receiver nobody is interested.
            .spawn(move || drop(report.send(thread.run())))?;
        Ok(Self {
            address,
            frames,
            is_wanted,
            result,
            next: Instant::now(),
        })
    }

    /// Shows `film` after a pass, if the thread waits for a frame and developing is cheap.
    pub fn add_pass(&mut self, film: &Film) {
        let start = Instant::now();
        if start >= self.next && self.is_wanted.swap(false, Ordering::Relaxed) {
            // A thread that is gone has reported why.
            let _ = self.frames.send(Frame::new(film));
            let end = Instant::now();
            self.next = end + (end - start) * RENDERING_PER_FRAME;
        }
    }

    /// Shows the last frame, and waits for at most two seconds until it is sent.
    ///
    /// Errors: it is not sent by then.
    pub fn end(self, film: &Film) -> Result<(), TevError> {
        if film.passes().is_empty() {
            return Ok(());
        }
        let _ = self.frames.send(Frame::new(film));
        drop(self.frames);
        let sent = self.result.recv_timeout(PATIENCE);
        sent.unwrap_or(Err(TevError::Late(self.address)))
    }
}

/// The thread that sends frames. It ends with [`Tev`], or with the program, which does not wait for a host
/// that does not answer.
struct Thread {
    address: TevAddress,
    image: String,
    frames: Receiver<Frame>,
    is_wanted: Arc<AtomicBool>,
    /// A frame that is not sent yet.
    next: Option<Frame>,
    /// True if no frame will follow `next`.
    is_over: bool,
}

impl Thread {
    /// Connects and sends frames until the last one is sent.
    fn run(&mut self) -> Result<(), TevError> {
        loop {
            // A try that begins after the end is the last.
            let is_last = self.is_over;
            match self.connect().and_then(|stream| self.show(stream)) {
                Err(_) if !is_last => self.rest(RETRY),
                result => return result,
            }
        }
    }

    fn connect(&self) -> Result<TcpStream, TevError> {
        let absent = |error| TevError::Absent(self.address.clone(), error);
        let addresses = self.address.0.to_socket_addrs().map_err(absent)?;
        let mut failure = io::ErrorKind::AddrNotAvailable.into();
        for address in addresses.take(ADDRESSES) {
            match TcpStream::connect_timeout(&address, CONNECTING) {
                Ok(stream) => return Ok(stream),
                Err(error) => failure = error,
            }
        }
        Err(absent(failure))
    }

    /// Sends frames over a connection until the last one is sent.
    fn show(&mut self, stream: TcpStream) -> Result<(), TevError> {
        let sent = self.send_all(stream);
        sent.map_err(|error| TevError::Broken(self.address.clone(), error))
    }

    fn send_all(&mut self, stream: TcpStream) -> io::Result<()> {
        stream.set_write_timeout(Some(STALLED))?;
        let mut client = TevClient::wrap(stream);
        let mut is_new = true;
        while let Some(frame) = self.take() {
            let start = Instant::now();
            let made = if is_new {
                make_image(&mut client, &self.image, &frame)
            } else {
                Ok(())
            };
            if let Err(error) = made.and_then(|()| send(&mut client, &self.image, &frame)) {
                self.next = Some(frame);
                return Err(error);
            }
            is_new = false;
            self.rest((start.elapsed() * REST_PER_FRAME).max(SHORTEST_GAP));
        }
        Ok(())
    }

    /// Waits for a frame. None: no frame will come.
    fn take(&mut self) -> Option<Frame> {
        if self.next.is_none() && !self.is_over {
            self.is_wanted.store(true, Ordering::Relaxed);
            self.next = self.frames.recv().ok();
        }
        self.next.take()
    }

    /// Waits at most this long, or until the last frame comes. Only the last frame comes without a request.
    fn rest(&mut self, at_most: Duration) {
        if self.is_over {
            return;
        }
        let last = self.frames.recv_timeout(at_most);
        self.is_over = !matches!(last, Err(RecvTimeoutError::Timeout));
        self.next = last.ok().or(self.next.take());
    }
}

/// Closes the image of this name in tev, and creates it anew with the size of `frame`.
fn make_image(client: &mut TevClient, image_name: &str, frame: &Frame) -> io::Result<()> {
    let [width, height] = frame.film.resolution;
    client.send(PacketCloseImage { image_name })?;
    client.send(PacketCreateImage {
        image_name,
        grab_focus: true,
        width,
        height,
        channel_names: &CHANNELS,
    })
}

/// Sends the pixels of `frame`, in bands.
fn send(client: &mut TevClient, image_name: &str, frame: &Frame) -> io::Result<()> {
    let crop = &frame.film.crop;
    let row = crop.width() as usize;
    let rows = (BAND / (CHANNELS.len() * row)).max(1);
    let mut y = crop.min[1];
    for band in frame.pixels.chunks(rows * row) {
        let height = (band.len() / row) as u32;
        client.send(PacketUpdateImage {
            image_name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3; 3],
            x: crop.min[0],
            y,
            width: crop.width(),
            height,
            data: band.as_flattened(),
        })?;
        y += height;
    }
    Ok(())
}

/// The host and the port of tev: `127.0.0.1:14158`, `desk.example`, `[::1]:14158`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TevAddress(String);

/// The error of a text that is not an address.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("expected HOST or HOST:PORT, such as 127.0.0.1:{PORT} or [::1]:{PORT}")]
pub struct InvalidAddress;

impl FromStr for TevAddress {
    type Err = InvalidAddress;

    fn from_str(text: &str) -> Result<Self, InvalidAddress> {
        // Without brackets, colons are those of an address of version 6, or precede the port.
        let address = match text {
            _ if is_v6(text) => format!("[{text}]:{PORT}"),
            _ if is_host(text) => format!("{text}:{PORT}"),
            _ => text.to_owned(),
        };
        let (host, port) = address.rsplit_once(':').ok_or(InvalidAddress)?;
        let is_valid = is_host(host) && port.parse::<NonZeroU16>().is_ok();
        is_valid.then_some(Self(address)).ok_or(InvalidAddress)
    }
}

fn is_v6(host: &str) -> bool {
    host.parse::<Ipv6Addr>().is_ok()
}

/// Returns true for the name of a host, an IPv4 address, or an IPv6 address in brackets.
fn is_host(text: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || "-._%".contains(c);
    let bracketed = text
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'));
    bracketed.map_or_else(|| !text.is_empty() && text.chars().all(is_part), is_v6)
}

impl fmt::Display for TevAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests;
