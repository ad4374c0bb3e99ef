//! `bidir reference`: renders a reference image.

use crate::args::{FilmArgs, PixelBounds, ReferenceArgs, Size};
use crate::checkpoint::has_passes;
use crate::console::{Console, say};
use crate::exit::{Exit, Failure};
use crate::lock::FilmLock;
use crate::output;
use crate::progress::{Clock, Reporter};
use crate::scene_io::{self, Loaded};
use crate::settings;
use crate::signals::Signals;
use crate::threads;
use bidir::driver::{Budget, Resources, SessionError};
use bidir::film::PixelRect;
use lab::reference::{self, Error, FILMS, Host, Plan, Provenance, Reference};
use std::path::Path;
use std::time::Instant;

/// Makes a reference, continues one, or adds samples to one.
pub(crate) fn run(args: &ReferenceArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    threads::start(args.threads.count, console);
    let folder = args.output.clone();
    let folder = folder.unwrap_or_else(|| output::named_after(&args.scene.scene, ".reference"));
    let earlier = args.extend.map(|_| Provenance::read(&folder));
    let earlier = earlier.transpose().map_err(failure)?;
    check_folder(&folder)?;
    let film = earlier.as_ref().map(film_of);
    let film = film.as_ref().unwrap_or(&args.film);
    let Some(loaded) = scene_io::load_until(&signals, &args.scene, Some(film))? else {
        return Ok(signals.ended());
    };
    scene_io::print_warnings(&loaded, &args.scene, 0, console)?;
    if let Some(earlier) = &earlier {
        let same = earlier.check(&folder, &loaded.digest.to_string(), loaded.view.film());
        same.map_err(failure)?;
    }
    let plan = plan(args, earlier.as_ref(), &loaded)?;
    check_estimators(args, &plan, &loaded, console)?;
    check_apart(&folder, &loaded)?;
    let films = folder.join(FILMS);
    std::fs::create_dir_all(&films).map_err(|error| Failure::io(&films, "make", &error))?;
    let _lock = FilmLock::take(&folder.join("reference"))?;
    if args.restart {
        reference::clear(&folder).map_err(failure)?;
    }
    let job = Job {
        args,
        console,
        folder: &folder,
        loaded: &loaded,
        plan,
        signals: &signals,
    };
    job.run()
}

/// Refuses a folder whose contents are not a reference.
fn check_folder(folder: &Path) -> Result<(), Failure> {
    let is_ours = reference::is_reference(folder) || folder.join(FILMS).is_dir();
    let entries = std::fs::read_dir(folder);
    let has_others = folder.exists() && entries.map_or(true, |mut all| all.next().is_some());
    if is_ours || !has_others {
        return Ok(());
    }
    let message = format!("{} exists already and is not a reference", folder.display());
    Err(Failure::usage(message).with_hint("name another folder with --output"))
}

/// Refuses a folder in which the reference would replace files that the scene reads.
fn check_apart(folder: &Path, loaded: &Loaded) -> Result<(), Failure> {
    let written = reference::files(folder);
    let written = written.iter().map(|file| ("--output", file.as_path()));
    scene_io::check_apart(&loaded.inputs, &written.collect::<Vec<_>>())
}

/// Returns the geometry of the film of a reference.
fn film_of(provenance: &Provenance) -> FilmArgs {
    let [left, top, right, bottom] = provenance.crop;
    FilmArgs {
        size: Some(Size(provenance.resolution)),
        crop: Some(PixelBounds(PixelRect {
            min: [left, top],
            max: [right, bottom],
        })),
        pixelbounds: None,
        cropwindow: None,
    }
}

/// Returns the estimators and the number of samples.
fn plan(
    args: &ReferenceArgs,
    earlier: Option<&Provenance>,
    loaded: &Loaded,
) -> Result<Plan, Failure> {
    if let (Some(earlier), Some(more)) = (earlier, args.extend) {
        return Plan::extended(earlier, more).ok_or_else(|| {
            let message = "the reference has settings that this program does not know";
            Failure::new(Exit::FilmMismatch, message)
        });
    }
    let spp = args.spp.unwrap_or(loaded.settings.samples_per_pixel.into());
    let own = loaded.settings.render_settings();
    let plan = Plan::new(&own, spp, args.requests().each_ref());
    if plan.is_its_own_cross_check() {
        let message =
            "--estimator and --against may be the same estimator, which cannot cross-check itself";
        let hint = "give --against another integrator, or other settings than the seed; \
                    auto may choose any but light";
        return Err(Failure::usage(message).with_hint(hint));
    }
    Ok(plan)
}

/// Refuses estimators that make no path. Warns of settings without effect and of lost light.
fn check_estimators(
    args: &ReferenceArgs,
    plan: &Plan,
    loaded: &Loaded,
    console: Console,
) -> Result<(), Failure> {
    let estimators = plan.estimators.iter().zip(args.requests());
    for ((settings, request), flag) in estimators.zip(["--estimator", "--against"]) {
        for unused in request.ignored(settings) {
            console.warning(format_args!(
                "{flag}: --{unused} has no effect on the integrator `{}`",
                settings.integrator
            ));
        }
        settings::check_light(&format!("{flag}: strategies"), loaded, settings, console)?;
    }
    Ok(())
}

