//! The thread that renders: requests, a pass of the lane that is behind, requests, …

use super::StudioSettings;
use super::lane::{Lane, without_training};
use super::save::Saved;
use super::view::View;
use crate::board::{Desk, Request};
use crate::exhibit::{Course, Exhibit};
use crate::status::{Choices, LaneId, State, Status, scene_name};
use bidir::driver::{Resources, Session, Settings};
use bidir::film::{Aov, Layers};
use bidir::path::PathRoulette;
use bidir::scene::Scene;
use bidir::settings::Choice;
use formats::film::{FilmHeader, SceneIdentity, program};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The status is told no more often than this, however short passes are.
const STATUS_GAP: Duration = Duration::from_millis(50);
/// How long a thread with nothing to do sleeps; requests wake it.
const NAP: Duration = Duration::from_secs(60);

/// What renders, and all that it knows.
pub(super) struct Painter {
    pub(super) desk: Desk,
    name: String,
    digest: String,
    scene: Arc<Scene>,
    resources: Resources,
    target: Option<u64>,
    pub(super) roulette: Option<Choice<PathRoulette>>,
    pub(super) view: View,
    /// How each lane is to be rendered.
    pub(super) wanted: Vec<Settings>,
    /// Those that are; none where they could not begin.
    pub(super) lanes: Vec<Lane>,
    generation: u32,
    pub(super) state: State,
    pub(super) message: Option<String>,
    pub(super) saved: Saved,
    /// True where lanes have to begin anew.
    pub(super) is_stale: bool,
    told: Instant,
}

/// Whether the thread goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Next {
    GoOn,
    Close,
}

impl Painter {
    pub(super) fn new(settings: StudioSettings, desk: Desk) -> Self {
        let mut first = settings.settings;
        first.layers = with_inspected(&first.layers);
        Self {
            desk,
            view: View::new(&settings.scene),
            name: settings.name,
            digest: settings.digest,
            scene: settings.scene,
            resources: Resources {
                threads: settings.threads,
                ..Resources::default()
            },
            target: settings.target,
            roulette: settings.roulette,
            wanted: vec![first],
            lanes: Vec::new(),
            generation: 0,
            state: State::Preparing,
            message: None,
            saved: Saved::new(settings.folder),
            is_stale: true,
            told: Instant::now(),
        }
    }

    /// Renders until it is told to close. Tells which files were saved.
    pub(super) fn run(mut self) -> Vec<String> {
        while self.take_requests() == Next::GoOn {
            self.is_stale |= self.view.settle();
            if self.is_stale {
                self.begin();
            } else if let Some(lane) = self.lane_behind() {
                self.render(lane);
            } else if self.rest() == Next::Close {
                break;
            }
        }
        self.saved.into_names()
    }

    /// Does all that waits to be done.
    fn take_requests(&mut self) -> Next {
        self.desk.interrupts().clear();
        while let Some(request) = self.desk.take() {
            if self.serve(request) == Next::Close {
                return Next::Close;
            }
        }
        Next::GoOn
    }

    fn serve(&mut self, request: Request) -> Next {
        match request {
            Request::Command(command) => {
                self.obey(command);
                // Lanes that begin anew tell so themselves: those that are there are not what is wanted.
                if !self.is_stale {
                    self.tell();
                }
            }
            Request::Show(lane) => {
                if let Some(lane) = self.lanes.get_mut(lane.index()) {
                    lane.show(self.desk.board());
                }
            }
            Request::Look(lane, look) => match self.lanes.get(lane.index()) {
                Some(lane) => lane.let_look(look),
                None => look(None),
            },
            Request::Close => return Next::Close,
        }
        Next::GoOn
    }

    /// Waits for a request, or for the camera to stand still.
    fn rest(&mut self) -> Next {
        if self.state == State::Rendering {
            self.state = State::Done;
            self.log("done");
        }
        if self.desk.board().is_watched() {
            for lane in &mut self.lanes {
                lane.show(self.desk.board());
            }
        }
        self.tell();
        let nap = self.view.rest().unwrap_or(NAP);
        match self.desk.wait(nap) {
            Some(request) => self.serve(request),
            None => Next::GoOn,
        }
    }

    /// The lane that passes took the least time of, and that is not complete.
    fn lane_behind(&self) -> Option<usize> {
        if self.state != State::Rendering {
            return None;
        }
        let lanes = self.lanes.iter().enumerate();
        let open = lanes.filter(|(_, lane)| !lane.is_complete());
        let behind = open.min_by_key(|(_, lane)| lane.exhibit.rendered());
        behind.map(|(number, _)| number)
    }

