//! A render that is played with: one thread renders one lane, or two side by side in equal time, pass
//! by pass, and does between passes what it is asked for. What makes a lane begin anew gives the
//! running pass up at once.
//!
//! A lane that began anew has the picture that `bidir render` makes with the same settings, bit for
//! bit: seeds are kept, and what is shown or asked meanwhile has no influence.

mod lane;
mod obey;
mod painter;
mod save;
mod view;

use crate::board::{Desk, Link};
use bidir::driver::Settings;
use bidir::path::PathRoulette;
use bidir::scene::Scene;
use bidir::settings::Choice;
use painter::Painter;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;

/// What is rendered at first, and what stays as it is.
#[derive(Debug)]
pub struct StudioSettings {
    /// The scene file, as it was named.
    pub name: String,
    /// The hash of everything that was read for it.
    pub digest: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// How it is rendered.
    pub settings: Settings,
    /// How subpaths end by chance, whichever the estimator. None: as it suits it.
    pub roulette: Option<Choice<PathRoulette>>,
    /// Threads; 0 is one per processor.
    pub threads: usize,
    /// The passes after which it is enough. None: there is no end.
    pub target: Option<u64>,
    /// The folder that images are saved in.
    pub folder: PathBuf,
}

/// A thread that renders.
#[derive(Debug)]
pub struct Studio {
    thread: JoinHandle<Vec<String>>,
    link: Link,
}

impl Studio {
    /// Begins to render what requests at `desk` are about.
    ///
    /// Errors: no thread can be started.
    pub fn open(settings: StudioSettings, desk: Desk) -> std::io::Result<Self> {
        let link = desk.link();
        let thread = std::thread::Builder::new()
            .name("studio".to_owned())
            .spawn(move || Painter::new(settings, desk).run())?;
        Ok(Self { thread, link })
    }

    /// True where the thread has ended by itself, which only a bug makes it do.
    pub fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Gives the running pass up, and ends. Tells which files were saved; None: the thread failed.
    pub fn close(self) -> Option<Vec<String>> {
        self.link.close();
        self.thread.join().ok()
    }
}
