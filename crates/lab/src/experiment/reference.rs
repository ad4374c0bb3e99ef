//! References of an experiment: existing images, or references rendered once and kept.

use super::error::{ExperimentError, Place};
use super::loaded_scene::{LoadedScene, Reference};
use super::names::file_name;
use super::observer::{Event, Host, Observer};
use super::run::write_image;
use super::run_set::{RunSet, Setup};
use super::settings::texts;
use super::{Absent, Experiment, ReferenceRecipe, ReferenceSpec};
use crate::image::Pixels;
use crate::reference::{self as references, Job, PICTURE, Plan, Provenance};
use crate::seal::sha256;
use bidir::ESTIMATOR_VERSION;
use bidir::driver::Resources;
use bidir::integrator::IntegratorKind;
use bidir::path::{MisHeuristic, Strategies};
use std::path::{Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// Reads the existing reference of a scene. None: the description names none.
///
/// Errors: it cannot be read, is damaged or stale, its estimators disagree, it belongs to another scene or
/// has another size, or its pixels are not finite.
pub(super) fn given(loaded: &LoadedScene<'_>) -> Result<Option<Reference>> {
    match &loaded.spec.reference {
        ReferenceSpec::Existing(path) if path.is_dir() => load(loaded, path, None).map(Some),
        ReferenceSpec::Existing(path) => read(path, loaded).map(Some),
        ReferenceSpec::Make(_) | ReferenceSpec::Of(_) => Ok(None),
    }
}

/// Obtains the references of all scenes; `given` holds the existing ones. Leaves out optional scenes whose
/// estimators disagree, with a warning. None: the observer stopped it.
///
/// Errors: as [`obtain`]; no scene is left.
pub(super) fn obtain_all<'a>(
    experiment: &'a Experiment,
    scenes: Vec<LoadedScene<'a>>,
    given: Vec<Option<Reference>>,
    setup: &'a Setup,
    observer: &mut dyn Observer,
) -> Result<Option<RunSet<'a>>> {
    let mut ready = RunSet {
        experiment,
        setup,
        scenes: Vec::new(),
        references: Vec::new(),
        absent: experiment.absent.clone(),
    };
    for (loaded, given) in scenes.into_iter().zip(given) {
        match obtain(&loaded, given, &ready, observer) {
            Ok(None) => return Ok(None),
            Ok(Some(reference)) => {
                ready.scenes.push(loaded);
                ready.references.push(reference);
            }
            Err(error) if error.is_disagreement() && loaded.spec.optional => {
                let scene = Absent {
                    name: loaded.spec.name.clone(),
                    reason: error.to_string(),
                };
                scene.warn(observer);
                ready.absent.push(scene);
            }
            Err(error) => return Err(error),
        }
    }
    match (&ready.scenes[..], ready.absent.last()) {
        ([], Some(absent)) => Err(ExperimentError::NoScenes(absent.reason.clone())),
        _ => Ok(Some(ready)),
    }
}

/// Obtains the reference of a scene: copies the image of the [`given`] one into the folder of the results, takes that
/// of a scene before it, which is `ready`, or renders a new one. None: the observer stopped it.
///
/// Errors: it cannot be rendered, or its estimators disagree; the folder of such a reference stays.
fn obtain(
    loaded: &LoadedScene<'_>,
    given: Option<Reference>,
    ready: &RunSet<'_>,
    observer: &mut dyn Observer,
) -> Result<Option<Reference>> {
    match (&loaded.spec.reference, given) {
        (ReferenceSpec::Make(recipe), _) => make(loaded, &plan(loaded, recipe), ready, observer),
        (_, Some(reference)) => {
            // The folder of the results holds everything that a report shows.
            let name = copy(loaded);
            write_image(&ready.setup.folder.join(&name), &reference.pixels)?;
            let image = Some(name);
            Ok(Some(Reference { image, ..reference }))
        }
        (spec, None) => {
            let mut scenes = ready.scenes.iter().zip(&ready.references);
            let found = scenes.find(|(other, _)| {
                *spec == ReferenceSpec::Of(other.spec.name.clone()) && other.size() == loaded.size()
            });
            let (_, reference) =
                found.ok_or_else(|| ExperimentError::NoReference(loaded.spec.name.clone()))?;
            Ok(Some(reference.clone()))
        }
    }
}

/// Returns the name of the copied image of an existing reference, in the folder of the results.
fn copy(loaded: &LoadedScene<'_>) -> String {
    format!("references/{}.exr", file_name(&loaded.spec.name))
}

/// Returns the files written for the reference of a scene.
pub(super) fn written(loaded: &LoadedScene<'_>, setup: &Setup) -> Vec<PathBuf> {
    match &loaded.spec.reference {
        ReferenceSpec::Existing(_) => vec![setup.folder.join(copy(loaded))],
        ReferenceSpec::Of(_) => Vec::new(),
        ReferenceSpec::Make(recipe) => {
            let folder = folder(loaded, &plan(loaded, recipe));
            references::files(&setup.folder.join(folder))
        }
    }
}

