//! `bidir reference`: renders a reference image.

use crate::args::{FilmArgs, ReferenceArgs};
use crate::checkpoint;
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
use lab::reference::{self, Error, FILMS, Fault, Job, Plan, Provenance};
use std::path::Path;
use std::time::Instant;

/// Makes a reference, continues one, or adds samples to one.
pub(crate) fn run(args: &ReferenceArgs, console: Console) -> Result<Exit, Failure> {
    let signals = Signals::watch()?;
    threads::start(args.threads.count, console);
    let given = args.output.clone();
    let folder = given.unwrap_or_else(|| output::named_after(&args.scene.scene, ".reference"));
    let earlier = args.extend.map(|_| Provenance::read(&folder)).transpose()?;
    check_folder(&folder)?;
    let film = earlier.as_ref().map_or_else(|| args.film.clone(), film_of);
    let Some(loaded) = scene_io::load_until(&signals, &args.scene, Some(&film))? else {
        return Ok(signals.ended());
    };
    scene_io::print_warnings(&loaded, &args.scene, 0, console)?;
    let plan = plan(args, earlier.as_ref(), &loaded)?;
    check_estimators(args, &plan, &loaded, console)?;
    check_apart(&folder, &loaded)?;
    let films = folder.join(FILMS);
    std::fs::create_dir_all(&films).map_err(|error| Failure::io(&films, "make", &error))?;
    let _lock = FilmLock::take(&folder.join("reference"))?;
    if args.restart {
        reference::clear(&folder)?;
    }
    let display = console.display(args.talk);
    let reporter = Reporter::new(display, &signals, clock(&plan, &loaded));
    let made = make(args, &folder, &loaded, &plan, &reporter)?;
    let (lines, exit) = if let Some(provenance) = made {
        report(&provenance, console)
    } else {
        let restart = args.restart.then_some("--restart");
        let (line, exit) = checkpoint::stopped(&folder, restart, &signals);
        (vec![line], exit)
    };
    if !args.talk.quiet {
        lines.iter().for_each(say);
    }
    Ok(exit)
}

/// Renders the reference. None: a signal came first.
fn make(
    args: &ReferenceArgs,
    folder: &Path,
    loaded: &Loaded,
    plan: &Plan,
    reporter: &Reporter<'_>,
) -> Result<Option<Provenance>, Failure> {
    let job = Job {
        folder,
        subject: &loaded.subject(),
        plan,
        resources: &Resources {
            threads: args.threads.count.into(),
            ..Resources::default()
        },
        host: reporter,
    };
    let made = job.make();
    if let Ok(Some(_)) = made {
        reporter.complete();
    }
    reporter.finish();
    made.map_err(|error| match error {
        Error::Session(SessionError::Film(error)) => scene_io::too_large(loaded, &error),
        error => error.into(),
    })
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
    let files = reference::files(folder);
    let written = files.iter().map(|file| ("--output", file.as_path()));
    scene_io::check_apart(&loaded.inputs, &written.collect::<Vec<_>>())
}

/// Returns the geometry of the film of a reference.
fn film_of(provenance: &Provenance) -> FilmArgs {
    let [left, top, right, bottom] = provenance.crop;
    let (min, max) = ([left, top], [right, bottom]);
    FilmArgs {
        size: Some(provenance.resolution),
        crop: Some(PixelRect { min, max }),
        ..FilmArgs::default()
    }
}

/// Returns the estimators and the number of samples.
fn plan(
    args: &ReferenceArgs,
    earlier: Option<&Provenance>,
    loaded: &Loaded,
) -> Result<Plan, Failure> {
    if let (Some(earlier), Some(more)) = (earlier, args.extend) {
        earlier.check(&loaded.subject())?;
        return Ok(Plan::extended(earlier, more)?);
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

/// Returns a clock whose budget is the passes of both estimators.
fn clock(plan: &Plan, loaded: &Loaded) -> Clock {
    // Each replicate is trained, so training counts in the rate of passes.
    let start = Instant::now();
    Clock {
        budget: Budget {
            passes: Some(plan.rounded_spp().saturating_mul(2)),
            ..Budget::default()
        },
        samples_per_pass: loaded.view.film().crop.area(),
        start,
        first_pass: start,
    }
}

/// Prints the warnings of a reference. Returns the lines of its summary, and the exit: `Validation` if the estimators
/// disagree.
fn report(made: &Provenance, console: Console) -> (Vec<String>, Exit) {
    let (agreement, folder) = (&made.agreement, made.folder.display());
    let dropped: u64 = made.estimators.iter().map(|e| e.dropped).sum();
    if dropped > 0 {
        console.warning(format_args!(
            "{dropped} contributions were not finite or too large, and were dropped"
        ));
    }
    if !agreement.decided {
        let effective = agreement.effective.unwrap_or_default();
        console.warning(format_args!(
            "the estimators cannot be compared: a few bright samples make most of the light, so that \
             all count as {effective:.1} even ones; add more with --extend"
        ));
    }
    let mut lines = vec![format!("{}; wrote {folder}", made.summary())];
    if !agreement.agree {
        let (place, [a, b]) = (agreement.worst().place(), agreement.worst().means);
        console.warning(format_args!(
            "the estimators disagree, most in {place}: {a:.6e} and {b:.6e}; do not use this as \
             ground truth"
        ));
        return (lines, Exit::Validation);
    }
    lines.extend(agreement.smallest_bias.map(|bias| {
        let percent = 100.0 * bias;
        format!("a bias of {percent:.2} % of the film's mean would be detected with even odds")
    }));
    (lines, Exit::Done)
}

/// An error of a reference, with the remedy of the command.
impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let text = error.to_string();
        let (exit, hint) = match error {
            Error::File(error) => return error.into(),
            Error::Session(SessionError::NoPath { .. }) => return Self::usage(text),
            Error::Session(_) => (
                Exit::Scene,
                "make it smaller with --size, or render a part of it with --crop",
            ),
            Error::Disagree { .. } => (
                Exit::Validation,
                "take more samples with --extend, or another estimator with --against",
            ),
            Error::Unusable { fault, .. } => {
                let (exit, hint) = remedy(fault);
                return Self::new(exit, text).with_hint(hint);
            }
        };
        Self::new(exit, text).with_hint(hint)
    }
}

/// Returns the exit and the remedy for a fault.
fn remedy(fault: Fault) -> (Exit, String) {
    let (exit, hint) = match fault {
        Fault::Damaged => (
            Exit::InputOutput,
            "the `bidir reference` command that made it writes it again from its films",
        ),
        Fault::Missing => (
            Exit::InputOutput,
            "make one with `bidir reference`, or name another folder",
        ),
        Fault::Refused => (
            Exit::Validation,
            "make one again with `bidir reference`, in another folder or with --restart",
        ),
        Fault::TooLong(spp) => {
            let hint = format!("use --spp {spp}, or start over with --restart");
            return (Exit::FilmMismatch, hint);
        }
        Fault::OtherRender => (
            Exit::FilmMismatch,
            "name another folder with --output, or start over with --restart",
        ),
    };
    (exit, hint.to_owned())
}
