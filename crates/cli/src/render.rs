//! `bidir render`: renders a scene to an image.

use crate::args::{RenderArgs, short};
use crate::begin;
use crate::checkpoint::Checkpoint;
use crate::console::{Console, json, say};
use crate::denoise::Filter;
use crate::exit::{Exit, Failure};
use crate::output::{self, Outputs};
use crate::progress::{Clock, Reporter};
use crate::pyramid;
use crate::replay;
use crate::scene_io::{self, Developed, FilmFile, Loaded, MetadataValue};
use crate::serve::{self, Show};
use crate::settings;
use crate::signals::Signals;
use crate::stats::{Report, Summary, listed};
use crate::threads;
use bidir::analysis::blind_spots;
use bidir::driver::{Budget, Settings};
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
    let opened = args.layers.denoise.then(|| Filter::load(args.threads));
    let filter = opened.transpose()?;
    let (checkpoint, earlier) = if args.replay.is_none() {
        Outputs::named(args)?.check(args, std::slice::from_ref(&args.scene.scene))?;
        Checkpoint::open(&args.long)?
    } else {
        replay::check(args)?;
        (None, None)
    };
    let bound = args.serve.map(|address| serve::bind(address, 0));
    let listener = bound.transpose()?;
    let start = Instant::now();
    let Some(loaded) = scene_io::load_until(&signals, &args.scene, Some(&args.film))? else {
        return Ok(stopped(&signals, earlier.is_some(), console));
    };
    let load = start.elapsed();
    let mut settings = args.estimator.apply(&loaded.settings.render_settings());
    let groups = loaded.scene.group_names();
    settings.layers = args.layers.layers(groups, &loaded.settings.aovs);
    let unused = settings::warn_unused(args, &settings, console);
    let lost = settings::check_light("--strategies", &loaded, &settings, console)?;
    scene_io::print_warnings(&loaded, &args.scene, unused + lost, console)?;
    let job = Job {
        args,
        console,
        loaded: &loaded,
        settings: &settings,
        outputs: &Outputs::new(args, loaded.settings.output.as_deref())?,
        filter: filter.as_ref(),
        signals: &signals,
    };
    if let Some(target) = args.replay {
        replay::check_apart(args, &loaded.inputs)?;
        let render = begin::render(&job, Budget::default(), None, Instant::now())?;
        let ended = render.map(|render| replay::run(args, render.session, target, &signals));
        return ended.unwrap_or_else(|| Ok(signals.ended()));
    }
    job.outputs.check(args, &loaded.inputs)?;
    let first = || Status::preparing(&loaded.name, loaded.view.film());
    let server = listener.map(|listener| serve::start(listener, first(), &loaded.warnings));
    job.run((checkpoint, earlier), load, server.transpose()?)
}

/// Reports that a signal came before the first pass and nothing was written, and returns the exit. With a film to
/// continue from, the exit says that the same command continues.
fn stopped(signals: &Signals, is_resumed: bool, console: Console) -> Exit {
    console.warning("stopped before the first pass: nothing was written");
    if is_resumed {
        Exit::Checkpoint
    } else {
        signals.ended()
    }
}

/// A render whose arguments are checked: only a signal, a full disk or a bug can prevent its image.
pub(crate) struct Job<'a> {
    pub(crate) args: &'a RenderArgs,
    pub(crate) console: Console,
    pub(crate) loaded: &'a Loaded,
    pub(crate) settings: &'a Settings,
    outputs: &'a Outputs,
    /// The denoiser. None: images are not denoised.
    filter: Option<&'a Filter>,
    pub(crate) signals: &'a Signals,
}