/// Reads an existing reference; `name` is its folder within the folder of the results. None: it is elsewhere.
fn load(loaded: &LoadedScene<'_>, folder: &Path, name: Option<&str>) -> Result<Reference> {
    let provenance = Provenance::load(folder).map_err(|error| failed(loaded, error))?;
    let checked = provenance.check(&loaded.subject);
    checked.map_err(|error| failed(loaded, error))?;
    Ok(Reference {
        words: provenance.summary(),
        image: name.map(|name| format!("{name}/{PICTURE}")),
        ..read(&folder.join(PICTURE), loaded)?
    })
}

fn failed(loaded: &LoadedScene<'_>, error: references::Error) -> ExperimentError {
    ExperimentError::Reference {
        scene: loaded.spec.name.clone(),
        error,
    }
}

/// Reads an image.
///
/// Errors: its size is not that of the scene; a pixel is not finite, so that errors against it would not be either.
fn read(path: &Path, loaded: &LoadedScene<'_>) -> Result<Reference> {
    let image = formats::image::read(path, None);
    let place = loaded.spec.reference_place.as_ref();
    let pixels = Pixels::from(&image.map_err(|error| Place::of_named(place, error))?);
    if let Some((text, hint)) = fault(&pixels, loaded.size()) {
        return Err(ExperimentError::Image {
            path: path.to_owned(),
            scene: loaded.spec.name.clone(),
            text,
            hint,
        });
    }
    Ok(Reference {
        pixels,
        words: format!("the image {}", path.display()),
        image: None,
        mse: stored_mse(path),
    })
}

/// Returns the fault of an image for a scene of this size, and a remedy. None: it has no fault.
fn fault(pixels: &Pixels, size: [usize; 2]) -> Option<(String, &'static str)> {
    let [width, height] = pixels.size;
    if pixels.size != size {
        let text = format!(
            "{width} x {height} pixels, its images have {} x {}",
            size[0], size[1]
        );
        return Some((text, "give the scene the size of its reference"));
    }
    let is_bad = |pixel: &[f32; 3]| !pixel.iter().all(|channel| channel.is_finite());
    let first = pixels.data.iter().position(is_bad)?;
    let count = pixels.data.iter().filter(|pixel| is_bad(pixel)).count();
    let [x, y] = [first % width, first / width];
    let text = format!("{count} pixels that are not finite, the first at {x},{y}");
    Some((text, "render it again, or give these pixels a colour"))
}

/// Computes the mean square error of an image from its variance layer. None: it has no such layer.
fn stored_mse(path: &Path) -> Option<f64> {
    let layers = formats::image::read_layers(path).ok()?;
    let mse = Pixels::layer(&layers, "Variance.")?.mean()?;
    mse.is_finite().then_some(mse)
}

/// Plans the two estimators of a reference. With all strategies, path tracing is the default cross-check.
/// Without some, `bdpt` may miss paths that path tracing samples, so the default cross-check is `bdpt` with
/// the same strategies and other weights: those of the power heuristic. Uniform weights would differ more,
/// but their variance is infinite near edges, and the skewed mean would fail the test more often than its
/// level.
fn plan(loaded: &LoadedScene<'_>, recipe: &ReferenceRecipe) -> Plan {
    let (mut picture, mut cross_check) = ((*recipe.request).clone(), (*recipe.request).clone());
    let strategies = recipe.request.strategies.clone();
    cross_check.integrator = recipe.cross_check;
    if recipe.cross_check.is_none() && strategies.unwrap_or_default() != Strategies::default() {
        cross_check.integrator = Some(IntegratorKind::Bdpt);
        picture.mis = Some(MisHeuristic::Balance);
        cross_check.mis = Some(MisHeuristic::Power);
    }
    Plan::new(&loaded.settings, recipe.spp, [&picture, &cross_check])
}

/// Returns the folder of a reference within the folder of the results. Its name contains a hash of the plan.
fn folder(loaded: &LoadedScene<'_>, plan: &Plan) -> String {
    let settings = plan.estimators.each_ref().map(texts);
    let [width, height] = loaded.size();
    let identity = format!(
        "{ESTIMATOR_VERSION} {} {width}x{height} {} {settings:?}",
        loaded.subject.digest, plan.spp
    );
    let hash = sha256(identity.as_bytes());
    format!(
        "references/{}-{}",
        file_name(&loaded.spec.name),
        &hash[..12]
    )
}

fn make(
    loaded: &LoadedScene<'_>,
    plan: &Plan,
    ready: &RunSet<'_>,
    observer: &mut dyn Observer,
) -> Result<Option<Reference>> {
    let name = folder(loaded, plan);
    let path = ready.setup.folder.join(&name);
    if let Ok(reference) = load(loaded, &path, Some(&name)) {
        return Ok(Some(reference));
    }
    let resources = Resources {
        threads: ready.experiment.threads,
        ..Resources::default()
    };
    let (scene, of) = (&*loaded.spec.name, 2 * plan.rounded_spp());
    let event = |passes| (passes < of).then_some(Event::Reference { scene, passes, of });
    let area = loaded.subject.view.film().crop.area();
    let job = Job {
        folder: &path,
        subject: &loaded.subject,
        plan,
        resources: &resources,
        host: &Host::telling(observer, area, &event),
    };
    let made = job.make().map_err(|error| failed(loaded, error))?;
    made.map(|_| load(loaded, &path, Some(&name))).transpose()
}