/// A reference whose arguments are checked.
struct Job<'a> {
    args: &'a ReferenceArgs,
    console: Console,
    folder: &'a Path,
    loaded: &'a Loaded,
    plan: Plan,
    signals: &'a Signals,
}

impl Job<'_> {
    fn run(&self) -> Result<Exit, Failure> {
        let subject = self.loaded.subject();
        let resources = Resources {
            threads: self.args.threads.count.into(),
            ..Resources::default()
        };
        let display = self.console.display(self.args.talk);
        let reporter = Reporter::new(display, self.signals, self.clock());
        let host = Host {
            progress: &reporter,
            found: &|samples| reporter.add_earlier(samples),
        };
        let made = reference::make(self.folder, &subject, &self.plan, &resources, host);
        if let Ok(Some(_)) = made {
            reporter.complete();
        }
        reporter.finish();
        let failed = |error| match error {
            Error::Session(SessionError::Film(error)) => scene_io::too_large(self.loaded, &error),
            error => failure(error),
        };
        match made.map_err(failed)? {
            Some(reference) => Ok(self.report(&reference)),
            None => Ok(self.stopped()),
        }
    }

    /// Prints how to continue after a signal, and returns the exit.
    fn stopped(&self) -> Exit {
        if !has_passes(self.folder) {
            self.say(format_args!("stopped before the first pass"));
            return self.signals.ended();
        }
        let folder = self.folder.display();
        self.say(format_args!(
            "stopped; run the same command to continue in {folder}"
        ));
        Exit::Checkpoint
    }

    /// Returns a clock whose budget is the passes of both estimators.
    fn clock(&self) -> Clock {
        // Each replicate is trained, so training counts in the rate of passes.
        let start = Instant::now();
        Clock {
            budget: Budget {
                passes: Some(self.plan.rounded_spp().saturating_mul(2)),
                ..Budget::default()
            },
            samples_per_pass: self.loaded.view.film().crop.area(),
            start,
            first_pass: start,
        }
    }

    fn say(&self, text: std::fmt::Arguments<'_>) {
        if !self.args.talk.quiet {
            say(text);
        }
    }

    /// Prints the results, and returns the exit: `Validation` if the estimators disagree.
    fn report(&self, reference: &Reference) -> Exit {
        let provenance = &reference.provenance;
        let (agreement, folder) = (&provenance.agreement, self.folder.display());
        let dropped: u64 = provenance.estimators.iter().map(|e| e.dropped).sum();
        if dropped > 0 {
            self.console.warning(format_args!(
                "{dropped} contributions were not finite or too large, and were dropped"
            ));
        }
        self.say(format_args!("{}; wrote {folder}", provenance.summary()));
        if !agreement.decided {
            let effective = agreement.effective.unwrap_or_default();
            self.console.warning(format_args!(
                "the estimators cannot be compared: a few bright samples make most of the light, so that \
                 all count as {effective:.1} even ones; add more with --extend"
            ));
        }
        if agreement.agree {
            if let Some(bias) = agreement.smallest_bias {
                let percent = 100.0 * bias;
                self.say(format_args!(
                    "a bias of {percent:.2} % of the film's mean would be detected with even odds"
                ));
            }
            return Exit::Done;
        }
        let worst = if agreement.film.p < agreement.blocks.p {
            &agreement.film
        } else {
            &agreement.blocks
        };
        let [left, top, right, bottom] = worst.block;
        let ([a, b], channel) = (worst.means, worst.channel_name());
        self.console.warning(format_args!(
            "the estimators disagree, most in {channel} of the pixels {left},{top} to \
             {right},{bottom}: {a:.6e} and {b:.6e}; do not use this as ground truth"
        ));
        Exit::Validation
    }
}

/// Returns the failure of the command for an error of a reference.
pub(crate) fn failure(error: Error) -> Failure {
    let text = error.to_string();
    let (exit, hint) = match error {
        Error::File(error) => return error.into(),
        Error::Io { .. } => return Failure::new(Exit::InputOutput, text),
        Error::Session(SessionError::NoPath { .. }) => return Failure::usage(text),
        Error::TooLong { found, .. } => {
            let hint = format!("use --spp {found}, or start over with --restart");
            return Failure::new(Exit::FilmMismatch, text).with_hint(hint);
        }
        Error::Damaged { .. } => (
            Exit::InputOutput,
            "the `bidir reference` command that made it writes it again from its films",
        ),
        Error::Missing(_) => (
            Exit::InputOutput,
            "make one with `bidir reference`, or name another folder",
        ),
        Error::Session(_) => (
            Exit::Scene,
            "make it smaller with --size, or render a part of it with --crop",
        ),
        Error::Refused { .. } => (
            Exit::Validation,
            "make one again with `bidir reference`, in another folder or with --restart",
        ),
        Error::Disagree { .. } => (
            Exit::Validation,
            "take more samples with --extend, or another estimator with --against",
        ),
        Error::OtherRender { .. } => (
            Exit::FilmMismatch,
            "name another folder with --output, or start over with --restart",
        ),
    };
    Failure::new(exit, text).with_hint(hint)
}
