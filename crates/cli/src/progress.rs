//! Progress: a bar on a terminal, lines elsewhere. The library has no clock; this module supplies it.
//!
//! Lines are plain text, JSON, or messages of Open Job Description
//! [OpenJD23, Stdout/Stderr Messages], which go to stdout; all others go to stderr.

use crate::args::{TalkArgs, short};
use crate::console::{Display, print, say};
use crate::exit::Failure;
use crate::signals::Signals;
use bidir::driver::{Budget, Progress, Stop};
use formats::printable;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The least time between two lines.
const SHORTEST_GAP: Duration = Duration::from_secs(1);
/// The time after which a line is due even without [`STEP`].
const LONGEST_GAP: Duration = Duration::from_secs(10);
/// The progress after which a line is due. Unit: percent.
const STEP: u32 = 10;
/// The largest time left in JSON, which also stands for an unknown one.
const LONGEST_LEFT: Duration = Duration::from_secs(1 << 30);
/// The time between two drawings of a bar.
const TICK: Duration = Duration::from_millis(200);
/// The number of steps of the bar.
const BAR_LENGTH: u64 = 1000;
/// The template of the bar and its text. The bar's own estimate of the time left would count samples of earlier runs.
const TEMPLATE: &str = "{bar:32} {percent:>3}%  {msg}  {elapsed}  {prefix}";

/// The limits and times from which progress is computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// The budget that ends the render.
    pub(crate) budget: Budget,
    /// Number of samples of a pass.
    pub(crate) samples_per_pass: u64,
    /// The beginning of the render, before training.
    pub(crate) start: Instant,
    /// The beginning of the first pass of this run.
    pub(crate) first_pass: Instant,
}

/// Reports the progress of a render.
pub(crate) struct Reporter<'a> {
    signals: &'a Signals,
    clock: Clock,
    /// Number of samples of earlier runs.
    before: AtomicU64,
    samples: AtomicU64,
    last: Mutex<LastReport>,
    display: Display,
    /// The bar of [`Display::Bar`].
    bar: Option<ProgressBar>,
}

/// The time and percentage of the last line, or of the last text of the bar.
struct LastReport {
    at: Instant,
    percent: u32,
}

impl<'a> Reporter<'a> {
    /// Returns a reporter of a render without earlier samples.
    pub(crate) fn new(display: Display, signals: &'a Signals, clock: Clock) -> Self {
        let bar = bar(display, TEMPLATE).map(|bar| bar.with_elapsed(clock.start.elapsed()));
        let last = LastReport {
            at: clock.start,
            percent: 0,
        };
        let reporter = Self {
            signals,
            clock,
            before: AtomicU64::new(0),
            samples: AtomicU64::new(0),
            last: Mutex::new(last),
            display,
            bar,
        };
        if reporter.bar.is_some() {
            reporter.show(&reporter.state());
        }
        reporter
    }

    /// Returns the reporter of a render that continues after this number of samples.
    pub(crate) fn after(self, samples: u64) -> Self {
        self.resume(samples);
        self
    }

    /// Writes the line of the end, unless the last line was at 100 %.
    pub(crate) fn complete(&self) {
        let is_last = self.last.lock().is_ok_and(|last| last.percent >= 100);
        if !is_last {
            let pass = self.passes(self.samples.load(Ordering::Relaxed)) as u64;
            self.display.write(&State {
                progress: 1.0,
                pass,
                left: Some(Duration::ZERO),
                ..self.state()
            });
        }
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }

    fn passes(&self, samples: u64) -> f64 {
        samples as f64 / self.clock.samples_per_pass.max(1) as f64
    }

    fn state(&self) -> State {
        let Clock { budget, start, .. } = self.clock;
        let now = self.passes(self.samples.load(Ordering::Relaxed));
        let before = self.passes(self.before.load(Ordering::Relaxed));
        let (elapsed, rendering) = (start.elapsed(), self.clock.first_pass.elapsed());
        let is_known = budget.time.is_some() || now - before >= 1.0;
        let left = budget.left([before, now], elapsed, rendering);
        let running = now as u64 + 1;
        State {
            progress: budget.used(now, elapsed),
            pass: budget.passes.map_or(running, |most| running.min(most)),
            passes: budget.passes,
            elapsed,
            left: left.filter(|_| is_known),
        }
    }

