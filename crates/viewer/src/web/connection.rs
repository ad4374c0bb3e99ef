//! Connections, with limits of their number and of the time that one may be idle.
//!
//! All clients share the limit, which suffices for the few windows of one person. On an open network, a
//! proxy has to distribute connections among clients.

use axum::serve::Listener;
use std::future::Future;
use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep, sleep};

/// Maximum number of connections at once. Further ones wait until one of them ends.
const CONNECTIONS: usize = 128;
/// The time after which an idle connection ends: longer than the renderer needs for an answer.
const PATIENCE: Duration = Duration::from_secs(90);

/// A listener that accepts a limited number of connections at once.
pub(super) struct Limited {
    listener: TcpListener,
    places: Arc<Semaphore>,
}

impl Limited {
    pub(super) fn new(listener: TcpListener) -> Self {
        Self {
            listener,
            places: Arc::new(Semaphore::new(CONNECTIONS)),
        }
    }
}

impl Listener for Limited {
    type Io = Connection;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Connection, SocketAddr) {
        let permit = Arc::clone(&self.places).acquire_owned().await;
        let place = permit.expect("nothing closes the semaphore");
        let (stream, peer) = Listener::accept(&mut self.listener).await;
        // Without it a small answer may wait; it is no reason to give none.
        let _ = stream.set_nodelay(true);
        (Connection::new(stream, PATIENCE, Some(place)), peer)
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

/// A connection that fails if it is idle for too long.
pub(super) struct Connection {
    stream: TcpStream,
    patience: Duration,
    /// The end of the time that the connection may be idle.
    end: Pin<Box<Sleep>>,
    /// The permit, which is returned when the stream is dropped: possibly long after an upgrade.
    _place: Option<OwnedSemaphorePermit>,
}

impl Connection {
    fn new(stream: TcpStream, patience: Duration, place: Option<OwnedSemaphorePermit>) -> Self {
        Self {
            stream,
            patience,
            end: Box::pin(sleep(patience)),
            _place: place,
        }
    }

    /// Polls a transfer. Errors: the connection was idle for too long.
    fn transfer<T>(
        &mut self,
        context: &mut Context<'_>,
        poll: impl FnOnce(Pin<&mut TcpStream>, &mut Context<'_>) -> Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
        let outcome = poll(Pin::new(&mut self.stream), context);
        if outcome.is_ready() {
            self.end.as_mut().reset(Instant::now() + self.patience);
            return outcome;
        }
        let late = || Err(io::ErrorKind::TimedOut.into());
        self.end.as_mut().poll(context).map(|()| late())
    }
}

impl AsyncRead for Connection {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.transfer(context, |stream, context| stream.poll_read(context, buffer))
    }
}

impl AsyncWrite for Connection {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.transfer(context, |stream, context| stream.poll_write(context, bytes))
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.transfer(context, |stream, context| {
            stream.poll_write_vectored(context, parts)
        })
    }

    /// Returns true: without vectored writes, each image would be copied once more.
    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    /// A connection with this patience, and the peer at its other end.
    async fn pair(patience: Duration) -> (Connection, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let peer = TcpStream::connect(listener.local_addr().unwrap()).await;
        let (stream, _) = listener.accept().await.unwrap();
        (Connection::new(stream, patience, None), peer.unwrap())
    }

    #[tokio::test(flavor = "current_thread")]
    async fn an_idle_peer_is_given_up() {
        let (mut connection, _peer) = pair(Duration::from_millis(50)).await;
        let written = connection.write_all(&vec![0; 1 << 26]).await;
        let read = connection.read_u8().await.map(drop);
        for outcome in [written, read] {
            assert_eq!(outcome.unwrap_err().kind(), io::ErrorKind::TimedOut);
        }
    }

    #[tokio::test(flavor = "current_thread")]
    async fn a_peer_that_takes_little_is_waited_for() {
        let (mut connection, mut peer) = pair(PATIENCE).await;
        let writing = tokio::spawn(async move { connection.write_all(&vec![7; 1 << 24]).await });
        let mut taken = Vec::new();
        peer.read_to_end(&mut taken).await.unwrap();
        writing.await.unwrap().unwrap();
        assert_eq!(taken.len(), 1 << 24);
    }
}
