//! A render that goes its own way, with those who watch it: they may look, and change nothing.

use crate::board::{Desk, Request, Subject};
use crate::exhibit::{Course, Exhibit};
use crate::status::{Choices, FilmStatus, LaneId, State, Status, scene_name};
use bidir::driver::{Session, Settings};
use formats::film::FilmHeader;
use std::time::Duration;

/// What is told of a render and does not change.
#[derive(Clone, Copy, Debug)]
pub struct StageSettings<'a> {
    /// The scene file, as it was named.
    pub name: &'a str,
    /// How it is rendered.
    pub settings: &'a Settings,
    /// The passes after which it is enough. None: it is not known.
    pub target: Option<u64>,
}

/// What shows a render.
pub struct Stage {
    desk: Desk,
    exhibit: Exhibit,
    scene: String,
    film: FilmStatus,
}

impl Stage {
    /// Shows what `session` is going to render.
    pub fn new(desk: Desk, session: &Session<'_>, settings: StageSettings<'_>) -> Self {
        let course = Course {
            generation: 1,
            preview: false,
            target: settings.target,
        };
        let stage = Self {
            desk,
            exhibit: Exhibit::new(LaneId::A, course, settings.settings),
            scene: scene_name(settings.name),
            film: session.scene().film().into(),
        };
        stage.tell(session, State::Rendering);
        stage
    }

    /// Shows a pass that took so long, and lets those look who have asked for it; `header` is what
    /// files say of the render.
    pub fn add_pass(
        &mut self,
        session: &Session<'_>,
        time: Duration,
        header: &dyn Fn() -> FilmHeader,
    ) {
        self.exhibit.add_pass(session, time, self.desk.board());
        self.tell(session, State::Rendering);
        self.serve(session, header);
    }

    /// Shows that all is done.
    pub fn end(&mut self, session: &Session<'_>, header: &dyn Fn() -> FilmHeader) {
        self.exhibit.show(session, self.desk.board());
        self.tell(session, State::Done);
        self.serve(session, header);
    }

    fn serve(&mut self, session: &Session<'_>, header: &dyn Fn() -> FilmHeader) {
        let subject = Subject {
            session,
            generation: self.exhibit.generation(),
            header,
        };
        while let Some(request) = self.desk.take() {
            match request {
                Request::Show(LaneId::A) => self.exhibit.show(session, self.desk.board()),
                Request::Look(LaneId::A, look) => look(Some(&subject)),
                Request::Look(LaneId::B, look) => look(None),
                // Commands are refused where they arrive.
                Request::Show(LaneId::B) | Request::Command(_) | Request::Close => {}
            }
        }
    }

    fn tell(&self, session: &Session<'_>, state: State) {
        self.desk.board().tell(Status {
            version: env!("CARGO_PKG_VERSION"),
            scene: self.scene.clone(),
            state,
            message: None,
            controls: false,
            film: self.film,
            choices: Choices::default(),
            camera: None,
            split: false,
            lanes: vec![self.exhibit.status(session)],
        });
    }
}
