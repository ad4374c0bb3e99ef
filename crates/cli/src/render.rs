//! `bidir render`: renders a scene to an image.

use crate::args::{self, RenderArgs};
use crate::begin::{self, TrainingLimits};
use crate::checkpoint::{Checkpoint, CheckpointWriter};
use crate::console::{Console, json, say};
use crate::denoise::Filter;
use crate::exit::{Exit, Failure};
use crate::output::{self, Outputs};
use crate::progress::{Clock, Reporter};
use crate::pyramid;
use crate::replay;
use crate::scene_io::{self, Developed, FilmHeader, LoadedScene, MetadataValue, Stopping};
use crate::serve::{self, Show};
use crate::settings;
use crate::signals::Signals;
use crate::stats::{Course, Report, Summary, listed};
use crate::threads;
use bidir::analysis::blind_spots;
use bidir::driver::{Budget, Limit, Session, Settings, Spent};
use bidir::integrator::IntegratorKind;
use formats::film::Render;
use std::time::{Duration, Instant};
use viewer::web::Server;
use viewer::{RenderMonitor, RequestQueue, Status};

/// Renders a scene, or repeats one of its samples.
pub(crate) fn run(args: &RenderArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    threads::start_for_render(args.threads.count, console);
    // Checks that need no scene come before loading, which may take long.
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
    let Some(loaded) = scene_io::load_until(&signals, &args.scene, Some(&args.film))? else {
        let is_resumed = checkpoint.is_some_and(|checkpoint| checkpoint.is_resumed());
        return Ok(stopped(&signals, is_resumed, console));
    };
    let load = start.elapsed();
    let mut settings = args.estimator.apply(&loaded.settings);
    let own = loaded.settings.layers.aovs();
    settings.layers = args.layers.layers(loaded.subject.scene.group_names(), own);
    let unused = settings::warn_unused(args, &settings, console);
    let lost = settings::check_strategies("--strategies", &loaded, &settings, console)?;
    let missing = settings::warn_missing(&loaded, &settings, console);
    loaded.print_warnings(&args.scene, unused + lost + missing, console)?;
    if let Some(target) = args.replay {
        replay::check_apart(args, &loaded.inputs)?;
        let limits = TrainingLimits::new(None, None);
        let render = begin::render(args, &loaded, &settings, &signals, limits, console)?;
        let ended = render.map(|render| replay::run(args, render.session, target, &signals));
        return ended.unwrap_or_else(|| Ok(exit_of(&signals)));
    }
    let outputs = Outputs::new(args, loaded.output.as_deref())?;
    outputs.check(args, &loaded.inputs)?;
    let first = || {
        let subject = &loaded.subject;
        Status::preparing(&subject.name, subject.view.film())
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

/// Says that nothing was written because of a signal before the first pass, and returns the exit: with a film to
/// continue from, the same command continues.
fn stopped(signals: &Signals, is_resumed: bool, console: Console) -> Exit {
    console.warning("stopped before the first pass: nothing was written");
    if is_resumed {
        Exit::Checkpoint
    } else {
        exit_of(signals)
    }
}

/// Returns the exit after a signal.
fn exit_of(signals: &Signals) -> Exit {
    signals.exit().unwrap_or(Exit::Interrupted)
}

/// A render whose arguments are checked: only a signal, a full disk or a bug can prevent its image.
struct Job<'a> {
    args: &'a RenderArgs,
    console: Console,
    loaded: &'a LoadedScene,
    settings: &'a Settings,
    outputs: &'a Outputs,
    /// The denoiser. None: images are not denoised.
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
        let budget = settings::budget(&self.args.budget, &self.args.long, self.loaded.spp)?;
        let subject = &self.loaded.subject;
        if let Some(checkpoint) = &checkpoint {
            let header = subject.header(self.settings, None);
            checkpoint.check(&header, budget.range())?;
        }
        let is_resumed = checkpoint.as_ref().is_some_and(Checkpoint::is_resumed);
        let earlier = checkpoint.as_ref().and_then(Checkpoint::earlier);
        let limits = TrainingLimits::new(budget.time, earlier);
        let start = Instant::now();
        if let Some(time) = budget.time {
            self.signals.set_alarm(time)?;
        }
        let started = begin::render(
            self.args,
            self.loaded,
            self.settings,
            self.signals,
            limits,
            self.console,
        );
        let Some(mut render) = started? else {
            return match (self.signals.exit(), budget.time) {
                (None, Some(time)) => Err(Self::no_pass(time, is_resumed, None)),
                _ => Ok(stopped(self.signals, is_resumed, self.console)),
            };
        };
        render.session.start_at(budget.first);
        let mut writer = CheckpointWriter::new(checkpoint, &mut render)?;
        let tev = serve::display(self.args.display_server.as_ref(), &subject.name)?;
        let mut show = Show::new(server, tev, |queue| {
            RenderMonitor::new(queue, &render.session, self.settings, budget.passes)
        });
        let clock = Clock {
            budget,
            samples_per_pass: self.loaded.subject.view.film().crop.area(),
            start,
            first_pass: Instant::now(),
        };
        let (end, pass_time) = self.render(&mut render, clock, &mut writer, &mut show);
        let course = Course {
            load,
            render: start.elapsed(),
            stopping: end.stopping(),
        };
        match end {
            End::Signal(_) if render.session.film().passes().is_empty() => {
                return Ok(stopped(self.signals, false, self.console));
            }
            End::NoPass(time) => return Err(Self::no_pass(time, is_resumed, pass_time)),
            End::Signal(_) | End::Limit(_) => {}
        }
        let header = render.header(course.render, course.stopping);
        let saved = writer.write(&render, &header);
        let session = &render.session;
        let report = Report::new(subject.name.clone(), session, budget, course);
        let written = self.write(session, &header, &report);
        show.leave(session, self.console);
        saved?;
        written?;
        let summary = || {
            let mut summary = Summary::new(session, budget, course);
            let is_part = output::is_part(self.args);
            summary.part = is_part.then(|| session.film().passes().to_string());
            summary.is_denoised = self.filter.is_some();
            summary
        };
        // One without a light was warned of before it was rendered.
        let is_lit = !self.loaded.subject.scene.lights().is_empty();
        let blank = session.blank_warning().filter(|_| is_lit);
        if let Some(warning) = &blank {
            self.console.warning(warning);
        }
        self.print_end(&summary, &report, &writer, end);
        Ok(match end {
            End::Signal(exit) => self.exit(exit),
            End::Limit(_) | End::NoPass(_) => Exit::Done,
        })
    }

    /// Returns the failure of a run whose `time` ended before one of its passes did, each of which takes `pass_time`,
    /// if that is known.
    fn no_pass(time: Duration, is_resumed: bool, pass_time: Option<Duration>) -> Failure {
        let further = if is_resumed { "further " } else { "" };
        let time = args::Duration(time);
        let message = format!("no {further}pass was complete after {time}: nothing was written");
        let more = "give it more --time, or make the image smaller with --size or --crop";
        let hint = match pass_time {
            Some(pass) => format!("a pass takes about {}: {more}", args::Duration(pass)),
            None => more.to_owned(),
        };
        Failure::new(Exit::NoPass, message).with_hint(hint)
    }

    /// Returns the exit after a signal that came after the first pass: with a film file, the same command
    /// continues.
    fn exit(&self, exit: Exit) -> Exit {
        match self.args.long.checkpoint {
            Some(_) => Exit::Checkpoint,
            None => exit,
        }
    }

    /// Renders pass by pass until the budget is used up or a signal arrives. Returns the end, and the time of a pass, if
    /// that is known.
    fn render(
        &self,
        render: &mut Render<'_>,
        clock: Clock,
        writer: &mut CheckpointWriter,
        show: &mut Show,
    ) -> (End, Option<Duration>) {
        let budget = clock.budget;
        let display = self.console.display(self.args.output.talk);
        let before = (render.session.next_pass() - budget.first) * clock.samples_per_pass;
        let reporter = Reporter::new(display, self.signals, clock).after(before);
        let mut rendered = 0_u64;
        let end = loop {
            let spent = Spent {
                passes: rendered,
                total: clock.start.elapsed(),
                rendering: clock.first_pass.elapsed(),
            };
            // A signal has no effect on a render that is complete.
            if let Some(limit) = budget.reached(&render.session, spent) {
                break End::Limit(limit);
            }
            if let Some(exit) = self.signals.exit() {
                break End::Signal(exit);
            }
            // The alarm may ring a little late.
            let is_late = budget.time.is_some_and(|time| spent.total >= time);
            let begun = Instant::now();
            if is_late && rendered == 0 || !render.session.step(&reporter) {
                break self.broken_off(budget, rendered);
            }
            rendered += 1;
            show.add_pass(&render.session, begun.elapsed(), &|| {
                render.header(clock.start.elapsed(), Stopping::Time)
            });
            self.write_if_due(render, clock.start, writer);
        };
        show.end(&render.session, &|| {
            render.header(clock.start.elapsed(), end.stopping())
        });
        match end {
            End::Limit(_) => reporter.complete(),
            End::Signal(_) => reporter.say_stop(),
            End::NoPass(_) => {}
        }
        reporter.finish();
        (end, reporter.pass_time(clock.first_pass.elapsed()))
    }

    /// Returns the end of a run that left a pass, after it had `rendered` others.
    fn broken_off(&self, budget: Budget, rendered: u64) -> End {
        match (self.signals.exit(), budget.time) {
            (Some(exit), _) => End::Signal(exit),
            (None, Some(time)) if rendered == 0 => End::NoPass(time),
            (None, _) => End::Limit(Limit::Time),
        }
    }

    /// Writes the film file if it is due, and also the image if a signal requests it. The render continues
    /// after a failure, as a later attempt may succeed.
    fn write_if_due(&self, render: &Render<'_>, start: Instant, writer: &mut CheckpointWriter) {
        let is_requested = self.signals.take_write_request();
        if !is_requested && !writer.is_due() {
            return;
        }
        let header = render.header(start.elapsed(), Stopping::Time);
        let saved = writer.write(render, &header);
        let written = if is_requested {
            self.write_image(&render.session, &header)
        } else {
            Ok(())
        };
        for failure in [saved, written].into_iter().filter_map(Result::err) {
            self.console.failure(&failure);
        }
    }

    fn write_image(&self, session: &Session<'_>, header: &FilmHeader) -> Result<(), Failure> {
        let film = session.film();
        let (mut developed, mut metadata) = (Developed::new(film), formats::film::metadata(header));
        // If denoising fails, the noisy image is written before the error is returned.
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

    /// Prints warnings, the names of the written files and the summary.
    fn print_end(
        &self,
        summary: &dyn Fn() -> Summary,
        report: &Report,
        writer: &CheckpointWriter,
        end: End,
    ) {
        let warnings = report.warning().into_iter().chain(report.raw_warning());
        warnings.for_each(|warning| self.console.warning(warning));
        if !self.args.output.talk.quiet {
            let film = writer.path().map(|path| path.display().to_string());
            let names: Vec<_> = self.outputs.names().chain(film).collect();
            say(format_args!("wrote {}", listed(&names)));
            summary().lines().iter().for_each(say);
            if self.outputs.pyramid.is_some() {
                report.strategy_table().lines().for_each(say);
            }
            if matches!(end, End::Signal(_)) && writer.path().is_some() {
                say("stopped early; the same command with --resume continues");
            }
            if self.may_gain_by_auto() {
                say("note: rendered with `path`, as the scene asks; try --integrator auto");
            }
        }
    }

    /// Returns true if path tracing is the scene's choice, and misses or undersamples some light paths.
    fn may_gain_by_auto(&self) -> bool {
        let own = self.loaded.settings.integrator;
        self.args.estimator.integrator.is_none()
            && own == IntegratorKind::Path
            && !blind_spots(&self.loaded.subject.scene, &self.loaded.subject.view, own).is_empty()
    }
}

/// The reason why a render ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// A limit of the budget is reached.
    Limit(Limit),
    /// A signal arrived; the command ends with this exit.
    Signal(Exit),
    /// This time ended before the first pass of the run did.
    NoPass(Duration),
}

impl End {
    fn stopping(self) -> Stopping {
        match self {
            Self::Limit(limit) => limit.into(),
            Self::Signal(_) | Self::NoPass(_) => Stopping::Time,
        }
    }
}
