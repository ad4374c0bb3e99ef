//! Progress of an experiment: a bar on a terminal, lines elsewhere.

use crate::args::short;
use crate::console::{Console, Display};
use crate::progress::bar;
use crate::signals::Signals;
use formats::printable;
use indicatif::ProgressBar;
use lab::experiment::{Event, Observer};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// The least time between two lines, except for the first and the last.
const GAP: Duration = Duration::from_secs(10);
/// The template of the bar and its text.
const TEMPLATE: &str = "{bar:32} {percent:>3}%  {msg}  {elapsed}  {eta} left";

/// Reports the progress of an experiment, and supplies its clock.
pub(super) struct Watch<'a> {
    console: Console,
    signals: &'a Signals,
    start: Instant,
    display: Display,
    /// The bar of [`Display::Bar`].
    bar: Option<ProgressBar>,
    /// The time of the last line. None: there was none.
    last: Option<Instant>,
    /// Number of renders done before this run.
    before: usize,
    /// Number of renders done.
    done: usize,
    /// Number of all renders.
    of: usize,
}

impl<'a> Watch<'a> {
    pub(super) fn new(console: Console, display: Display, signals: &'a Signals) -> Self {
        Self {
            console,
            signals,
            start: Instant::now(),
            display,
            bar: bar(display, TEMPLATE),
            last: None,
            before: 0,
            done: 0,
            of: 0,
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }

    /// Shows the finished part, in `[0, 1]`, with a text.
    fn show(&mut self, part: f64, text: &str) {
        let is_due = self.last.is_none_or(|last| last.elapsed() >= GAP) || part >= 1.0;
        if let Some(bar) = &self.bar {
            bar.set_message(printable(text).into_owned());
            bar.set_position((part * 1000.0) as u64);
        } else if is_due {
            self.last = Some(Instant::now());
            let line = format!("Progress: {}% {text}", (part * 100.0) as u32);
            self.display.say(&line);
        }
    }

    /// Returns the state as text, such as `render 3 of 40, 12.3s, 2m04s left`.
    fn count(&self) -> String {
        let Self { done, of, .. } = *self;
        let elapsed = self.start.elapsed();
        let here = (done - self.before).max(1);
        let left = elapsed.mul_f64((of - done) as f64 / here as f64);
        let [elapsed, left] = [elapsed, left].map(short);
        format!("{done} of {of} renders, {elapsed}, {left} left")
    }

    fn begin(&mut self, [done, of]: [usize; 2]) {
        (self.before, self.done, self.of) = (done, done, of);
        self.start = Instant::now();
        self.last = None;
        self.bar.iter().for_each(ProgressBar::reset);
        self.show(part(done, of), &format!("{done} of {of} renders"));
    }
}

fn part(done: usize, of: usize) -> f64 {
    done as f64 / of.max(1) as f64
}

impl Observer for Watch<'_> {
    fn notify(&mut self, event: Event<'_>) {
        match event {
            Event::Warning(text) => match &self.bar {
                Some(bar) => bar.suspend(|| self.console.warning(text)),
                None => self.console.warning(text),
            },
            Event::Reference { scene, passes, of } => {
                let part = part(passes as usize, of as usize).min(0.99);
                self.show(part, &format!("reference of {scene}"));
            }
            Event::Pyramid { scene, passes, of } => {
                let part = part(passes as usize, of as usize).min(0.99);
                self.show(part, &format!("strategies in {scene}"));
            }
            Event::Begin { done, of } => self.begin([done, of]),
            Event::Record(record) => {
                self.done += 1;
                let render = format!("{}, {}, {}", record.scene, record.budget, record.method);
                let what = format!("{} ({render}, seed {})", self.count(), record.seed);
                self.show(part(self.done, self.of), &what);
            }
        }
    }

    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    #[cfg(unix)]
    fn processor_seconds(&self) -> Option<f64> {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }

    fn stop_flag(&self) -> Arc<AtomicBool> {
        self.signals.stop_flag()
    }
}
