//! Shows clients a render that they cannot change.

use crate::shared::{Lane, Request, RequestQueue};
use crate::status::{LaneId, State, Status};
use crate::view::{Course, RenderView};
use bidir::driver::Settings;
use formats::film::Render;

/// Shows a render between its passes.
pub struct RenderMonitor {
    queue: RequestQueue,
    view: RenderView,
}

impl RenderMonitor {
    /// Begins to show a render; `settings` are the requested ones, `target` is the number of passes. None: the
    /// number is not known.
    pub fn new(
        queue: RequestQueue,
        render: &Render,
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
        monitor.publish(render, State::Rendering);
        monitor
    }

    /// Shows a pass, and answers requests.
    pub fn add_pass(&mut self, render: &Render) {
        self.view.add_pass(render, self.queue.state());
        self.publish(render, State::Rendering);
        self.answer(render);
    }

    /// Shows the finished render, and answers requests.
    pub fn end(&mut self, render: &Render) {
        self.view.show(render, self.queue.state());
        self.publish(render, State::Done);
        self.answer(render);
    }

    fn answer(&mut self, render: &Render) {
        while let Some(request) = self.queue.take() {
            match request {
                Request::Show(LaneId::A) => self.view.show(render, self.queue.state()),
                Request::Query(LaneId::A, query) => query(Some(&Lane {
                    render,
                    generation: self.view.generation(),
                })),
                Request::Query(LaneId::B, query) => query(None),
                // Commands are refused where they arrive.
                Request::Show(LaneId::B) | Request::Command(_) | Request::Close => {}
            }
        }
    }

    fn publish(&self, render: &Render, state: State) {
        self.queue.state().update(|before| Status {
            state,
            lanes: vec![self.view.status(render)],
            ..before
        });
    }
}
