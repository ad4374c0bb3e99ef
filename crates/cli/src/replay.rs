//! `bidir render --replay`: repeats one sample, and prints every step.

use crate::args::{RenderArgs, ReplayTarget};
use crate::console::{print, print_json, say};
use crate::exit::{Exit, Failure};
use crate::output;
use crate::scene_io;
use crate::signals::Signals;
use bidir::driver::Session;
use lab::sample::SampleReport;
use std::path::PathBuf;

/// Checks, before the scene is read, that the drawing can be written.
pub(crate) fn check(args: &RenderArgs) -> Result<(), Failure> {
    let Some(path) = &args.svg else {
        return Ok(());
    };
    let ending = path.extension().unwrap_or_default();
    if !ending.eq_ignore_ascii_case("svg") {
        let message = format!("cannot write `{}`: drawings are .svg", path.display());
        return Err(Failure::usage(message).with_hint("name it NAME.svg"));
    }
    output::check_file("--svg", path)
}

/// Checks that the drawing replaces none of `inputs`.
pub(crate) fn check_apart(args: &RenderArgs, inputs: &[PathBuf]) -> Result<(), Failure> {
    let drawing = args.svg.as_deref().map(|path| ("--svg", path));
    scene_io::check_apart(inputs, drawing.as_slice())
}

/// Repeats a sample and prints its report, unless a signal interrupts it.
pub(crate) fn run(
    args: &RenderArgs,
    session: Session<'static>,
    target: ReplayTarget,
    signals: &Signals,
) -> Result<Exit, Failure> {
    let repeat = move || (session.replay(target.pixel, target.pass), session);
    let Some((replay, session)) = signals.wait_for(repeat, || ()) else {
        return Ok(signals.ended());
    };
    let replay = replay.ok_or_else(|| {
        let [x, y] = target.pixel;
        let crop = session.view().film().crop;
        let ([x0, y0], [x1, y1]) = (crop.min, crop.max);
        let hint =
            format!("the render has the pixels from {x0},{y0} up to, not including, {x1},{y1}");
        Failure::usage(format!("the pixel {x},{y} is not rendered")).with_hint(hint)
    })?;
    let report = SampleReport::new(&session, target.pixel, target.pass, &replay);
    let printed = if args.json {
        print_json(&report)
    } else {
        print(&report.to_string())
    };
    let Some(path) = &args.svg else {
        return printed;
    };
    let name = args.scene.scene.display().to_string();
    formats::file::replace(path, report.drawing(&session, &name).as_bytes())?;
    if !args.output.talk.quiet {
        say(format_args!("wrote {}", path.display()));
    }
    printed
}
