//! `bidir render`: a scene becomes an image.

use crate::args::RenderArgs;
use crate::begin::{self, Began, Training};
use crate::checkpoint::{Checkpoint, Keeper};
use crate::console::{Console, Display, LineFormat, json, say};
use crate::denoise::Filter;
use crate::exit::{Exit, Failure};
use crate::film_header;
use crate::output::{self, Outputs};
use crate::progress::{Clock, Reporter};
use crate::pyramid;
use crate::replay;
use crate::scene_io::{self, Developed, FilmHeader, LoadedScene, MetadataValue, Stopping};
use crate::serve::{self, Show};
use crate::settings::{self, Budget};
use crate::signals::Signals;
use crate::stats::{Course, Report, Summary, listed};
use crate::threads;
use bidir::driver::{Session, Settings};
use bidir::integrator::{IntegratorKind, blind_spots};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use viewer::web::Server;
use viewer::{RenderMonitor, RequestQueue, Status};

/// Renders a scene, or repeats one sample.
pub(crate) fn run(args: &RenderArgs, console: Console) -> Result<Exit, Failure> {
    // First of all: a signal during loading must not kill the command.
    let signals = Signals::watch()?;
    threads::start_for_render(args.threads.count, console);
    // Errors that need no scene come before hours may have gone into one.
    let filter = args.layers.denoise.then(|| Filter::load(args.threads));
    let filter = filter.transpose()?;
    let checkpoint = if args.replay.is_none() {
        Outputs::named(args)?.check(args, std::slice::from_ref(&args.scene.scene))?;
        Checkpoint::open(&args.long)?
    } else {
        replay::check(args)?;
        None
    };
    let listener = args.serve.map(serve::listen).transpose()?;
    let start = Instant::now();
    let loaded = scene_io::load(&args.scene, Some(&args.film))?;
    let load = start.elapsed();
    let mut settings = args.estimator.apply(&loaded.settings);
    let own = loaded.settings.layers.aovs();
    settings.layers = args.layers.layers(loaded.scene.group_names(), own);
    let unused = settings::warn_unused(args, &settings, console);
    let lost = settings::check_strategies("--strategies", &loaded.scene, &settings, console)?;
    let missing = settings::warn_missing(&loaded, &settings, console);
    loaded.print_warnings(&args.scene, unused + lost + missing, console)?;
    if let Some(target) = args.replay {
        replay::check_apart(args, &loaded.inputs)?;
        // Objects that are to be read have standard output to themselves.
        let display = match console.display(args.output.talk) {
            Display::Lines(LineFormat::OpenJd) if args.json => Display::Silent,
            display => display,
        };
        let how = (Training::Whole, display);
        return match begin::session(args, &loaded, &settings, &signals, how, console)? {
            Began::Session(session) => replay::run(args, &loaded.scene, &session, target),
            Began::Stopped(exit) => Ok(exit),
        };
    }
    let outputs = Outputs::new(args, loaded.output.as_deref())?;
    outputs.check(args, &loaded.inputs)?;
    let first = || {
        let name = args.scene.scene.display().to_string();
        Status::preparing(&name, loaded.scene.film())
    };
    let server = listener.map(|listener| serve::start(listener, first(), &loaded.warnings));
    let server = server.transpose()?;
    Job {
        args,
        console,
        loaded: &loaded,
        settings: &settings,
        outputs: &outputs,
        filter: filter.as_ref(),
        signals: &signals,
    }
    .run(checkpoint, load, server)
}

/// A render that nothing but a signal, a full disk or a bug can keep from an image.
struct Job<'a> {
    args: &'a RenderArgs,
    console: Console,
    loaded: &'a LoadedScene,
    settings: &'a Settings,
    outputs: &'a Outputs,
    /// The denoiser of images.
    filter: Option<&'a Filter>,
    signals: &'a Signals,
}

