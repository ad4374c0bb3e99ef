//! The thread that renders. In turn, it takes requests and renders a pass of the lane with less rendering time.

use super::InteractiveSettings;
use super::camera::CameraControl;
use super::save::Saved;
use super::slot::{RenderSlot, without_training};
use crate::shared::{Request, RequestQueue};
use crate::status::{LaneId, State, Status};
use crate::view::{Course, RenderView};
use bidir::driver::{SessionError, Settings};
use bidir::film::{Aov, Layers};
use bidir::view::View;
use formats::film::{Subject, TrainingLimits, Watch};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// The least time between two statuses, even if passes are shorter.
const STATUS_GAP: Duration = Duration::from_millis(50);
/// The time that an idle thread sleeps; requests wake it.
const NAP: Duration = Duration::from_secs(60);

/// The state of the thread.
pub(super) struct RenderController {
    pub(super) queue: RequestQueue,
    pub(super) asked: InteractiveSettings,
    pub(super) camera: CameraControl,
    /// The requested settings of each lane.
    pub(super) wanted: Vec<Settings>,
    /// The lanes that render; empty if they could not begin.
    pub(super) slots: Vec<RenderSlot>,
    generation: u32,
    pub(super) state: State,
    pub(super) message: Option<String>,
    pub(super) saved: Saved,
    /// True if lanes have to begin anew.
    pub(super) is_stale: bool,
    published: Instant,
}

impl RenderController {
    pub(super) fn new(asked: InteractiveSettings, queue: RequestQueue) -> Self {
        let mut first = asked.settings.clone();
        first.layers = with_inspected(&first.layers);
        Self {
            queue,
            camera: CameraControl::new(&asked.subject.scene, asked.subject.view.clone()),
            wanted: vec![first],
            slots: Vec::new(),
            generation: 0,
            state: State::Preparing,
            message: None,
            saved: Saved::new(asked.folder.clone()),
            asked,
            is_stale: true,
            published: Instant::now(),
        }
    }

    /// Renders until a request ends the thread. Returns the names of the saved files.
    pub(super) fn run(mut self) -> Vec<String> {
        while self.step().is_continue() {}
        self.saved.into_names()
    }

    /// Takes all requests, then renders a pass or rests.
    fn step(&mut self) -> ControlFlow<()> {
        self.queue.interrupts().clear();
        while let Some(request) = self.queue.take() {
            self.answer(request)?;
        }
        self.is_stale |= self.camera.settle();
        if self.is_stale {
            self.begin();
        } else if let Some(number) = self.slot_behind() {
            self.render(number);
        } else {
            return self.rest();
        }
        ControlFlow::Continue(())
    }

    fn answer(&mut self, request: Request) -> ControlFlow<()> {
        match request {
            Request::Command(command) => {
                self.execute(command);
                // Lanes that are about to begin anew have no status that anybody wants.
                if !self.is_stale {
                    self.publish();
                }
            }
            Request::Show(lane) => {
                if let Some(slot) = self.slots.get_mut(lane.index()) {
                    slot.show(self.queue.state());
                }
            }
            Request::Query(lane, query) => match self.slots.get(lane.index()) {
                Some(slot) => slot.answer(query),
                None => query(None),
            },
            Request::Close => return ControlFlow::Break(()),
        }
        ControlFlow::Continue(())
    }

    /// Waits for a request, or until the camera is still.
    fn rest(&mut self) -> ControlFlow<()> {
        if self.state == State::Rendering {
            self.state = State::Done;
            self.log("done");
        }
        if self.queue.state().is_watched() {
            for slot in &mut self.slots {
                slot.show(self.queue.state());
            }
        }
        self.publish();
        let nap = self.camera.rest().unwrap_or(NAP);
        match self.queue.wait(nap) {
            Some(request) => self.answer(request),
            None => ControlFlow::Continue(()),
        }
    }

    /// Returns the index of the incomplete slot with the least rendering time. None: all are complete, or the state
    /// is not [`State::Rendering`].
    fn slot_behind(&self) -> Option<usize> {
        if self.state != State::Rendering {
            return None;
        }
        let slots = self.slots.iter().enumerate();
        let open = slots.filter(|(_, slot)| !slot.is_complete());
        let behind = open.min_by_key(|(_, slot)| slot.render.spent.rendering);
        behind.map(|(number, _)| number)
    }