impl Job<'_> {
    fn run(
        &self,
        (mut checkpoint, earlier): (Option<Checkpoint>, Option<FilmFile>),
        load: Duration,
        server: Option<(Server, RequestQueue)>,
    ) -> Result<Exit, Failure> {
        let spp = self.loaded.settings.samples_per_pixel.into();
        let budget = settings::budget(&self.args.budget, &self.args.long, spp)?;
        let is_resumed = earlier.is_some();
        let start = Instant::now();
        if let Some(time) = budget.time {
            self.signals.set_alarm(time)?;
        }
        let Some(mut render) = begin::render(self, budget, earlier, start)? else {
            return self.without_pass(budget.time, is_resumed, None);
        };
        let tev = serve::display(self.args.display_server.as_ref(), &self.loaded.name)?;
        let mut show = Show::new(server, tev, |queue| {
            RenderMonitor::new(queue, &render, self.settings, budget.passes)
        });
        let clock = Clock {
            budget,
            samples_per_pass: self.loaded.view.film().crop.area(),
            start,
            first_pass: Instant::now(),
        };
        let end = self.render(&mut render, clock, &mut checkpoint, &mut show);
        if let End::Nothing(pass_time) = end {
            return self.without_pass(budget.time, is_resumed, pass_time);
        }
        let saved = save(&mut checkpoint, &render);
        let report = Report::new(self.loaded.name.clone(), load, &render, budget);
        let written = self.write(&render, &report);
        show.leave(&render, self.console);
        saved?;
        written?;
        // One without a light was warned of before it was rendered.
        let is_lit = !self.loaded.scene.lights().is_empty();
        let blank = render.session.blank_warning().filter(|_| is_lit);
        if let Some(warning) = &blank {
            self.console.warning(warning);
        }
        let film = checkpoint.map(|checkpoint| checkpoint.name.display().to_string());
        let exit = match (end, &film) {
            // With a film file, the same command continues.
            (End::Signal(_), Some(_)) => Exit::Checkpoint,
            (End::Signal(exit), None) => exit,
            (End::Complete | End::Nothing(_), _) => Exit::Done,
        };
        self.print_end(&render, budget, &report, film, exit);
        Ok(exit)
    }

    /// Ends a run without a complete pass, because of a signal or of the limit `time`. `pass_time` is the time of a
    /// pass. None: it is unknown.
    fn without_pass(
        &self,
        time: Option<Duration>,
        is_resumed: bool,
        pass_time: Option<Duration>,
    ) -> Result<Exit, Failure> {
        let (None, Some(time)) = (self.signals.exit(), time) else {
            return Ok(stopped(self.signals, is_resumed, self.console));
        };
        let further = if is_resumed { "further " } else { "" };
        let time = short(time);
        let message = format!("no {further}pass was complete after {time}: nothing was written");
        let more = "give it more --time, or make the image smaller with --size or --crop";
        let hint = match pass_time {
            Some(pass) => format!("a pass takes about {}: {more}", short(pass)),
            None => more.to_owned(),
        };
        Err(Failure::new(Exit::NoPass, message).with_hint(hint))
    }

    /// Renders pass by pass until the budget is used up or a signal arrives.
    fn render(
        &self,
        render: &mut Render,
        clock: Clock,
        checkpoint: &mut Option<Checkpoint>,
        show: &mut Show,
    ) -> End {
        let budget = clock.budget;
        let display = self.console.display(self.args.output.talk);
        let before = (render.session.next_pass() - budget.first) * clock.samples_per_pass;
        let reporter = Reporter::new(display, self.signals, clock).after(before);
        let limit = render.run(&budget, &reporter, &mut |render| {
            show.add_pass(render);
            self.write_if_due(render, checkpoint);
            true
        });
        show.end(render);
        let is_empty = render.session.film().passes().is_empty();
        // A signal has no effect on a render that is complete.
        let signal = self.signals.exit().filter(|_| limit.is_none());
        let end = match signal {
            Some(exit) if !is_empty => End::Signal(exit),
            None if limit.is_some() || render.spent.passes > 0 => End::Complete,
            _ => End::Nothing(reporter.pass_time(clock.first_pass.elapsed())),
        };
        if signal.is_some() {
            reporter.say_stop();
        } else if matches!(end, End::Complete) {
            reporter.complete();
        }
        reporter.finish();
        end
    }

    /// Writes the film file if it is due, and also the image if a signal requests it. The render continues
    /// after a failure, as a later attempt may succeed.
    fn write_if_due(&self, render: &Render, checkpoint: &mut Option<Checkpoint>) {
        let is_requested = self.signals.take_write_request();
        if !is_requested && !checkpoint.as_ref().is_some_and(Checkpoint::is_due) {
            return;
        }
        let saved = save(checkpoint, render);
        let written = if is_requested {
            self.write_image(render)
        } else {
            Ok(())
        };
        for failure in [saved, written].into_iter().filter_map(Result::err) {
            self.console.failure(&failure);
        }
    }

    fn write_image(&self, render: &Render) -> Result<(), Failure> {
        let film = render.session.film();
        let mut developed = Developed::new(film);
        let mut metadata = formats::film::metadata(&render.header());
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

    fn write(&self, render: &Render, report: &Report) -> Result<(), Failure> {
        self.write_image(render)?;
        if let Some(file) = &self.outputs.pyramid {
            pyramid::write(file, render.session.film(), &render.header())?;
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
        render: &Render,
        budget: Budget,
        report: &Report,
        film: Option<String>,
        exit: Exit,
    ) {
        let warnings = report.warnings.iter();
        warnings.for_each(|warning| self.console.warning(warning));
        if !self.args.output.talk.quiet {
            let names: Vec<_> = self.outputs.names().chain(film).collect();
            say(format_args!("wrote {}", listed(&names)));
            let mut summary = Summary::new(render, budget);
            let is_part = output::is_part(self.args);
            summary.part = is_part.then(|| render.session.film().passes().to_string());
            summary.is_denoised = self.filter.is_some();
            summary.lines().iter().for_each(say);
            if self.outputs.pyramid.is_some() {
                report.strategy_table().lines().for_each(say);
            }
            if exit == Exit::Checkpoint {
                say("stopped early; the same command with --resume continues");
            }
            if self.may_gain_by_auto() {
                say("note: rendered with `path`, as the scene asks; try --integrator auto");
            }
        }
    }

    /// Returns true if the scene, not a flag, chose path tracing, and it misses or undersamples some light paths.
    fn may_gain_by_auto(&self) -> bool {
        let own = self.loaded.settings.integrator;
        self.args.estimator.integrator.is_none()
            && own == IntegratorKind::Path
            && !blind_spots(&self.loaded.scene, &self.loaded.view, own).is_empty()
    }
}

/// Writes the film file, if there is one.
fn save(checkpoint: &mut Option<Checkpoint>, render: &Render) -> Result<(), Failure> {
    let file = checkpoint.as_mut();
    file.map_or(Ok(()), |file| file.write(render))
}

/// The end of a render.
#[derive(Clone, Copy, Debug)]
enum End {
    /// The budget is used up.
    Complete,
    /// A signal arrived after a pass; the command ends with this exit.
    Signal(Exit),
    /// A signal or the end of the time came before the end of the first pass, so that there is nothing to write. The
    /// time is that of a pass, if it is known.
    Nothing(Option<Duration>),
}