    /// Returns the time of a pass, extrapolated from the samples of this run, which took the time `rendering`. None:
    /// there are less than 0.001 passes.
    pub(crate) fn pass_time(&self, rendering: Duration) -> Option<Duration> {
        let samples = self.samples.load(Ordering::Relaxed) - self.before.load(Ordering::Relaxed);
        let done = self.passes(samples);
        let time = || Duration::try_from_secs_f64(rendering.as_secs_f64() / done).ok();
        (done >= 1e-3).then(time).flatten()
    }

    /// Reports that a signal ends the render.
    pub(crate) fn say_stop(&self) {
        let text = "stopping; a second signal stops at once";
        match &self.bar {
            Some(bar) => bar.println(text),
            None => self.display.say(text),
        }
    }

    /// Writes a line, or the text of the bar, if one is due.
    fn report(&self, last: &mut LastReport) {
        let (state, gap) = (self.state(), last.at.elapsed());
        let is_step = state.percent() >= last.percent + STEP;
        let is_due = match self.display {
            Display::Bar => gap >= TICK,
            _ => gap >= LONGEST_GAP || gap >= SHORTEST_GAP && is_step,
        };
        if is_due {
            *last = LastReport {
                at: Instant::now(),
                percent: state.percent(),
            };
            self.show(&state);
        }
    }

    fn show(&self, state: &State) {
        match &self.bar {
            Some(bar) => state.draw(bar),
            None => self.display.write(state),
        }
    }
}

impl Progress for Reporter<'_> {
    fn advance(&self, samples: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        // A report that another thread is writing is enough.
        if let Ok(mut last) = self.last.try_lock() {
            self.report(&mut last);
        }
    }

    fn resume(&self, samples: u64) {
        self.before.fetch_add(samples, Ordering::Relaxed);
        self.samples.fetch_add(samples, Ordering::Relaxed);
    }

    fn stop(&self) -> Stop<'_> {
        self.signals.stop()
    }

    fn nanoseconds(&self) -> u64 {
        u64::try_from(self.clock.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

/// Returns a bar of [`BAR_LENGTH`] steps. None: the form of progress is another.
///
/// A thread of the bar redraws it at intervals, so that its time advances; but not if the system gives no more
/// threads, as the bar would then panic.
pub(crate) fn bar(display: Display, template: &str) -> Option<ProgressBar> {
    if display != Display::Bar {
        return None;
    }
    let bar = ProgressBar::new(BAR_LENGTH);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("━╸ "));
    }
    if thread::Builder::new().spawn(|| ()).is_ok() {
        bar.enable_steady_tick(TICK);
    }
    Some(bar)
}

/// The progress of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    /// The used fraction of the budget. Range: `[0, 1]`.
    progress: f64,
    /// The running pass, counted from 1.
    pass: u64,
    /// The number of passes. None: there is no limit.
    passes: Option<u64>,
    elapsed: Duration,
    /// The time left. None: it is unknown before the end of the first pass, or without a limit of passes or time.
    left: Option<Duration>,
}

impl State {
    /// Returns the running pass as text, such as `pass 5 of 64`.
    fn pass(&self) -> String {
        match self.passes {
            Some(most) => format!("pass {} of {most}", self.pass),
            None => format!("pass {}", self.pass),
        }
    }

    /// Returns the time left as text, such as `14.9s left`; empty if it is unknown.
    fn left(&self) -> String {
        let left = self.left.map(|left| format!("{} left", short(left)));
        left.unwrap_or_default()
    }

    /// Shows the state in a bar.
    fn draw(&self, bar: &ProgressBar) {
        bar.set_message(self.pass());
        bar.set_prefix(self.left());
        bar.set_position((self.progress * BAR_LENGTH as f64) as u64);
    }

    fn percent(&self) -> u32 {
        (self.progress * 100.0) as u32
    }

    fn plain(&self) -> String {
        let elapsed = short(self.elapsed);
        let (percent, pass, left) = (self.percent(), self.pass(), self.left());
        let comma = if left.is_empty() { "" } else { ", " };
        format!("Progress: {percent}% {pass}, {elapsed}{comma}{left}")
    }

    fn json(&self) -> String {
        let round = |number: f64| (number * 1e3).round() / 1e3;
        let left = self.left.unwrap_or(LONGEST_LEFT).min(LONGEST_LEFT);
        let line = json!({
            "progress": round(self.progress),
            "pass": self.pass,
            "passes": self.passes,
            "seconds": round(self.elapsed.as_secs_f64()),
            "left": round(left.as_secs_f64()),
        });
        line.to_string()
    }
}