    fn render(&mut self, number: usize) {
        let (interrupts, state) = (self.queue.interrupts(), self.queue.state());
        let time = self.slots[number].step(interrupts, state, self.camera.is_preview());
        let is_long = time.is_some_and(|time| time >= STATUS_GAP);
        if is_long || self.published.elapsed() >= STATUS_GAP {
            self.publish();
        }
    }

    /// Begins all lanes anew.
    pub(super) fn begin(&mut self) {
        self.is_stale = false;
        self.generation += 1;
        self.slots.clear();
        if self.wanted.len() == 1 {
            self.queue.state().show(LaneId::B, None);
        }
        self.state = State::Preparing;
        self.publish();
        let view = match self.camera.current() {
            Ok(view) => view,
            Err(error) => return self.fail(error.to_string()),
        };
        match self.make_slots(&view) {
            Ok(slots) => {
                self.slots = slots;
                self.state = State::Rendering;
                self.log_begin();
            }
            // A command that came in training is taken next, and then it is repeated.
            Err(SessionError::Stopped) => self.is_stale = true,
            Err(error) => self.fail(error.to_string()),
        }
        self.publish();
    }

    fn fail(&mut self, message: String) {
        self.log(&message);
        self.message = Some(message);
        self.state = State::Failed;
    }

    fn make_slots(&self, view: &View) -> Result<Vec<RenderSlot>, SessionError> {
        let wanted = LaneId::ALL.into_iter().zip(&self.wanted);
        wanted
            .map(|(lane, wanted)| self.slot(lane, wanted, view))
            .collect()
    }

    fn slot(
        &self,
        lane: LaneId,
        wanted: &Settings,
        view: &View,
    ) -> Result<RenderSlot, SessionError> {
        let course = Course {
            generation: self.generation,
            preview: self.camera.is_preview(),
            target: self.asked.target,
        };
        let settings = if course.preview {
            without_training(wanted, self.asked.roulette)
        } else {
            wanted.clone()
        };
        let host = Watch {
            stop: self.queue.interrupts().stop(),
            start: Instant::now(),
        };
        let subject = Subject {
            view: view.clone(),
            ..self.asked.subject.clone()
        };
        let render = subject.begin(
            &settings,
            &self.asked.resources,
            TrainingLimits::NONE,
            &host,
        )?;
        Ok(RenderSlot {
            // A view of its own is a setting like any other.
            render: match self.camera.text() {
                Some(text) => render.identified_by("view", text),
                None => render,
            },
            view: RenderView::new(lane, course, wanted),
            blank: None,
        })
    }

    /// Replaces the status that clients see.
    fn publish(&mut self) {
        self.published = Instant::now();
        let slots = self.slots.iter();
        let lanes: Vec<_> = slots.map(|slot| slot.view.status(&slot.render)).collect();
        let blank = self.slots.iter().find_map(|slot| slot.blank.clone());
        self.queue.state().update(|before| Status {
            state: self.state,
            message: self.message.clone().or(blank),
            camera: Some(self.camera.status()),
            split: self.wanted.len() > 1,
            // None for the moment: the last ones say more than nothing.
            lanes: if lanes.is_empty() {
                before.lanes
            } else {
                lanes
            },
            ..before
        });
    }

    pub(super) fn log(&self, line: &str) {
        self.queue.state().log(line);
    }

    fn log_begin(&self) {
        let name = |slot: &RenderSlot| {
            let status = slot.view.status(&slot.render);
            format!("{} {}", status.integrator, status.shadow_rays)
        };
        let names: Vec<_> = self.slots.iter().map(name).collect();
        let kind = if self.camera.is_preview() {
            "preview"
        } else {
            "rendering"
        };
        self.log(&format!("{kind}: {}", names.join(" | ")));
    }
}

/// Returns `layers` with the layers that queries about pixels need.
fn with_inspected(layers: &Layers) -> Layers {
    let aovs = [layers.aovs(), &[Aov::Samples, Aov::Variance, Aov::Rays]].concat();
    Layers::new(&aovs, layers.light_groups(), layers.strategy_vertices())
}
