//! From TOML to an [`Experiment`].

use super::error::{ExperimentError, Place};
use super::names::file_name;
use super::reader::{Entry, Section, Source};
use super::settings::{names, no_effect};
use super::{BudgetSpec, Experiment, MethodSpec, PyramidSpec, ReferenceSpec, SceneSpec, Seeds};
use crate::metric::Metric;
use crate::results::BudgetKind;
use bidir::driver::{Settings, Threads};
use bidir::integrator::IntegratorKind;
use bidir::names::{UnknownName, nearest};
use bidir::settings::Request;
use std::path::{Component, Path, PathBuf};

type Result<T> = std::result::Result<T, ExperimentError>;

/// Where no number of seeds is given.
const SEEDS: u64 = 10;
/// The keys of the whole description.
const TOP: [&str; 13] = [
    "title",
    "description",
    "seeds",
    "first-seed",
    "size",
    "threads",
    "metrics",
    "pyramid",
    "pyramid-spp",
    "settings",
    "scene",
    "method",
    "budget",
];
/// The keys of `[[scene]]`, and those that are accepted for old descriptions.
const SCENE: [&str; 7] = [
    "file",
    "name",
    "size",
    "reference",
    "reference-spp",
    "reference-strategies",
    "reference-cross-check",
];
const OLD_SCENE: [&str; 1] = ["reference-witness"];
/// How to mend a setting without effect on an integrator that another table sets.
const INHERITED: &str =
    "[settings] sets this integrator: give the method its own, or leave the setting out";
/// The keys of `[[budget]]`.
const BUDGET: [&str; 4] = ["name", "samples", "rays", "seconds"];
/// Settings that are accepted for old descriptions.
const OLD_SETTINGS: [&str; 1] = ["emission"];
/// Samples per pixel of images of strategies, where no number is given.
const PYRAMID_SPP: u64 = 64;

impl Experiment {
    /// Reads a description; `file` is what messages call it, and its scenes are relative to its folder.
    ///
    /// Errors: [`ExperimentError::Description`], with line and column.
    pub fn read(text: &str, file: &Path) -> Result<Self> {
        let mut top = Source { file, text }.parse()?;
        top.only(&TOP, &[])?;
        let mut defaults = Request::default();
        for (i, mut section) in top.sections("settings")?.into_iter().enumerate() {
            if i > 0 {
                return Err(section.fault("there is a second [settings]"));
            }
            section.only(&borrowed(&names()), &OLD_SETTINGS)?;
            defaults = changes(&mut section, None)?;
        }
        let folder = formats::file::folder_of(file);
        let scene = |section: &mut Section<'_>| scene(section, folder, &defaults);
        let method = |section: &mut Section<'_>| method(section, &defaults);
        let shown = [top.take("pyramid"), top.take("pyramid-spp")];
        let mut experiment = Self {
            title: or(text_of(&mut top, "title")?, "Experiment"),
            description: or(text_of(&mut top, "description")?, ""),
            size: size(&mut top)?,
            seeds: seeds(&mut top)?,
            threads: threads(&mut top)?,
            metrics: metrics(&mut top)?,
            scenes: all(&mut top, "scene", scene)?,
            methods: all(&mut top, "method", method)?,
            budgets: all(&mut top, "budget", budget)?,
            pyramid: None,
        };
        experiment.pyramid = pyramid(shown, &experiment.methods)?;
        Ok(experiment)
    }
}

