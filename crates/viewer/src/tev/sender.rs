//! The thread that sends frames.

use super::slot::Slot;
use super::{TevAddress, TevError};
use crate::frame::Frame;
use crate::status::scene_name;
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tev_client::{PacketCloseImage, PacketCreateImage, PacketUpdateImage, TevClient};

/// How long each address of a host is tried.
const CONNECTING: Duration = Duration::from_millis(500);
/// The addresses of a host that are tried.
const ADDRESSES: usize = 4;
/// How long it takes until a host is tried again.
const RETRY: Duration = Duration::from_secs(2);
/// How long nothing may be read of what was sent.
const STALLED: Duration = Duration::from_secs(1);
/// Frames are at least this far apart.
const SHORTEST_GAP: Duration = Duration::from_millis(250);
/// The thread rests this many times as long as it sends, as the time is taken from the render.
const REST_PER_FRAME: u32 = 40;
/// The most numbers of a packet: large pictures go in bands of rows.
const BAND: usize = 1 << 20;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Sends the frames of a slot.
pub(super) struct Sender {
    address: TevAddress,
    image: String,
    slot: Arc<Slot>,
}

impl Sender {
    pub(super) fn new(address: TevAddress, scene: &str, slot: Arc<Slot>) -> Self {
        // Names end with a zero on their way.
        let image = scene_name(scene).replace('\0', "\u{fffd}");
        Self {
            address,
            image,
            slot,
        }
    }

    /// Sends frames until none will follow.
    pub(super) fn run(&self) {
        let result = loop {
            // What is tried after the end is tried once.
            let is_last = self.slot.is_over();
            match self.connect().and_then(|stream| self.show(stream)) {
                Err(_) if !is_last => self.slot.rest(RETRY),
                result => break result,
            }
            if self.slot.is_abandoned() {
                return;
            }
        };
        self.slot.report(result);
    }

    fn connect(&self) -> Result<TcpStream, TevError> {
        let absent = |source| TevError::Absent {
            address: self.address.clone(),
            source,
        };
        let TevAddress { host, port } = &self.address;
        let addresses = (host.as_str(), *port).to_socket_addrs().map_err(absent)?;
        let mut failure = io::ErrorKind::AddrNotAvailable.into();
        for address in addresses.take(ADDRESSES) {
            match TcpStream::connect_timeout(&address, CONNECTING) {
                Ok(stream) => return Ok(stream),
                Err(error) => failure = error,
            }
        }
        Err(absent(failure))
    }

    /// Sends frames to a connection until none will follow.
    fn show(&self, stream: TcpStream) -> Result<(), TevError> {
        let shown = self.send_all(stream);
        self.slot.hold(None);
        shown.map_err(|source| TevError::Broken {
            address: self.address.clone(),
            source,
        })
    }

    fn send_all(&self, stream: TcpStream) -> io::Result<()> {
        stream.set_write_timeout(Some(STALLED))?;
        self.slot.hold(Some(stream.try_clone()?));
        let mut client = TevClient::wrap(stream);
        let mut is_new = true;
        while let Some(frame) = self.slot.take() {
            let start = Instant::now();
            if let Err(error) = self.send(&mut client, &frame, is_new) {
                self.slot.give_back(frame);
                return Err(error);
            }
            is_new = false;
            let rest = start.elapsed() * REST_PER_FRAME;
            self.slot.rest(rest.max(SHORTEST_GAP));
        }
        Ok(())
    }

    /// Sends a frame; the first one of a connection makes its image anew.
    fn send(&self, client: &mut TevClient, frame: &Frame, is_new: bool) -> io::Result<()> {
        let image_name = self.image.as_str();
        let [width, height] = frame.film.resolution;
        if is_new {
            client.send(PacketCloseImage { image_name })?;
            client.send(PacketCreateImage {
                image_name,
                grab_focus: true,
                width,
                height,
                channel_names: &CHANNELS,
            })?;
        }
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
}
