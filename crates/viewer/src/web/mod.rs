//! The server: a page, the status of the render, its picture, and reports about pixels, over HTTP and a
//! WebSocket. It serves embedded and rendered data, and reads no file.
//!
//! On an address that other machines can reach, clients need a random token. A client that does not read
//! is disconnected after a while. Until then it costs one encoded frame, and the renderer does not wait for it.

mod access;
mod assets;
mod connection;
mod error;
mod images;
mod inspect;
mod live;
mod query;
mod routes;

use crate::shared::ClientHandle;
use access::Access;
use connection::Limited;
use std::future::IntoFuture;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::runtime::Builder;
use tokio::sync::{Semaphore, watch};

/// Number of threads that encode images.
const ENCODERS: usize = 2;

/// The state that the answers to all clients share.
pub(crate) struct Site {
    client: ClientHandle,
    access: Access,
    live: live::Clients,
    /// The permits for simultaneous answers that need the memory of a film.
    large: Semaphore,
}

/// A running server.
#[derive(Debug)]
pub struct Server {
    thread: Option<JoinHandle<()>>,
    url: String,
    stop: watch::Sender<bool>,
}

impl Server {
    /// Serves the renderer behind `client` on `listener`, in a separate thread.
    ///
    /// Errors: the system gives no thread, no random numbers, or no address of the listener.
    pub fn start(listener: TcpListener, client: ClientHandle) -> io::Result<Self> {
        listener.set_nonblocking(true)?;
        let access = Access::new(listener.local_addr()?)?;
        let url = access.url();
        let runtime = Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .max_blocking_threads(ENCODERS)
            .build()?;
        let site = Arc::new(Site {
            client,
            access,
            live: live::Clients::default(),
            large: Semaphore::new(ENCODERS),
        });
        let listener = {
            let _runtime = runtime.enter();
            Limited::new(tokio::net::TcpListener::from_std(listener)?)
        };
        let server = axum::serve(listener, routes::router(&site));
        let (stop, mut stopped) = watch::channel(false);
        let thread = std::thread::Builder::new()
            .name("server".to_owned())
            .spawn(move || {
                runtime.block_on(async {
                    tokio::select! {
                        _ = server.into_future() => {}
                        _ = stopped.changed() => {}
                    }
                });
                // Images that are still encoded are for nobody.
                runtime.shutdown_background();
            })?;
        Ok(Self {
            thread: Some(thread),
            url,
            stop,
        })
    }

    /// Returns the URL, with the token if there is one.
    pub fn url(&self) -> &str {
        &self.url
    }
}

/// Closes all connections.
impl Drop for Server {
    fn drop(&mut self) {
        self.stop.send_replace(true);
        if let Some(thread) = self.thread.take() {
            // A server that failed is gone as well.
            let _ = thread.join();
        }
    }
}

/// Returns a listener on `address`, or if its port is taken, on one of the next `more` ports.
///
/// Errors: all of these ports are taken, or the address is not this machine's.
pub fn listen(address: SocketAddr, more: u16) -> io::Result<TcpListener> {
    let mut ports = address.port()..=address.port().saturating_add(more);
    loop {
        let port = ports.next().unwrap_or(address.port());
        match TcpListener::bind(SocketAddr::new(address.ip(), port)) {
            Err(error) if error.kind() == io::ErrorKind::AddrInUse && !ports.is_empty() => {}
            bound => return bound,
        }
    }
}
