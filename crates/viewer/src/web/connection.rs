//! Connections: answers, and the time that a peer may do nothing.

use super::places::{Place, Places};
use super::{Site, routes};
use axum::http::StatusCode;
use axum::response::Response;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::future::Future;
use std::io::{self, Write};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::time::{Sleep, sleep};

/// The time that a peer has for the head of a request, from the end of the one before.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// The time that a peer may take nothing of what it is sent.
const PATIENCE: Duration = Duration::from_secs(10);
/// The largest head of a request. Unit: bytes.
const LARGEST_HEAD: usize = 16 << 10;
/// The answer to a peer that gets no place.
const FULL: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\n\
    Content-Length: 30\r\nConnection: close\r\n\r\nthere are too many connections";
/// The time until it is tried again where the system gives no connection, as with too many files.
const RETRY: Duration = Duration::from_millis(100);

/// Accepts connections until `stopped`, which closes all of them.
pub(super) async fn serve(
    listener: std::net::TcpListener,
    site: &Arc<Site>,
    mut stopped: watch::Receiver<bool>,
) {
    let listener = match TcpListener::from_std(listener) {
        Ok(listener) => listener,
        Err(error) => {
            return site
                .client
                .state()
                .log(&format!("the server failed: {error}"));
        }
    };
    let router = routes::router(site);
    let places = Arc::new(Places::default());
    loop {
        tokio::select! {
            accepted = listener.accept() => if let Ok((stream, peer)) = accepted {
                match places.take(peer.ip()) {
                    Some(place) => drop(tokio::spawn(converse(stream, router.clone(), place))),
                    None => turn_away(stream),
                }
            } else {
                places.free_one();
                sleep(RETRY).await;
            },
            _ = stopped.changed() => return,
        }
    }
}

/// Says that there is no place. A new socket takes so little at once; else it is closed without a word.
fn turn_away(stream: TcpStream) {
    let _ = stream.into_std().and_then(|mut stream| stream.write(FULL));
}

/// Answers the requests of a connection, until it has to leave.
async fn converse(stream: TcpStream, router: axum::Router, place: Place) {
    // Without it a small answer may wait; it is no reason to give none.
    let _ = stream.set_nodelay(true);
    let (leave, place) = (place.leave(), Arc::new(place));
    let router = TowerToHyperService::new(router);
    let of_requests = Arc::clone(&place);
    let service = service_fn(move |request| {
        let (answer, place) = (router.call(request), Arc::clone(&of_requests));
        async move {
            place.set_answering(true);
            let answer = answer.await;
            let is_upgrade = |answer: &Response| answer.status() == StatusCode::SWITCHING_PROTOCOLS;
            place.set_answering(answer.as_ref().is_ok_and(is_upgrade));
            answer
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME)
        .max_buf_size(LARGEST_HEAD)
        .serve_connection(TokioIo::new(Patient::new(stream, PATIENCE, place)), service)
        .with_upgrades();
    tokio::select! {
        // An error here closes the peer's connection, and that alone.
        _ = connection => {}
        () = leave.notified() => {}
    }
}

/// A stream whose writes fail when the peer takes nothing for a while.
struct Patient {
    stream: TcpStream,
    /// The time that the peer may take nothing.
    patience: Duration,
    /// When the patience ends. None: the peer is not waited for.
    deadline: Option<Pin<Box<Sleep>>>,
    /// It is free again when the stream is gone, which may be long after an upgrade.
    place: Arc<Place>,
}

impl Patient {
    fn new(stream: TcpStream, patience: Duration, place: Arc<Place>) -> Self {
        Self {
            stream,
            patience,
            deadline: None,
            place,
        }
    }

    /// Returns the outcome of a write, which may be that the patience has ended.
    fn watched<T>(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
        if written.is_ready() {
            if self.deadline.take().is_some() {
                self.place.set_sending(false);
            }
            return written;
        }
        let deadline = self.deadline.get_or_insert_with(|| {
            self.place.set_sending(true);
            Box::pin(sleep(self.patience))
        });
        let late = || Err(io::ErrorKind::TimedOut.into());
        deadline.as_mut().poll(context).map(|()| late())
    }
}

impl AsyncRead for Patient {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

impl AsyncWrite for Patient {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.watched(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, parts);
        self.watched(context, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
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
    use std::time::Instant;
    use tokio::io::AsyncWriteExt;

    /// A stream with this patience, and the peer at its other end.
    async fn pair(patience: Duration) -> (Patient, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let peer = TcpStream::connect(listener.local_addr().unwrap())
            .await
            .unwrap();
        let (stream, _) = listener.accept().await.unwrap();
        let place = Arc::new(Places::default()).take(peer.peer_addr().unwrap().ip());
        (Patient::new(stream, patience, place.unwrap().into()), peer)
    }

    #[tokio::test(flavor = "current_thread")]
    async fn a_peer_that_takes_nothing_is_given_up() {
        let patience = Duration::from_millis(50);
        let (mut stream, peer) = pair(patience).await;
        let start = Instant::now();
        let error = stream.write_all(&vec![0; 1 << 26]).await.unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(start.elapsed() >= patience);
        drop(peer);
    }

    #[tokio::test(flavor = "current_thread")]
    async fn a_peer_that_takes_little_is_waited_for() {
        let (mut stream, mut peer) = pair(PATIENCE).await;
        let writing = tokio::spawn(async move { stream.write_all(&vec![7; 1 << 24]).await });
        let mut taken = Vec::new();
        tokio::io::AsyncReadExt::read_to_end(&mut peer, &mut taken)
            .await
            .unwrap();
        writing.await.unwrap().unwrap();
        assert_eq!(taken.len(), 1 << 24);
    }
}
