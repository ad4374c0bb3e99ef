//! Progress on stderr: a bar on a terminal, lines elsewhere. The library has no clock; this has.

use crate::args;
use crate::console::{Display, say};
use crate::settings::Budget;
use crate::signals::Signals;
use bidir::driver::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Lines are at least this far apart.
const SHORTEST_GAP: Duration = Duration::from_secs(1);
/// A line is due after this time,
const LONGEST_GAP: Duration = Duration::from_secs(10);
/// or this much progress. Unit: percent.
const STEP: u32 = 10;
/// The bar's resolution.
const BAR_LENGTH: u64 = 1000;

/// What progress is measured by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// When it is enough.
    pub(crate) budget: Budget,
    /// The samples of a pass.
    pub(crate) samples_per_pass: u64,
    /// When the render began.
    pub(crate) start: Instant,
}

/// Tells how far a render is.
pub(crate) struct Reporter<'a> {
    signals: &'a Signals,
    clock: Clock,
    samples: AtomicU64,
    /// True when it was said that the running pass is the last.
    is_stop_told: AtomicBool,
    channel: Channel,
}

enum Channel {
    Silent,
    Bar(ProgressBar),
    Lines(Mutex<LastLine>),
}

/// When the last line was written, and what it said.
struct LastLine {
    at: Instant,
    percent: u32,
}

impl<'a> Reporter<'a> {
    /// Reports on a render.
    pub(crate) fn new(display: Display, signals: &'a Signals, clock: Clock) -> Self {
        let channel = match display {
            Display::Silent => Channel::Silent,
            Display::Bar => Channel::Bar(bar()),
            Display::Lines => Channel::Lines(Mutex::new(LastLine {
                at: clock.start,
                percent: 0,
            })),
        };
        let (samples, is_stop_told) = (AtomicU64::new(0), AtomicBool::new(false));
        Self {
            signals,
            clock,
            samples,
            is_stop_told,
            channel,
        }
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        if let Channel::Bar(bar) = &self.channel {
            bar.finish_and_clear();
        }
    }

    /// How far it is: passes, time, and the part of the budget that is used.
    fn state(&self) -> (f64, Duration, f64) {
        let samples = self.samples.load(Ordering::Relaxed);
        let passes = samples as f64 / self.clock.samples_per_pass.max(1) as f64;
        let elapsed = self.clock.start.elapsed();
        (passes, elapsed, self.clock.budget.used(passes, elapsed))
    }

    /// `pass 5 of 64`, the running one.
    fn pass(&self, passes: f64) -> String {
        let running = passes as u64 + 1;
        match self.clock.budget.passes {
            Some(most) => format!("pass {} of {most}", running.min(most)),
            None => format!("pass {running}"),
        }
    }

    /// Says once that the running pass is the last.
    fn tell_stop(&self) {
        if self.signals.exit().is_none() || self.is_stop_told.swap(true, Ordering::Relaxed) {
            return;
        }
        let text = "stopping after the running pass; a second signal stops at once";
        match &self.channel {
            Channel::Silent => {}
            Channel::Bar(bar) => bar.println(text),
            Channel::Lines(_) => say(text),
        }
    }

    /// Writes a line where one is due.
    fn tell(&self, last: &mut LastLine) {
        let (passes, elapsed, used) = self.state();
        let percent = (used * 100.0) as u32;
        let gap = last.at.elapsed();
        if gap < SHORTEST_GAP || (gap < LONGEST_GAP && percent < last.percent + STEP) {
            return;
        }
        *last = LastLine {
            at: Instant::now(),
            percent,
        };
        let left = elapsed
            .mul_f64((1.0 - used) / used.max(1e-9))
            .min(Duration::from_secs(1 << 30));
        let [elapsed, left] = [elapsed, left].map(args::Duration);
        let pass = self.pass(passes);
        say(format_args!(
            "Progress: {percent}% {pass}, {elapsed}, {left} left"
        ));
    }
}

impl Progress for Reporter<'_> {
    fn advance(&self, samples: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        self.tell_stop();
        match &self.channel {
            Channel::Silent => {}
            Channel::Bar(bar) => {
                let (passes, _, used) = self.state();
                let position = (used * BAR_LENGTH as f64) as u64;
                if position != bar.position() {
                    bar.set_message(self.pass(passes));
                    bar.set_position(position);
                }
            }
            Channel::Lines(last) => {
                // Where another thread is writing, there is nothing to add.
                if let Ok(mut last) = last.try_lock() {
                    self.tell(&mut last);
                }
            }
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(BAR_LENGTH);
    let style =
        ProgressStyle::with_template("{bar:32} {percent:>3}%  {msg}  {elapsed}  {eta} left");
    if let Ok(style) = style {
        bar.set_style(style.progress_chars("━╸ "));
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