impl Job<'_> {
    fn run(
        &self,
        checkpoint: Option<Checkpoint>,
        load: Duration,
        server: Option<(Server, RequestQueue)>,
    ) -> Result<Exit, Failure> {
        let budget = Budget::new(&self.args.budget, &self.args.long, self.loaded.spp)?;
        let name = self.args.scene.scene.display().to_string();
        let header = |training| film_header::header(&name, self.loaded, self.settings, training);
        if let Some(checkpoint) = &checkpoint {
            checkpoint.check(&header(None), budget.range())?;
        }
        let is_resumed = checkpoint.as_ref().is_some_and(Checkpoint::is_resumed);
        let earlier = checkpoint.as_ref().and_then(Checkpoint::earlier);
        let training = Training::new(budget.time, earlier);
        let start = Instant::now();
        let began = begin::session(
            self.args,
            self.loaded,
            self.settings,
            self.signals,
            (training, self.display()),
            self.console,
        );
        let mut session = match began? {
            Began::Session(session) => *session,
            Began::Stopped(_) if is_resumed => return Ok(self.stopped(Exit::Checkpoint)),
            Began::Stopped(exit) => return Ok(self.stopped(exit)),
        };
        self.warn_short(training, &session);
        session.start_at(budget.first);
        let header = header(session.training());
        let mut keeper = Keeper::new(checkpoint, header, &mut session, start)?;
        let tev = serve::display(self.args.display_server.as_ref(), &name)?;
        let mut show = Show::new(server, tev, |queue| {
            RenderMonitor::new(queue, &session, self.settings, budget.passes)
        });
        let clock = Clock {
            budget,
            samples_per_pass: self.loaded.scene.film().crop.area(),
            start,
            first_pass: Instant::now(),
        };
        let end = self.render(&mut session, clock, &mut keeper, &mut show);
        let course = Course {
            load,
            render: start.elapsed(),
            stopping: end.stopping(),
        };
        if let (End::Signal(exit), true) = (end, session.film().passes().is_empty()) {
            return Ok(self.stopped(exit));
        }
        let header = keeper.header(&session, course.stopping);
        let kept = keeper.keep(&session, &header);
        let report = Report::new(name, &session, budget, course);
        let written = self.write(&session, &header, &report);
        show.leave(&session, self.console);
        kept?;
        written?;
        let summary = || {
            let is_denoised = self.filter.is_some();
            Summary::new(
                &session,
                budget,
                course,
                [output::is_share(self.args), is_denoised],
            )
        };
        self.tell(&summary, &report, &keeper, end);
        Ok(match end {
            End::Signal(exit) => self.exit(exit),
            End::Passes | End::Time | End::Noise => Exit::Done,
        })
    }

    /// Warns that training did not end in time.
    fn warn_short(&self, training: Training, session: &Session<'_>) {
        let is_short = session.training().is_some_and(|training| training.is_short);
        if is_short && matches!(training, Training::By(_)) {
            self.console.warning(
                "training did not end within --time, so the image has more noise than it could; allow more \
                 time, or choose --integrator path or bdpt, which need none",
            );
        }
    }

    /// Ends with `exit` where a signal came before there was anything to write.
    fn stopped(&self, exit: Exit) -> Exit {
        self.console
            .warning("stopped before the first pass: nothing was written");
        exit
    }

    /// The exit after a signal and a pass: with a film file the same command continues.
    fn exit(&self, exit: Exit) -> Exit {
        match self.args.long.checkpoint {
            Some(_) => Exit::Checkpoint,
            None => exit,
        }
    }

    /// Renders pass by pass until the budget is used up or a signal comes.
    fn render(
        &self,
        session: &mut Session<'_>,
        clock: Clock,
        keeper: &mut Keeper,
        show: &mut Show,
    ) -> End {
        let (budget, signals) = (clock.budget, self.signals);
        let before = (session.next_pass() - budget.first) * clock.samples_per_pass;
        let reporter = Reporter::new(self.display(), signals, clock).after(before);
        let mut rendered = 0_u64;
        let end = loop {
            let passes = session.next_pass() - budget.first;
            // A pass is expected to take as long as those before took on average.
            let expected = clock.first_pass.elapsed().div_f64(rendered.max(1) as f64);
            let (counts, times) = ([passes, rendered], [clock.start.elapsed(), expected]);
            if let ControlFlow::Break(end) = next_pass(budget, counts, times, signals.exit()) {
                break end;
            }
            if budget.looks_at_noise(passes) && is_below(budget.noise, session) {
                break End::Noise;
            }
            let begun = Instant::now();
            session.step(&reporter);
            rendered += 1;
            show.add_pass(session, begun.elapsed(), &|| {
                keeper.header(session, Stopping::Time)
            });
            self.keep_now_and_then(session, signals, keeper);
        };
        show.end(session, &|| keeper.header(session, end.stopping()));
        if !matches!(end, End::Signal(_)) {
            reporter.complete();
        }
        reporter.finish();
        end
    }

    fn display(&self) -> Display {
        self.console.display(self.args.output.talk)
    }

    /// Writes the film file where it is time, and the image too where a signal asks for it. What
    /// cannot be written now may be later: the render goes on.
    fn keep_now_and_then(&self, session: &Session<'_>, signals: &Signals, keeper: &mut Keeper) {
        let is_asked = signals.take_write_request();
        if !is_asked && !keeper.is_due() {
            return;
        }
        let header = keeper.header(session, Stopping::Time);
        let kept = keeper.keep(session, &header);
        let written = if is_asked {
            self.write_image(session, &header)
        } else {
            Ok(())
        };
        for failure in [kept, written].into_iter().filter_map(Result::err) {
            self.console.failure(&failure);
        }
    }

    fn write_image(&self, session: &Session<'_>, header: &FilmHeader) -> Result<(), Failure> {
        let film = session.film();
        let (mut developed, mut metadata) = (Developed::new(film), film_header::metadata(header));
        // An image that cannot be denoised is written with its noise.
        let cleaned = self.filter.map_or(Ok(()), |filter| {
            let text = MetadataValue::Text(filter.clean(&mut developed)?);
            metadata.push(("bidir/denoiser".to_owned(), text));
            Ok(())
        });
        self.outputs
            .write_image(film.settings(), &developed, &metadata)?;
        cleaned
    }

    fn write(
        &self,
        session: &Session<'_>,
        header: &FilmHeader,
        report: &Report,
    ) -> Result<(), Failure> {
        self.write_image(session, header)?;
        if let Some(file) = &self.outputs.pyramid {
            pyramid::write(file, session.film(), header)?;
        }
        let Some(path) = &self.outputs.stats else {
            return Ok(());
        };
        Ok(formats::file::replace(
            path,
            (json(report)? + "\n").as_bytes(),
        )?)
    }

    /// Writes the last lines.
    fn tell(&self, summary: &dyn Fn() -> Summary, report: &Report, keeper: &Keeper, end: End) {
        let warnings = report.warning().into_iter().chain(report.raw_warning());
        warnings.for_each(|warning| self.console.warning(warning));
        if !self.args.output.talk.quiet {
            let film = keeper.path().map(|path| path.display().to_string());
            let names: Vec<_> = self.outputs.names().chain(film).collect();
            say(format_args!("wrote {}", listed(&names)));
            summary().lines().iter().for_each(say);
            if self.outputs.pyramid.is_some() {
                report.strategy_table().lines().for_each(say);
            }
            if matches!(end, End::Signal(_)) && keeper.path().is_some() {
                say("stopped early; the same command with --resume continues");
            }
            if self.may_gain_by_auto() {
                say("note: rendered with `path`, as the scene asks; try --integrator auto");
            }
        }
    }

    /// True where nothing but the scene asks for path tracing, and light paths are there that it misses or
    /// samples badly.
    fn may_gain_by_auto(&self) -> bool {
        let own = self.loaded.settings.integrator;
        self.args.estimator.integrator.is_none()
            && own == IntegratorKind::Path
            && !blind_spots(&self.loaded.scene, own).is_empty()
    }
}

