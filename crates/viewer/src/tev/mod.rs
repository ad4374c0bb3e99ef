//! A render in the image viewer tev, by its protocol over TCP.
//!
//! A thread of its own connects, again and again where nobody listens, and always sends the newest
//! frame. The renderer only puts frames into a slot, where one is wanted and where developing it costs
//! next to nothing; it waits for nobody before the end, and then not long.

mod address;
mod sender;
mod slot;

#[cfg(test)]
mod tests;

pub use address::{InvalidAddress, TevAddress};

use crate::frame::Frame;
use bidir::film::Film;
use sender::Sender;
use slot::Slot;
use std::io;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};
use thiserror::Error;

/// A frame is developed when this many times as long was rendered as the last one took.
const RENDERING_PER_FRAME: u32 = 50;
/// How long the end waits for the last frame to be sent.
const PATIENCE: Duration = Duration::from_secs(2);

/// Why tev does not show the last frame.
#[derive(Debug, Error)]
pub enum TevError {
    /// There is no such host, or nobody who listens.
    #[error("cannot connect to {address}: {source}")]
    Absent {
        /// Where.
        address: TevAddress,
        /// What the system says.
        source: io::Error,
    },
    /// The connection broke, or what was sent was not read.
    #[error("{address} does not accept images: {source}")]
    Broken {
        /// Where.
        address: TevAddress,
        /// What the system says.
        source: io::Error,
    },
    /// The last frame was not taken in time.
    #[error("{address} did not take the last image within {} seconds", PATIENCE.as_secs())]
    Late {
        /// Where.
        address: TevAddress,
    },
}

/// A render that is shown by tev.
pub struct Tev {
    address: TevAddress,
    slot: Arc<Slot>,
    /// Before this no frame is developed.
    next: Instant,
}

impl Tev {
    /// Begins to show a render of the scene file `scene` at `address`.
    ///
    /// Errors: the system gives no thread.
    pub fn start(address: TevAddress, scene: &str) -> io::Result<Self> {
        let slot = Arc::new(Slot::default());
        let sender = Sender::new(address.clone(), scene, Arc::clone(&slot));
        // It ends with the slot, or with the program: nobody waits for a host that does not answer.
        thread::Builder::new()
            .name("tev".to_owned())
            .spawn(move || sender.run())?;
        Ok(Self {
            address,
            slot,
            next: Instant::now(),
        })
    }

    /// Takes notice of a pass: shows what `film` has where that is wanted, and cheap by now.
    pub fn add_pass(&mut self, film: &Film) {
        let start = Instant::now();
        if self.slot.wants_frame() && start >= self.next {
            self.slot.put(Frame::new(film));
            let end = Instant::now();
            self.next = end + (end - start) * RENDERING_PER_FRAME;
        }
    }

    /// Shows all that was rendered, and waits a moment until it is sent.
    ///
    /// Errors: it is not.
    pub fn end(self, film: &Film) -> Result<(), TevError> {
        if film.passes().is_empty() {
            return Ok(());
        }
        self.slot.put(Frame::new(film));
        self.slot.end();
        let address = self.address.clone();
        let sent = self.slot.result(PATIENCE);
        sent.unwrap_or(Err(TevError::Late { address }))
    }
}

impl Drop for Tev {
    fn drop(&mut self) {
        self.slot.abandon();
    }
}
