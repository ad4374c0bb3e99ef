//! A render that clients command. One thread renders one lane, or two side by side in equal time, pass
//! by pass, and executes commands between passes. A command that makes a lane begin anew interrupts the
//! running pass at once.
//!
//! The picture of a lane equals the one that `bidir render` makes with the same settings, bit for bit:
//! seeds are kept, and neither frames nor queries change the samples.

mod camera;
mod controller;
mod execute;
mod save;
mod slot;

use crate::shared::{ClientHandle, RequestQueue};
use bidir::driver::{Resources, Settings};
use bidir::path::PathRoulette;
use bidir::settings::Choice;
use controller::RenderController;
use formats::film::Subject;
use std::path::PathBuf;
use std::thread::JoinHandle;

/// The first settings of a lane, and the settings that no command changes.
#[derive(Debug)]
pub struct InteractiveSettings {
    /// The scene, with its own view.
    pub subject: Subject,
    /// The settings of the first lane.
    pub settings: Settings,
    /// Russian roulette for any estimator. None: the default of each.
    pub roulette: Option<Choice<PathRoulette>>,
    /// The threads of each lane.
    pub resources: Resources,
    /// The number of passes. None: there is no end.
    pub target: Option<u64>,
    /// The folder that images are saved in.
    pub folder: PathBuf,
}

/// A thread that renders.
#[derive(Debug)]
pub struct InteractiveRender {
    thread: JoinHandle<Vec<String>>,
    client: ClientHandle,
}

impl InteractiveRender {
    /// Begins to render, and follows the requests of `queue`.
    ///
    /// Errors: the system cannot start a thread.
    pub fn open(settings: InteractiveSettings, queue: RequestQueue) -> std::io::Result<Self> {
        let client = queue.handle();
        let thread = std::thread::Builder::new()
            .name("render".to_owned())
            .spawn(move || RenderController::new(settings, queue).run())?;
        Ok(Self { thread, client })
    }

    /// Returns true if the thread has ended by itself, which is a bug.
    pub fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Interrupts the running pass, and ends the thread. Returns the names of the saved files. None: the
    /// thread failed.
    pub fn close(self) -> Option<Vec<String>> {
        self.client.close();
        self.thread.join().ok()
    }
}