impl Display {
    /// Reports an activity without progress.
    pub(crate) fn say(self, text: &str) {
        match self {
            // Readers of NDJSON expect only objects with progress.
            Self::Silent | Self::Ndjson => {}
            Self::OpenJd => write_openjd("status", text),
            Self::Bar | Self::Plain => say(text),
        }
    }

    /// Writes a line of progress; bars have none.
    fn write(self, state: &State) {
        match self {
            Self::Silent | Self::Bar => {}
            Self::Plain => say(state.plain()),
            Self::Ndjson => say(state.json()),
            Self::OpenJd => {
                write_openjd("progress", &format!("{:.1}", state.progress * 100.0));
                write_openjd("status", &state.pass());
            }
        }
    }
}

/// Reports a failure to a scheduler that reads Open Job Description.
pub(crate) fn report_failure(args: TalkArgs, failure: &Failure) {
    if args.progress == Some(Display::OpenJd) {
        write_openjd("fail", failure.message());
    }
}

/// Writes a line of Open Job Description. If writing fails, the render continues, and the command fails at its end.
pub(crate) fn write_openjd(kind: &str, message: &str) {
    let _ = print(&format!("openjd_{kind}: {}\n", printable(message)));
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATE: State = State {
        progress: 0.45312,
        pass: 29,
        passes: Some(64),
        elapsed: Duration::from_millis(12_345),
        left: Some(Duration::from_millis(14_899)),
    };

    #[test]
    fn a_line_is_for_people_or_json() {
        assert_eq!(
            STATE.plain(),
            "Progress: 45% pass 29 of 64, 12.3s, 14.9s left"
        );
        let expected = r#"{"left":14.899,"pass":29,"passes":64,"progress":0.453,"seconds":12.345}"#;
        assert_eq!(STATE.json(), expected);
        let first = State {
            left: None,
            ..STATE
        };
        assert_eq!(first.plain(), "Progress: 45% pass 29 of 64, 12.3s");
        assert!(first.json().contains(r#""left":1073741824.0"#));
        let open = State {
            passes: None,
            ..STATE
        };
        assert_eq!(open.pass(), "pass 29");
        assert!(open.json().contains(r#""passes":null"#));
    }

    #[test]
    fn earlier_samples_and_training_do_not_shorten_the_time_left() {
        let signals = Signals::watch().unwrap();
        let budget = Budget {
            passes: Some(10),
            ..Budget::default()
        };
        let ago = |seconds| Instant::now().checked_sub(Duration::from_secs(seconds));
        let clock = Clock {
            budget,
            samples_per_pass: 100,
            start: ago(60).unwrap(),
            first_pass: ago(10).unwrap(),
        };
        let reporter = Reporter::new(Display::Silent, &signals, clock).after(600);
        reporter.advance(250);
        let state = reporter.state();
        assert!(
            (state.progress - 0.85).abs() < 1e-9 && state.pass == 9,
            "{state:?}"
        );
        // A quarter of all took ten seconds, after training.
        let left = state.left.unwrap().as_secs_f64();
        assert!((left - 6.0).abs() < 0.5, "{state:?}");
    }

    #[test]
    fn the_bar_of_a_long_render_shows_the_pass_and_from_the_second_the_time_left() {
        let signals = Signals::watch().unwrap();
        let budget = Budget {
            passes: Some(100_000),
            ..Budget::default()
        };
        let start = Instant::now().checked_sub(Duration::from_secs(2)).unwrap();
        let clock = Clock {
            budget,
            samples_per_pass: 100,
            start,
            first_pass: start,
        };
        let reporter = Reporter::new(Display::Bar, &signals, clock);
        let bar = reporter.bar.as_ref().unwrap();
        assert_eq!(bar.message(), "pass 1 of 100000");
        for (samples, pass, is_known) in [(50, 1, false), (60, 2, true), (2100, 23, true)] {
            // As after the time between two drawings.
            reporter.last.lock().unwrap().at = start;
            reporter.advance(samples);
            assert_eq!(bar.message(), format!("pass {pass} of 100000"));
            assert_eq!(
                bar.prefix().ends_with(" left"),
                is_known,
                "{}",
                bar.prefix()
            );
        }
        reporter.advance(1000);
        assert_eq!(
            bar.message(),
            "pass 23 of 100000",
            "it was drawn just before"
        );
    }
}
