//! The newest frame, between the renderer and the thread that sends it.

use super::TevError;
use crate::frame::Frame;
use std::net::{Shutdown, TcpStream};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Room for one frame: a new one takes the place of one that was not sent yet.
#[derive(Debug, Default)]
pub(super) struct Slot {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    frame: Option<Frame>,
    /// True where a frame would be sent at once.
    is_wanted: bool,
    /// True where no frame will follow.
    is_over: bool,
    /// True where nobody waits for the result.
    is_abandoned: bool,
    /// What became of the last frame.
    result: Option<Result<(), TevError>>,
    /// The connection that frames go to.
    stream: Option<TcpStream>,
}

/// What the renderer does.
impl Slot {
    pub(super) fn wants_frame(&self) -> bool {
        self.lock().is_wanted
    }

    pub(super) fn put(&self, frame: Frame) {
        self.change(|state| {
            state.frame = Some(frame);
            state.is_wanted = false;
        });
    }

    /// Says that no frame will follow.
    pub(super) fn end(&self) {
        self.change(|state| state.is_over = true);
    }

    /// What became of the last frame. None: it is not known after so long.
    pub(super) fn result(&self, at_most: Duration) -> Option<Result<(), TevError>> {
        let pending = |state: &mut State| state.result.is_none();
        let waited = self
            .changed
            .wait_timeout_while(self.lock(), at_most, pending);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        state.result.take()
    }

    /// Ends the connection, whatever is on its way.
    pub(super) fn abandon(&self) {
        self.change(|state| {
            (state.is_over, state.is_abandoned) = (true, true);
            state.frame = None;
            if let Some(stream) = state.stream.take() {
                // One that is closed already needs nothing.
                let _ = stream.shutdown(Shutdown::Both);
            }
        });
    }
}

/// What the thread does that sends.
impl Slot {
    /// Waits for a frame. None: none will come.
    pub(super) fn take(&self) -> Option<Frame> {
        let mut state = self.lock();
        state.is_wanted = state.frame.is_none();
        let is_idle = |state: &mut State| state.frame.is_none() && !state.is_over;
        let waited = self.changed.wait_while(state, is_idle);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner);
        state.is_wanted = false;
        state.frame.take()
    }

    /// Puts a frame back that was not sent, unless there is a newer one.
    pub(super) fn give_back(&self, frame: Frame) {
        self.change(|state| {
            if !state.is_abandoned {
                state.frame.get_or_insert(frame);
            }
        });
    }

    pub(super) fn is_over(&self) -> bool {
        self.lock().is_over
    }

    pub(super) fn is_abandoned(&self) -> bool {
        self.lock().is_abandoned
    }

    /// Waits so long, or until no frame will follow.
    pub(super) fn rest(&self, at_most: Duration) {
        let goes_on = |state: &mut State| !state.is_over;
        // Either way the thread goes on.
        let _ = self
            .changed
            .wait_timeout_while(self.lock(), at_most, goes_on);
    }

    /// Lets the renderer end a connection.
    pub(super) fn hold(&self, stream: Option<TcpStream>) {
        self.change(|state| state.stream = stream);
    }

    pub(super) fn report(&self, result: Result<(), TevError>) {
        self.change(|state| state.result = Some(result));
    }
}

impl Slot {
    /// No holder of the lock can panic halfway.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }
}
