//! `bidir render --serve` and `--display-server`: a render that others watch.

use crate::args::ServeAddress;
use crate::console::{Console, print};
use crate::exit::{Exit, Failure};
use crate::scene_io::FilmHeader;
use bidir::driver::Session;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::time::Duration;
use viewer::tev::{Tev, TevAddress};
use viewer::web::{self, Server};
use viewer::{Desk, Stage, StageSettings, Status, desk};

/// Takes the address before anything is read.
pub(crate) fn listen(address: ServeAddress) -> Result<TcpListener, Failure> {
    bind(address.0, 0)
}

/// A listener on an address, or where its port is taken on one of the next `more`.
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

/// Starts a server that tells `first` until there is more to tell, and tells on stdout where it is.
pub(crate) fn start(
    listener: TcpListener,
    first: Status,
    warnings: &[String],
) -> Result<(Server, Desk), Failure> {
    let (desk, link) = desk(first);
    for warning in warnings {
        desk.board().log(&format!("warning: {warning}"));
    }
    let server = Server::start(listener, link).map_err(|error| failed(&error))?;
    print(&format!("{}\n", server.url()))?;
    Ok((server, desk))
}

/// The system gives no thread, or no random numbers.
pub(crate) fn failed(error: &io::Error) -> Failure {
    Failure::new(
        Exit::RenderFailed,
        format!("the server cannot start: {error}"),
    )
}

/// Begins to show the render of a scene in tev, where that is asked for.
pub(crate) fn display(address: Option<&TevAddress>, scene: &str) -> Result<Option<Tev>, Failure> {
    let tev = address.map(|address| Tev::start(address.clone(), scene));
    tev.transpose().map_err(|error| {
        let message = format!("--display-server cannot start: {error}");
        Failure::new(Exit::RenderFailed, message)
    })
}

/// A render that is watched, where somebody asked for it.
pub(crate) struct Show {
    stage: Option<Stage>,
    tev: Option<Tev>,
    /// Serves as long as it is there.
    _server: Option<Server>,
}

impl Show {
    /// Shows what `session` is going to render.
    pub(crate) fn new(
        server: Option<(Server, Desk)>,
        tev: Option<Tev>,
        session: &Session<'_>,
        settings: StageSettings<'_>,
    ) -> Self {
        let (server, desk) = server.unzip();
        Self {
            stage: desk.map(|desk| Stage::new(desk, session, settings)),
            tev,
            _server: server,
        }
    }

    /// Shows a pass that took so long.
    pub(crate) fn add_pass(
        &mut self,
        session: &Session<'_>,
        time: Duration,
        header: &dyn Fn() -> FilmHeader,
    ) {
        if let Some(stage) = &mut self.stage {
            stage.add_pass(session, time, header);
        }
        if let Some(tev) = &mut self.tev {
            tev.add_pass(session.film());
        }
    }

    /// Shows that all is done.
    pub(crate) fn end(&mut self, session: &Session<'_>, header: &dyn Fn() -> FilmHeader) {
        if let Some(stage) = &mut self.stage {
            stage.end(session, header);
        }
    }

    /// Waits a moment until tev has the last image; a warning where it has not. When all files are
    /// written, as it is no part of the render.
    pub(crate) fn leave(&mut self, session: &Session<'_>, console: Console) {
        let tev = self.tev.take();
        if let Some(Err(error)) = tev.map(|tev| tev.end(session.film())) {
            console.warning(format_args!("--display-server: {error}"));
        }
    }
}
