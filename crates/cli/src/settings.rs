//! Combines the settings of a render from flags, environment and scene. `clap` gives flags precedence over the
//! environment; this module gives both precedence over the scene.

use crate::args::{BudgetArgs, LongArgs, Part, RenderArgs};
use crate::console::Console;
use crate::exit::Failure;
use crate::scene_io::Loaded;
use bidir::analysis::{BlindSpot, LostLight, lost_light, missing_light};
use bidir::driver::{Budget, Settings};
use bidir::path::MAX_VERTICES;
use formats::scene::Lamp;
use std::ops::Range;

/// Warns of flags and variables that have no effect on this render. Returns the number of warnings.
pub(crate) fn warn_unused(args: &RenderArgs, settings: &Settings, console: Console) -> usize {
    let integrator = format!("on the integrator `{}`", settings.integrator);
    let spp = args.budget.spp.filter(|_| args.long.passes.is_some());
    let names = args.estimator.ignored(settings).into_iter();
    let ignored = names.map(|name| (name, &*integrator));
    ignored
        .chain(spp.map(|_| ("spp".to_owned(), "where --passes is given")))
        .map(|(name, on)| {
            let is_variable = args.of_variables.contains(&name);
            let source = if is_variable {
                format!("BIDIR_{}", name.replace('-', "_").to_uppercase())
            } else {
                format!("--{name}")
            };
            console.warning(format_args!("{source} has no effect {on}"));
        })
        .count()
}

/// Warns of light that the estimator loses, or the list of strategies, which `flag` gives. Returns the number of
/// warnings.
///
/// Errors: the list makes no path, so that the image would be black.
pub(crate) fn check_light(
    flag: &str,
    loaded: &Loaded,
    settings: &Settings,
    console: Console,
) -> Result<usize, Failure> {
    let lost = check_strategies(flag, loaded, settings, console)?;
    Ok(lost + warn_missing(loaded, settings, console))
}

/// Warns of light that the list of strategies loses.
fn check_strategies(
    flag: &str,
    loaded: &Loaded,
    settings: &Settings,
    console: Console,
) -> Result<usize, Failure> {
    let path = &settings.path;
    let Some(lost) = lost_light(&loaded.scene, &loaded.view, settings.integrator, path) else {
        return Ok(0);
    };
    let message = format!("{flag} {} {lost}", path.strategies);
    match lost {
        LostLight::All { max_vertices } => {
            let hint = match max_vertices {
                Some(most) if most < MAX_VERTICES => format!(
                    "raise --max-depth: paths of {} bounces have {most} vertices, and no path has more \
                     than {MAX_VERTICES}",
                    most - 2
                ),
                Some(_) => "no path has more vertices".to_owned(),
                None => {
                    "strategy sNtM has N light vertices and M camera vertices: M is at least 1, \
                         N + M at least 2"
                        .to_owned()
                }
            };
            Err(Failure::usage(message).with_hint(hint))
        }
        LostLight::Lengths(_) | LostLight::Specular(_) => {
            console.warning(message);
            Ok(1)
        }
    }
}

/// Warns of light that all strategies of the estimator miss, and names its lamps. Returns the number of
/// warnings.
fn warn_missing(loaded: &Loaded, settings: &Settings, console: Console) -> usize {
    let integrator = settings.integrator;
    let missing = missing_light(&loaded.scene, &loaded.view, integrator, &settings.path);
    for &spot in &missing {
        let (paths, remedy) = (spot.description(), spot.remedy());
        let lamps = lamps(loaded, spot);
        console.warning(format_args!(
            "`{integrator}` misses {paths}{lamps}; {remedy}"
        ));
    }
    missing.len()
}

/// Returns the end of a clause that names the lamps whose light is missing: the place of the first lamp, and
/// the number of the others. Empty if the light of every lamp is missing.
fn lamps(loaded: &Loaded, spot: BlindSpot) -> String {
    let lights = loaded.scene.lights();
    let is_concerned = |lamp: &&Lamp| spot.concerns(&lights[lamp.light as usize]);
    let first = loaded.lamps.iter().find(is_concerned);
    let Some(first) = first.filter(|_| spot != BlindSpot::SeenBySpecular) else {
        return String::new();
    };
    let kind = lights[first.light as usize].kind();
    let count = lights.iter().filter(|light| spot.concerns(light)).count();
    let others = match count - 1 {
        0 => String::new(),
        1 => " and another light".to_owned(),
        others => format!(" and {others} other lights"),
    };
    format!(", here of the {kind} light at {}{others}", first.place)
}

/// Returns the budget of a render; `scene` is the scene's number of samples per pixel.
///
/// Errors: a part has no passes.
pub(crate) fn budget(args: &BudgetArgs, long: &LongArgs, scene: u64) -> Result<Budget, Failure> {
    let (time, noise) = (args.time, args.noise);
    let is_open = time.is_some() || noise.is_some();
    let all = args.spp.or((!is_open).then_some(scene));
    let part = match (&long.passes, long.part) {
        (Some(range), _) => Some(range.clone()),
        (None, Some(part)) => Some(passes_of(part, all.unwrap_or(scene))?),
        (None, None) => None,
    };
    Ok(Budget {
        first: part.as_ref().map_or(0, |range| range.start),
        passes: part.map_or(all, |range| Some(range.end - range.start)),
        time,
        noise,
    })
}

/// Returns the passes of a part.
fn passes_of(part: Part, passes: u64) -> Result<Range<u64>, Failure> {
    let range = part.range(passes);
    if !range.is_empty() {
        return Ok(range);
    }
    let Part { index, of } = part;
    let message = format!("part {index} of {of} has no passes: there are {passes} in all");
    Err(Failure::usage(message).with_hint("use fewer parts, or more passes with --spp"))
}