/// Why a render ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// All passes are done.
    Passes,
    /// The time is used up.
    Time,
    /// The picture is as good as it has to be.
    Noise,
    /// A signal asked for it, with this exit.
    Signal(Exit),
}

impl End {
    fn stopping(self) -> Stopping {
        match self {
            Self::Passes => Stopping::Fixed,
            Self::Noise => Stopping::Noise,
            Self::Time | Self::Signal(_) => Stopping::Time,
        }
    }
}

/// Decides about another pass after so many of them, of which some were rendered in this run, by the
/// time so far, the time that a pass is expected to take, and what a signal asks for. A signal that
/// comes too late stops nothing.
fn next_pass(
    budget: Budget,
    [passes, rendered]: [u64; 2],
    [elapsed, expected]: [Duration; 2],
    signal: Option<Exit>,
) -> ControlFlow<End> {
    if budget.passes.is_some_and(|most| passes >= most) {
        return ControlFlow::Break(End::Passes);
    }
    if !budget.has_time(rendered, elapsed, expected) {
        return ControlFlow::Break(End::Time);
    }
    match signal {
        Some(exit) => ControlFlow::Break(End::Signal(exit)),
        None => ControlFlow::Continue(()),
    }
}

/// True where the image's relative error is at most `noise`.
fn is_below(noise: Option<f64>, session: &Session<'_>) -> bool {
    noise.is_some_and(|most| session.noise() <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: Budget = Budget {
        first: 0,
        passes: Some(9),
        time: Some(Duration::from_secs(10)),
        noise: None,
    };

    #[track_caller]
    fn check(passes: u64, seconds: [u64; 2], end: End) {
        let times = seconds.map(Duration::from_secs);
        let signal = Some(Exit::Interrupted);
        assert_eq!(
            next_pass(BUDGET, [passes; 2], times, signal),
            ControlFlow::Break(end)
        );
    }

    #[test]
    fn a_signal_stops_what_is_not_complete() {
        check(0, [0, 0], End::Signal(Exit::Interrupted));
        check(1, [4, 4], End::Signal(Exit::Interrupted));
        // Another pass would not have fitted, or is not wanted.
        check(2, [8, 4], End::Time);
        check(9, [1, 1], End::Passes);
    }

    #[test]
    fn who_goes_on_makes_a_pass_however_long_training_took() {
        let times = [Duration::from_secs(20), Duration::ZERO];
        let next = |counts| next_pass(BUDGET, counts, times, None);
        assert_eq!(next([5, 0]), ControlFlow::Continue(()));
        assert_eq!(next([6, 1]), ControlFlow::Break(End::Time));
        assert_eq!(next([9, 0]), ControlFlow::Break(End::Passes));
    }
}