    fn render(&mut self, lane: usize) {
        let (interrupts, board) = (self.desk.interrupts(), self.desk.board());
        let time = self.lanes[lane].step(interrupts, board, self.view.is_preview());
        let is_long = time.is_some_and(|time| time >= STATUS_GAP);
        if is_long || self.told.elapsed() >= STATUS_GAP {
            self.tell();
        }
    }

    /// Begins all lanes anew.
    pub(super) fn begin(&mut self) {
        self.is_stale = false;
        self.generation += 1;
        // They share the scene, which is to be changed.
        self.lanes.clear();
        if self.wanted.len() == 1 {
            self.desk.board().show(LaneId::B, None);
        }
        self.state = State::Preparing;
        self.tell();
        match self.make_lanes() {
            Ok(lanes) => {
                self.lanes = lanes;
                self.state = State::Rendering;
                self.log_begin();
            }
            Err(message) => {
                self.log(&message);
                self.message = Some(message);
                self.state = State::Failed;
            }
        }
        self.tell();
    }

    fn make_lanes(&mut self) -> Result<Vec<Lane>, String> {
        let (camera, film) = self.view.current();
        let scene = Arc::get_mut(&mut self.scene).ok_or("the scene is in use")?;
        scene
            .set_view(camera, film)
            .map_err(|error| error.to_string())?;
        let wanted = LaneId::ALL.into_iter().zip(&self.wanted);
        wanted
            .map(|(lane, wanted)| self.lane(lane, wanted))
            .collect()
    }

    fn lane(&self, lane: LaneId, wanted: &Settings) -> Result<Lane, String> {
        let course = Course {
            generation: self.generation,
            preview: self.view.is_preview(),
            target: self.target,
        };
        let settings = if course.preview {
            without_training(wanted, self.roulette)
        } else {
            wanted.clone()
        };
        let session = Session::new(Arc::clone(&self.scene), settings.clone(), &self.resources)
            .map_err(|error| error.to_string())?;
        Ok(Lane {
            header: self.header(&settings, &session),
            session,
            exhibit: Exhibit::new(lane, course, wanted),
        })
    }

    /// The header of an empty film: a view of its own is a setting like any other.
    fn header(&self, wanted: &Settings, session: &Session<'_>) -> FilmHeader {
        let identity = SceneIdentity {
            name: &self.name,
            digest: &self.digest,
            film: self.scene.film(),
        };
        let header = identity.header(wanted, session.training());
        let Some(view) = self.view.text() else {
            return header;
        };
        let mut settings = header.settings;
        settings.insert("view".to_owned(), view);
        FilmHeader::new(&program(), header.scene, settings)
    }

    /// Tells how everything is.
    pub(super) fn tell(&mut self) {
        self.told = Instant::now();
        let lanes: Vec<_> = self
            .lanes
            .iter()
            .map(|lane| lane.exhibit.status(&lane.session))
            .collect();
        let board = self.desk.board();
        board.tell(Status {
            version: env!("CARGO_PKG_VERSION"),
            scene: scene_name(&self.name),
            state: self.state,
            message: self.message.clone(),
            controls: true,
            film: self.view.full_film().into(),
            choices: Choices::all(),
            camera: Some(self.view.status()),
            split: self.wanted.len() > 1,
            // Where there are none for the moment, those before tell more than nothing.
            lanes: if lanes.is_empty() {
                board.status().lanes.clone()
            } else {
                lanes
            },
        });
    }

    pub(super) fn log(&self, line: &str) {
        self.desk.board().log(line);
    }

    fn log_begin(&self) {
        let names = self.lanes.iter().map(|lane| {
            let status = lane.exhibit.status(&lane.session);
            format!("{} {}", status.integrator, status.shadow_rays)
        });
        let names: Vec<_> = names.collect();
        let kind = if self.view.is_preview() {
            "preview"
        } else {
            "rendering"
        };
        self.log(&format!("{kind}: {}", names.join(" | ")));
    }
}

/// The layers, with those that an inspector asks for.
fn with_inspected(layers: &Layers) -> Layers {
    let aovs = [layers.aovs(), &[Aov::Samples, Aov::Variance, Aov::Rays]].concat();
    Layers::new(&aovs, layers.light_groups(), layers.strategy_vertices())
}
