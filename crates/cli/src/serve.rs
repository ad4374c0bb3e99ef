//! `bidir render --serve` and `--display-server`: a render with viewers.

use crate::console::{Console, print};
use crate::exit::{Exit, Failure};
use formats::film::Render;
use std::io;
use std::net::{SocketAddr, TcpListener};
use viewer::tev::{Tev, TevAddress};
use viewer::web::{self, Server};
use viewer::{RenderMonitor, RequestQueue, Status, request_queue};

/// Returns a listener on `address`, or if its port is taken, on one of the next `more` ports.
pub(crate) fn bind(address: SocketAddr, more: u16) -> Result<TcpListener, Failure> {
    web::listen(address, more).map_err(|error| {
        let hint = match error.kind() {
            io::ErrorKind::AddrInUse => {
                "another program uses it: choose another port, or 0 for any"
            }
            io::ErrorKind::PermissionDenied => "ports below 1024 are the system's: choose another",
            _ => "use an address of this machine: 127.0.0.1, or 0.0.0.0 for all",
        };
        let message = format!("cannot serve on {address}: {error}");
        Failure::new(Exit::InputOutput, message).with_hint(hint)
    })
}

/// Starts a server with the status `first`, and prints its address.
pub(crate) fn start(
    listener: TcpListener,
    first: Status,
    warnings: &[String],
) -> Result<(Server, RequestQueue), Failure> {
    let (queue, client) = request_queue(first);
    for warning in warnings {
        queue.state().log(&format!("warning: {warning}"));
    }
    let server = Server::start(listener, client).map_err(|error| failed(&error))?;
    print(&format!("{}\n", server.url()))?;
    Ok((server, queue))
}

/// Returns the failure of a server that cannot start, as the system gives no thread or no random numbers.
pub(crate) fn failed(error: &io::Error) -> Failure {
    Failure::new(
        Exit::RenderFailed,
        format!("the server cannot start: {error}"),
    )
}

/// Begins to show the render of a scene in tev, if there is an address.
pub(crate) fn display(address: Option<&TevAddress>, scene: &str) -> Result<Option<Tev>, Failure> {
    let tev = address.map(|address| Tev::start(address.clone(), scene));
    tev.transpose().map_err(|error| {
        let message = format!("--display-server cannot start: {error}");
        Failure::new(Exit::RenderFailed, message)
    })
}

/// The viewers of a render, as the flags request.
pub(crate) struct Show {
    monitor: Option<RenderMonitor>,
    tev: Option<Tev>,
    /// The server, which serves until it is dropped.
    _server: Option<Server>,
}

impl Show {
    /// Begins to show a render.
    pub(crate) fn new(
        server: Option<(Server, RequestQueue)>,
        tev: Option<Tev>,
        monitor: impl FnOnce(RequestQueue) -> RenderMonitor,
    ) -> Self {
        let (server, queue) = server.unzip();
        Self {
            monitor: queue.map(monitor),
            tev,
            _server: server,
        }
    }

    /// Shows a pass.
    pub(crate) fn add_pass(&mut self, render: &Render) {
        if let Some(monitor) = &mut self.monitor {
            monitor.add_pass(render);
        }
        if let Some(tev) = &mut self.tev {
            tev.add_pass(render.session.film());
        }
    }

    /// Shows the finished render.
    pub(crate) fn end(&mut self, render: &Render) {
        if let Some(monitor) = &mut self.monitor {
            monitor.end(render);
        }
    }

    /// Waits until tev has the last image, for a limited time, or warns that tev does not have it. It is called
    /// after all files are written, as showing is not part of the render.
    pub(crate) fn leave(&mut self, render: &Render, console: Console) {
        let tev = self.tev.take();
        if let Some(Err(error)) = tev.map(|tev| tev.end(render.session.film())) {
            console.warning(format_args!("--display-server: {error}"));
        }
    }
}
