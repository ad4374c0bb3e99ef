//! `bidir render --replay`: one sample again, told step by step.

use crate::args::{RenderArgs, ReplayTarget};
use crate::console::{print, print_json};
use crate::exit::{Exit, Failure};
use bidir::driver::Session;
use bidir::scene::Scene;
use lab::sample::SampleReport;

/// Repeats a sample and prints what it did.
pub(crate) fn run(
    args: &RenderArgs,
    scene: &Scene,
    session: &Session<'_>,
    target: ReplayTarget,
) -> Result<Exit, Failure> {
    let replay = session.replay(target.pixel, target.pass).ok_or_else(|| {
        let [x, y] = target.pixel;
        let crop = scene.film().crop;
        let ([x0, y0], [x1, y1]) = (crop.min, crop.max);
        let hint =
            format!("the render has the pixels from {x0},{y0} up to, not including, {x1},{y1}");
        Failure::usage(format!("the pixel {x},{y} is not rendered")).with_hint(hint)
    })?;
    let report = SampleReport::new(session, target.pixel, target.pass, &replay);
    if args.json {
        print_json(&report)
    } else {
        print(&report.to_string())
    }
}
