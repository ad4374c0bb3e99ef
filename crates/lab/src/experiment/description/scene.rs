//! Scenes of a description, with their references.

use super::super::error::{ExperimentError, Place};
use super::super::names::value_of;
use super::super::reader::{Entry, Section};
use super::super::{
    Absent, Lamp, Presence, ReferenceRecipe, ReferenceSpec, Room, SceneSource, SceneSpec,
};
use super::{or, size, text_of};
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use formats::scene::Files;
use std::path::{Component, Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// The keys of `[[scene]]`.
const SCENE: [&str; 10] = [
    "file",
    "room",
    "name",
    "size",
    "optional",
    "reference",
    "reference-of",
    "reference-spp",
    "reference-strategies",
    "reference-cross-check",
];
/// Older names of keys of `[[scene]]`.
const OLD_SCENE: [&str; 1] = ["reference-witness"];
/// The keys of `room`.
const ROOM: [&str; 3] = ["light", "albedo", "triangles"];
/// The largest number of triangles of a room.
const MOST_TRIANGLES: usize = 10_000_000;

/// Reads the scenes; returns the available ones, and the missing optional ones.
pub(super) fn all(
    top: &mut Section<'_>,
    folder: &Path,
    defaults: &Request,
    memory: &Files,
) -> Result<(Vec<SceneSpec>, Vec<Absent>)> {
    let read = |section: &mut Section<'_>| {
        let mut scene = scene(section, folder, defaults)?;
        if memory.has_in_memory(&scene.path) {
            scene.source = SceneSource::Memory(memory.clone());
        }
        Ok(scene)
    };
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
    if scene.presence == Presence::Required {
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

/// Replaces the environment variable of a path by its value, if it is set.
fn with_variable(file: &str) -> PathBuf {
    let path = Path::new(file);
    match variable(path).and_then(std::env::var_os) {
        Some(value) => Path::new(&value).join(path.components().skip(1).collect::<PathBuf>()),
        None => path.to_owned(),
    }
}

/// The origin of a scene.
struct Source {
    /// The file, as messages and results name it.
    file: String,
    path: PathBuf,
    files: SceneSource,
    /// The place in the description that names the file. None: it is a room.
    place: Option<Place>,
}

impl Source {
    fn room(entry: Entry<'_>) -> Result<Self> {
        let room = room_of(entry)?;
        Ok(Self {
            file: room.name().display().to_string(),
            path: room.name(),
            files: SceneSource::Room(room),
            place: None,
        })
    }

    fn file(entry: &Entry<'_>, folder: &Path, presence: Presence) -> Result<Self> {
        let file = entry.text()?.to_owned();
        let path = with_variable(&file);
        let path = match (variable(&path), presence) {
            (None, _) => joined(folder, &path),
            (Some(_), Presence::Optional) => path,
            (Some(name), Presence::Required) => {
                return Err(entry.fault(format!("the environment variable {name} is not set")));
            }
        };
        Ok(Self {
            file,
            path,
            files: SceneSource::Disk,
            place: Some(entry.at()),
        })
    }
}

fn scene(section: &mut Section<'_>, folder: &Path, defaults: &Request) -> Result<SceneSpec> {
    section.only(&SCENE, &OLD_SCENE)?;
    let optional = section.take("optional");
    let presence = match optional.map(|entry| entry.truth()).transpose()? {
        Some(true) => Presence::Optional,
        _ => Presence::Required,
    };
    let source = match section.take("room") {
        Some(room) => Source::room(room)?,
        None => Source::file(&section.need("file")?, folder, presence)?,
    };
    let stem = Path::new(&source.file).file_stem().unwrap_or_default();
    let name = or(text_of(section, "name")?, &stem.to_string_lossy());
    let size = size(section)?;
    let (reference, at) = reference(section, folder, defaults)?;
    Ok(SceneSpec {
        name,
        path: source.path,
        source: source.files,
        size,
        reference,
        file: source.file,
        presence,
        file_place: source.place,
        reference_place: at,
    })
}

/// Reads a generated room.
fn room_of(entry: Entry<'_>) -> Result<Room> {
    let mut section = entry.section()?;
    section.only(&ROOM, &[])?;
    let light = section.need("light")?;
    let albedo = section.need("albedo")?;
    let is_albedo = |albedo: &f64| *albedo > 0.0 && *albedo < 1.0;
    let value = Some(albedo.number()?).filter(is_albedo);
    let count = section.need("triangles")?;
    let triangles = count.written()?.parse().ok();
    let triangles = triangles.filter(|count| (1..=MOST_TRIANGLES).contains(count));
    Ok(Room {
        light: light.read(|name| value_of(&Lamp::NAMES, name))?,
        albedo: value.ok_or_else(|| albedo.fault("expected a number between 0 and 1"))? as f32,
        triangles: triangles.ok_or_else(|| {
            count.fault(format!(
                "expected a whole number from 1 to {MOST_TRIANGLES}"
            ))
        })?,
    })
}

/// Joins `folder` and `file`, without detours such as `out/..`.
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
        return Ok((
            ReferenceSpec::Of(entry.text()?.to_owned()),
            Some(entry.at()),
        ));
    }
    let image = section.take("reference");
    let spp = section.take("reference-spp");
    let strategies = section.take("reference-strategies");
    let cross_check = section.take_renamed("reference-cross-check", "reference-witness")?;
    match (image, spp) {
        (Some(image), None) => {
            if let Some(entry) = strategies.or(cross_check) {
                return Err(entry.fault_with(
                    "an existing reference cannot be changed".to_owned(),
                    "leave this out, or have the reference made with `reference-spp`".to_owned(),
                ));
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

/// Reads the settings that the expectation of the reference depends on; they are those of all methods.
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

/// Reads the integrator of the cross-check, which is not that of the reference.
fn cross_check_of(entry: &Entry<'_>) -> Result<IntegratorKind> {
    let mut request = Request::default();
    entry.read(|value| request.set("integrator", value))?;
    match request.integrator {
        Some(IntegratorKind::Bdpt | IntegratorKind::Auto) | None => Err(entry.fault_with(
            "an estimator cannot cross-check itself".to_owned(),
            "references are made by `bdpt`: use path, light or lvc".to_owned(),
        )),
        Some(other) => Ok(other),
    }
}
