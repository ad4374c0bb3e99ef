//! Scenes of a description, with their references.

use super::super::error::{ExperimentError, Place};
use super::super::names::value_of;
use super::super::reader::{Entry, Section};
use super::super::{Absent, Lamp, ReferenceRecipe, ReferenceSpec, Room, SceneSource, SceneSpec};
use super::size;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use formats::scene::Files;
use std::path::{Component, Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// The keys of `[[scene]]`.
const SCENE: &str = "file room name size optional reference reference-of reference-spp \
    reference-strategies reference-cross-check";
/// Older names of keys of `[[scene]]`.
const OLD_SCENE: [&str; 1] = ["reference-witness"];
/// The keys of `room`.
const ROOM: &str = "light albedo triangles";
/// The largest number of triangles of a room.
const MOST_TRIANGLES: usize = 10_000_000;

/// Reads the scenes; returns the available ones, and the missing optional ones.
pub(super) fn all(
    top: &mut Section<'_>,
    folder: &Path,
    defaults: &Request,
    memory: &Files,
) -> Result<(Vec<SceneSpec>, Vec<Absent>)> {
    let read = |section: &mut Section<'_>| scene(section, folder, defaults, memory);
    let (mut there, mut absent) = (Vec::new(), Vec::new());
    for scene in super::all(top, "scene", |scene| &scene.name, read)? {
        match absence(&scene) {
            None => there.push(scene),
            Some(reason) => absent.push(Absent {
                name: scene.name,
                reason,
            }),
        }
    }
    Ok((there, absent))
}

/// Returns the reason why an optional scene is missing. None: it is available.
fn absence(scene: &SceneSpec) -> Option<String> {
    if !scene.optional {
        return None;
    }
    if let Some(variable) = variable(&scene.path) {
        return Some(format!("{variable} is not set"));
    }
    let is_there = scene.source != SceneSource::Disk || scene.path.is_file();
    (!is_there).then(|| format!("there is no file {}", scene.path.display()))
}

/// Returns the environment variable that a path begins with, as in `$BIDIR_SCENES/room.pbrt`.
fn variable(path: &Path) -> Option<&str> {
    let first = path.components().next()?;
    first.as_os_str().to_str()?.strip_prefix('$')
}

/// Returns the path of a file: relative to `folder`, with the value of the environment variable that it begins with. If
/// the variable is not set, the path still begins with it.
fn path(folder: &Path, file: &str) -> PathBuf {
    let path = Path::new(file);
    match variable(path).map(std::env::var_os) {
        None => joined(folder, path),
        Some(None) => path.to_owned(),
        Some(Some(value)) => {
            let below = path.components().skip(1).collect::<PathBuf>();
            joined(folder, &Path::new(&value).join(below))
        }
    }
}

fn scene(
    section: &mut Section<'_>,
    folder: &Path,
    defaults: &Request,
    memory: &Files,
) -> Result<SceneSpec> {
    section.only(SCENE, &OLD_SCENE)?;
    let optional = section.get("optional", Entry::truth)?.unwrap_or(false);
    let mut source = SceneSource::Disk;
    let (path, file_place) = if let Some(room) = section.nested("room", ROOM, room)? {
        source = SceneSource::Room(room);
        (room.name(), None)
    } else {
        let entry = section.need("file")?;
        let path = path(folder, entry.text()?);
        if let Some(name) = variable(&path).filter(|_| !optional) {
            return Err(entry.fault(format!("the environment variable {name} is not set")));
        }
        (path, Some(entry))
    };
    if memory.has_in_memory(&path) {
        source = SceneSource::Memory(memory.clone());
    }
    let file = match &file_place {
        Some(entry) => entry.text()?.to_owned(),
        None => path.display().to_string(),
    };
    let stem = Path::new(&file).file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy().into_owned();
    let name = section.text("name")?.unwrap_or(stem);
    let size = size(section)?;
    let (reference, reference_place) = reference(section, folder, defaults)?;
    Ok(SceneSpec {
        name,
        file,
        path,
        source,
        size,
        reference,
        optional,
        file_place: file_place.map(|entry| entry.at()),
        reference_place,
    })
}

/// Reads a generated room.
fn room(section: &mut Section<'_>) -> Result<Room> {
    let is_albedo = |albedo: &f64| *albedo > 0.0 && *albedo < 1.0;
    let light = section.need("light")?;
    let albedo = section.need("albedo")?;
    let triangles = section.need("triangles")?;
    Ok(Room {
        light: light.read(|name| value_of(&Lamp::NAMES, name))?,
        albedo: albedo.parsed("a number between 0 and 1", is_albedo)? as f32,
        triangles: triangles.up_to(MOST_TRIANGLES)?,
    })
}

/// Joins `folder` and `file`, and removes pairs such as `out/..`.
fn joined(folder: &Path, file: &Path) -> PathBuf {
    let mut path = PathBuf::new();
    for part in folder.join(file).components() {
        let is_detour = part == Component::ParentDir
            && matches!(path.components().next_back(), Some(Component::Normal(_)))
            // `..` after a link leads to the parent of its target.
            && !path.is_symlink();
        match part {
            _ if is_detour => {
                path.pop();
            }
            Component::CurDir => {}
            part => path.push(part),
        }
    }
    path
}

/// Reads the reference of a scene, and the place that names an existing one.
fn reference(
    section: &mut Section<'_>,
    folder: &Path,
    defaults: &Request,
) -> Result<(ReferenceSpec, Option<Place>)> {
    if let Some(entry) = section.take("reference-of") {
        let of = ReferenceSpec::Of(entry.text()?.to_owned());
        return Ok((of, Some(entry.at())));
    }
    let image = section.take("reference");
    let spp = section.take("reference-spp");
    let strategies = section.take("reference-strategies");
    let cross_check = section.take_renamed("reference-cross-check", "reference-witness")?;
    match (image, spp) {
        (Some(image), None) => {
            if let Some(entry) = strategies.or(cross_check) {
                let hint = "leave this out, or have the reference made with `reference-spp`";
                return Err(entry.fault_with("an existing reference cannot be changed", hint));
            }
            let existing = ReferenceSpec::Existing(folder.join(image.text()?));
            Ok((existing, Some(image.at())))
        }
        (None, Some(spp)) => {
            let recipe = ReferenceRecipe {
                spp: spp.whole(1)?,
                request: Box::new(reference_request(strategies, defaults)?),
                cross_check: cross_check.as_ref().map(cross_check_of).transpose()?,
            };
            Ok((ReferenceSpec::Make(recipe), None))
        }
        (Some(_), Some(spp)) => {
            Err(spp.fault("`reference` and `reference-spp` exclude each other"))
        }
        (None, None) => {
            Err(section.fault("`reference`, `reference-of` or `reference-spp` is missing"))
        }
    }
}

/// Reads the settings that the expectation of the reference depends on. All methods share them.
fn reference_request(strategies: Option<Entry<'_>>, defaults: &Request) -> Result<Request> {
    let mut request = Request {
        strategies: defaults.strategies.clone(),
        max_depth: defaults.max_depth,
        ..Request::default()
    };
    if let Some(entry) = strategies {
        entry.read(|value| request.set("strategies", value))?;
    }
    Ok(request)
}

/// Reads the integrator of the cross-check. Errors: it is the integrator of the reference.
fn cross_check_of(entry: &Entry<'_>) -> Result<IntegratorKind> {
    let mut request = Request::default();
    entry.read(|value| request.set("integrator", value))?;
    match request.integrator {
        Some(IntegratorKind::Bdpt | IntegratorKind::Auto) | None => {
            let hint = "references are made by `bdpt`: use path, light or lvc";
            Err(entry.fault_with("an estimator cannot cross-check itself", hint))
        }
        Some(other) => Ok(other),
    }
}
