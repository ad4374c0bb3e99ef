//! A render of another owner that clients may look at: they change nothing.

use crate::shared::{Request, RequestQueue, Subject};
use crate::status::{LaneId, State, Status};
use crate::view::{Course, RenderView};
use bidir::driver::{Session, Settings};
use formats::film::FilmHeader;
use std::time::Duration;

/// Shows a render between its passes.
pub struct RenderMonitor {
    queue: RequestQueue,
    view: RenderView,
}

impl RenderMonitor {
    /// Shows the render that `session` begins; `settings` are those that were asked for, and `target`
    /// the number of passes. None: it is not known.
    pub fn new(
        queue: RequestQueue,
        session: &Session<'_>,
        settings: &Settings,
        target: Option<u64>,
    ) -> Self {
        let course = Course {
            generation: 1,
            preview: false,
            target,
        };
        let view = RenderView::new(LaneId::A, course, settings);
        let monitor = Self { queue, view };
        monitor.publish(session, State::Rendering);
        monitor
    }

    /// Shows a pass that took `time`, and answers requests; `header` makes the film file's header.
    pub fn add_pass(
        &mut self,
        session: &Session<'_>,
        time: Duration,
        header: &dyn Fn() -> FilmHeader,
    ) {
        self.view.add_pass(session, time, self.queue.state());
        self.publish(session, State::Rendering);
        self.answer(session, header);
    }

    /// Shows the finished render, and answers requests.
    pub fn end(&mut self, session: &Session<'_>, header: &dyn Fn() -> FilmHeader) {
        self.view.show(session, self.queue.state());
        self.publish(session, State::Done);
        self.answer(session, header);
    }

    fn answer(&mut self, session: &Session<'_>, header: &dyn Fn() -> FilmHeader) {
        while let Some(request) = self.queue.take() {
            match request {
                Request::Show(LaneId::A) => self.view.show(session, self.queue.state()),
                Request::Query(LaneId::A, query) => query(Some(&Subject {
                    session,
                    generation: self.view.generation(),
                    header,
                })),
                Request::Query(LaneId::B, query) => query(None),
                // Commands are refused where they arrive.
                Request::Show(LaneId::B) | Request::Command(_) | Request::Close => {}
            }
        }
    }

    fn publish(&self, session: &Session<'_>, state: State) {
        self.queue.state().update(|before| Status {
            state,
            lanes: vec![self.view.status(session)],
            ..before
        });
    }
}