/// The method whose strategies are shown, and with how many samples.
fn pyramid(
    [method, spp]: [Option<Entry<'_>>; 2],
    methods: &[MethodSpec],
) -> Result<Option<PyramidSpec>> {
    let Some(entry) = method else {
        let fault = |spp: Entry<'_>| spp.fault("`pyramid-spp` needs `pyramid`");
        return spp.map_or(Ok(None), |spp| Err(fault(spp)));
    };
    let name = entry.text()?;
    let Some(method) = methods.iter().find(|method| method.name == name) else {
        let names = methods.iter().map(|method| method.name.as_str());
        let hint = match nearest(name, names.clone()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("methods are {}", names.collect::<Vec<_>>().join(", ")),
        };
        return Err(entry.fault_with(format!("there is no method `{name}`"), hint));
    };
    let integrator = method.changes.integrator;
    if integrator.is_some_and(|integrator| integrator != IntegratorKind::Bdpt) {
        let message = format!("the method `{name}` is not bidirectional");
        let hint = "strategies (s, t) are those of a method whose integrator is \"bdpt\"";
        return Err(entry.fault_with(message, hint.to_owned()));
    }
    Ok(Some(PyramidSpec {
        method: name.to_owned(),
        spp: spp.map_or(Ok(PYRAMID_SPP), |spp| spp.whole(2))?,
    }))
}

fn or(text: Option<String>, default: &str) -> String {
    text.unwrap_or_else(|| default.to_owned())
}

fn text_of(section: &mut Section<'_>, key: &'static str) -> Result<Option<String>> {
    let entry = section.take(key);
    let text = entry.map(|entry| entry.text().map(|text| text.trim().to_owned()));
    text.transpose()
}

fn whole(section: &mut Section<'_>, key: &'static str, least: u64) -> Result<Option<u64>> {
    let entry = section.take(key);
    entry.map(|entry| entry.whole(least)).transpose()
}

/// The threads of each render. 0: nothing is said of them.
fn threads(top: &mut Section<'_>) -> Result<usize> {
    let Some(entry) = top.take("threads") else {
        return Ok(0);
    };
    let count = entry.whole(1).map(|count| count as usize).ok();
    let most = Threads::MOST;
    count
        .filter(|count| *count <= most)
        .ok_or_else(|| entry.fault(format!("expected a whole number from 1 to {most}")))
}

/// Width and height, written `64x48`.
fn size(section: &mut Section<'_>) -> Result<Option<[u32; 2]>> {
    let read = |text: &str| {
        let sides = text.split_once(['x', 'X']);
        let side = |side: &str| side.trim().parse().ok().filter(|side| *side > 0);
        let size = sides.and_then(|(width, height)| Some([side(width)?, side(height)?]));
        size.ok_or_else(|| "expected WIDTHxHEIGHT, such as 320x240".to_owned())
    };
    let entry = section.take("size");
    entry.map(|entry| entry.read(read)).transpose()
}

fn seeds(top: &mut Section<'_>) -> Result<Seeds> {
    Ok(Seeds {
        first: whole(top, "first-seed", 0)?.unwrap_or(0),
        count: whole(top, "seeds", 1)?.unwrap_or(SEEDS),
    })
}

/// The metrics beside `rmse`, which there always is.
fn metrics(top: &mut Section<'_>) -> Result<Vec<Metric>> {
    let Some(entry) = top.take("metrics") else {
        return Ok(vec![Metric::Relmse, Metric::RelmseTrimmed]);
    };
    let mut metrics = Vec::new();
    for entry in entry.texts()? {
        let metric = entry.read(metric)?;
        if metric != Metric::Rmse && !metrics.contains(&metric) {
            metrics.push(metric);
        }
    }
    Ok(metrics)
}

/// The metric of a name.
fn metric(given: &str) -> std::result::Result<Metric, UnknownName> {
    let mut names = Metric::NAMES.iter();
    let found = names.find(|(name, _)| *name == given);
    let known = Metric::NAMES.map(|(name, _)| name);
    found
        .map(|(_, metric)| *metric)
        .ok_or_else(|| UnknownName::new(given, &known))
}

/// What all tables `[[key]]` say, of which there is one at least; names differ also in files.
fn all<'a, T: Named>(
    top: &mut Section<'a>,
    key: &'static str,
    mut read: impl FnMut(&mut Section<'a>) -> Result<T>,
) -> Result<Vec<T>> {
    let mut all: Vec<T> = Vec::new();
    for mut section in top.sections(key)? {
        let one = read(&mut section)?;
        let name = file_name(one.name());
        if name.is_empty() {
            return Err(section.fault("a name needs a letter or a digit"));
        }
        if all.iter().any(|other| file_name(other.name()) == name) {
            let message = format!("there is another {key} `{}`", one.name());
            return Err(section.fault(message));
        }
        all.push(one);
    }
    if all.is_empty() {
        return Err(top.fault(format!("there is no [[{key}]]")));
    }
    Ok(all)
}

/// What has a name.
trait Named {
    fn name(&self) -> &str;
}

impl Named for SceneSpec {
    fn name(&self) -> &str {
        &self.name
    }
}

impl Named for MethodSpec {
    fn name(&self) -> &str {
        &self.name
    }
}

impl Named for BudgetSpec {
    fn name(&self) -> &str {
        &self.name
    }
}

/// The settings of a table, under the names of flags; `inherited` is the integrator of `[settings]`.
///
/// Errors: a setting without effect on the integrator.
fn changes(section: &mut Section<'_>, inherited: Option<IntegratorKind>) -> Result<Request> {
    let mut changes = Request::default();
    let mut entries = Vec::new();
    for name in names() {
        let entry = match &*name {
            "light-start" => section.take_renamed(&name, "emission")?,
            _ => section.take(&name),
        };
        if let Some(entry) = entry {
            entry.read(|value| changes.set(&name, value))?;
            entries.push((name, entry));
        }
    }
    let Some(integrator) = changes.integrator.or(inherited) else {
        return Ok(changes);
    };
    let ignored = changes.ignored(&Settings::new(integrator));
    match entries.iter().find(|(name, _)| ignored.contains(name)) {
        None => Ok(changes),
        Some((name, entry)) => {
            let hint = changes.integrator.is_none().then_some(INHERITED);
            Err(entry.fault_hinted(no_effect(name, integrator), hint))
        }
    }
}

fn method(section: &mut Section<'_>, defaults: &Request) -> Result<MethodSpec> {
    let names = names();
    let known = ["name"].into_iter().chain(borrowed(&names));
    section.only(&known.collect::<Vec<_>>(), &OLD_SETTINGS)?;
    Ok(MethodSpec {
        name: section.need("name")?.text()?.to_owned(),
        changes: changes(section, defaults.integrator)?.over(defaults),
    })
}

fn borrowed(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

fn scene(section: &mut Section<'_>, folder: &Path, defaults: &Request) -> Result<SceneSpec> {
    section.only(&SCENE, &OLD_SCENE)?;
    let named = section.need("file")?;
    let file = named.text()?.to_owned();
    let stem = Path::new(&file).file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy();
    let name = or(text_of(section, "name")?, &stem);
    let size = size(section)?;
    let (reference, place) = reference(section, folder, defaults)?;
    Ok(SceneSpec {
        name,
        path: joined(folder, &file),
        size,
        reference,
        file,
        places: [Some(named.at()), place],
    })
}

/// A file relative to `folder`, without detours such as `out/..`.
fn joined(folder: &Path, file: &str) -> PathBuf {
    let mut path = PathBuf::new();
    for part in folder.join(file).components() {
        let is_detour = part == Component::ParentDir
            && matches!(path.components().next_back(), Some(Component::Normal(_)))
            // The folder above the target of a link is another one.
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

/// A reference that is there, with the place of its name, or how many samples the one that is made has.
fn reference(
    section: &mut Section<'_>,
    folder: &Path,
    defaults: &Request,
) -> Result<(ReferenceSpec, Option<Place>)> {
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
            let there = ReferenceSpec::There(folder.join(image.text()?));
            Ok((there, Some(image.at())))
        }
        (None, Some(spp)) => {
            let made = ReferenceSpec::Make {
                spp: spp.whole(1)?,
                changes: Box::new(reference_changes(strategies, defaults)?),
                witness: cross_check.as_ref().map(cross_check_of).transpose()?,
            };
            Ok((made, None))
        }
        (Some(_), Some(spp)) => {
            Err(spp.fault("`reference` and `reference-spp` exclude each other"))
        }
        (None, None) => Err(section.fault("`reference` or `reference-spp` is missing")),
    }
}

/// What decides the expectation of the images is that of all methods.
fn reference_changes(strategies: Option<Entry<'_>>, defaults: &Request) -> Result<Request> {
    let mut changes = Request {
        strategies: defaults.strategies.clone(),
        max_depth: defaults.max_depth,
        ..Request::default()
    };
    if let Some(entry) = strategies {
        entry.read(|value| {
            changes
                .set("strategies", value)
                .map_err(|error| error.to_string())
        })?;
    }
    Ok(changes)
}

/// An estimator that can contradict that of the picture.
fn cross_check_of(entry: &Entry<'_>) -> Result<IntegratorKind> {
    let mut changes = Request::default();
    entry.read(|value| {
        changes
            .set("integrator", value)
            .map_err(|error| error.to_string())
    })?;
    match changes.integrator {
        Some(IntegratorKind::Bdpt | IntegratorKind::Auto) | None => Err(entry.fault_with(
            "an estimator cannot cross-check itself".to_owned(),
            "references are made by `bdpt`: use path, light or lvc".to_owned(),
        )),
        Some(witness) => Ok(witness),
    }
}

fn budget(section: &mut Section<'_>) -> Result<BudgetSpec> {
    section.only(&BUDGET, &[])?;
    let name = text_of(section, "name")?;
    let kinds = [
        ("samples", BudgetKind::Samples),
        ("rays", BudgetKind::Rays),
        ("seconds", BudgetKind::Seconds),
    ];
    let given = kinds.map(|(key, kind)| (key, kind, section.take(key)));
    let mut given = given
        .into_iter()
        .filter_map(|(key, kind, entry)| Some((key, kind, entry?)));
    let Some((key, kind, entry)) = given.next() else {
        return Err(section.fault("expected one of `samples`, `rays` and `seconds`"));
    };
    if let Some((other, _, entry)) = given.next() {
        let message = format!("this budget has both `{key}` and `{other}`");
        return Err(entry.fault_with(message, "write one [[budget]] for each".to_owned()));
    }
    let amount = match kind {
        BudgetKind::Samples => entry.whole(1)? as f64,
        _ => entry.positive()?,
    };
    let budget = BudgetSpec::new(kind, amount);
    Ok(BudgetSpec {
        name: name.unwrap_or_else(|| budget.name.clone()),
        ..budget
    })
}
