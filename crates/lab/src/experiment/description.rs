//! The reader of descriptions: from TOML to an [`Experiment`].

mod claims;
mod scene;

use super::contributions::ContributionsSpec;
use super::error::ExperimentError;
use super::names::{file_name, value_of};
use super::reader::{Entry, Section, Source};
use super::settings::{names, no_effect};
use super::{BudgetSpec, Experiment, MethodSpec, PyramidSpec, Quick, Seeds};
use crate::metric::Metric;
use crate::results::BudgetKind;
use bidir::driver::{Settings, Threads};
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use claims::Names;
use formats::scene::Files;
use std::cell::Cell;
use std::path::Path;

type Result<T> = std::result::Result<T, ExperimentError>;

/// The most bytes that repetition makes: a small file must not fill the memory.
const MOST_REPEATED: usize = 64 << 20;
/// The default number of seeds.
const SEEDS: u64 = 10;
/// The keys of the whole description.
const TOP: [&str; 18] = [
    "title",
    "description",
    "seeds",
    "first-seed",
    "size",
    "threads",
    "metrics",
    "pyramid",
    "pyramid-spp",
    "pyramid-scenes",
    "contributions",
    "quick",
    "settings",
    "scene",
    "method",
    "budget",
    "claim",
    "table",
];
/// The hint for a setting without effect on an integrator that another table sets.
const INHERITED: &str =
    "[settings] sets this integrator: give the method its own, or leave the setting out";
/// The keys of `[[budget]]`.
const BUDGET: [&str; 6] = ["name", "samples", "rays", "seconds", "methods", "scenes"];
/// The keys of `[contributions]`.
const CONTRIBUTIONS: [&str; 3] = ["methods", "scenes", "spp"];
/// The keys of `[quick]`.
const QUICK: [&str; 6] = ["seeds", "size", "samples", "rays", "seconds", "references"];
/// Older names of settings.
const OLD_SETTINGS: [&str; 1] = ["emission"];
/// The default samples per pixel of images of strategies.
const PYRAMID_SPP: u64 = 64;
/// The default samples per pixel of measured contributions.
const CONTRIBUTIONS_SPP: u64 = 16;

impl Experiment {
    /// Reads a description; `file` is its name in messages, and its scenes are relative to that folder.
    ///
    /// Errors: [`ExperimentError::Description`], with line and column.
    pub fn read(text: &str, file: &Path) -> Result<Self> {
        Self::read_with(text, file, &Files::default())
    }

    /// Reads a description whose scenes may be in memory.
    pub(super) fn read_with(text: &str, file: &Path, memory: &Files) -> Result<Self> {
        let room = Cell::new(MOST_REPEATED);
        let mut top = Source {
            file,
            text,
            room: &room,
        }
        .parse()?;
        top.only(&TOP, &[])?;
        let mut defaults = Request::default();
        for (i, mut section) in top.sections("settings")?.into_iter().enumerate() {
            if i > 0 {
                return Err(section.fault("there is a second [settings]"));
            }
            section.only(&borrowed(&names()), &OLD_SETTINGS)?;
            defaults = settings(&mut section, None)?;
        }
        let folder = formats::file::folder_of(file);
        let (scenes, absent) = scene::all(&mut top, folder, &defaults, memory)?;
        let mut names = Names::of_scenes(&scenes, &absent);
        let method = |section: &mut Section<'_>| method(section, &defaults, &names);
        let methods = all(&mut top, "method", |method| &method.name, method)?;
        names.methods = methods.iter().map(|method| method.name.clone()).collect();
        let budget = |section: &mut Section<'_>| budget(section, &names);
        let budgets = all(&mut top, "budget", |budget| &budget.name, budget)?;
        names.budgets = budgets.iter().map(|budget| budget.kind).collect();
        let mut experiment = Self {
            title: or(text_of(&mut top, "title")?, "Experiment"),
            description: or(text_of(&mut top, "description")?, ""),
            size: size(&mut top)?,
            seeds: seeds(&mut top)?,
            threads: threads(&mut top)?,
            metrics: metrics(&mut top)?,
            scenes,
            absent,
            pyramid: pyramid(&mut top, &names, &methods)?,
            contributions: contributions(&mut top, &names)?,
            methods,
            budgets,
            claims: Vec::new(),
            tables: Vec::new(),
            quick: quick(&mut top)?,
        };
        experiment.claims = claims::claims(&mut top, &names)?;
        experiment.tables = claims::tables(&mut top, &names, &experiment.claims)?;
        experiment.add_metrics();
        Ok(experiment)
    }
}

/// Reads a list of names, each of which is one of `known`; empty if the key is missing.
fn list(section: &mut Section<'_>, key: &str, known: &[String]) -> Result<Vec<String>> {
    let Some(entry) = section.take(key) else {
        return Ok(Vec::new());
    };
    let names = entry.list("a list of names")?;
    names
        .iter()
        .map(|name| claims::known(name, known))
        .collect()
}

fn contributions(top: &mut Section<'_>, names: &Names) -> Result<Option<ContributionsSpec>> {
    let Some(entry) = top.take("contributions") else {
        return Ok(None);
    };
    let mut section = entry.section()?;
    section.only(&CONTRIBUTIONS, &[])?;
    Ok(Some(ContributionsSpec {
        methods: list(&mut section, "methods", &names.methods)?,
        scenes: list(&mut section, "scenes", &names.scenes)?,
        spp: whole(&mut section, "spp", 2)?.unwrap_or(CONTRIBUTIONS_SPP),
    }))
}

fn quick(top: &mut Section<'_>) -> Result<Quick> {
    let mut quick = Quick::default();
    let Some(entry) = top.take("quick") else {
        return Ok(quick);
    };
    let mut section = entry.section()?;
    section.only(&QUICK, &[])?;
    quick.seeds = whole(&mut section, "seeds", 1)?.unwrap_or(quick.seeds);
    quick.size = section
        .take("size")
        .map(|entry| entry.positive())
        .transpose()?;
    for (key, factor) in [
        ("samples", &mut quick.samples),
        ("rays", &mut quick.rays),
        ("seconds", &mut quick.seconds),
        ("references", &mut quick.references),
    ] {
        if let Some(entry) = section.take(key) {
            *factor = entry.positive()?;
        }
    }
    Ok(quick)
}

/// Reads the method whose strategies are rendered, with samples per pixel and scenes.
fn pyramid(
    top: &mut Section<'_>,
    names: &Names,
    methods: &[MethodSpec],
) -> Result<Option<PyramidSpec>> {
    let spp = top.take("pyramid-spp");
    let scenes = list(top, "pyramid-scenes", &names.scenes)?;
    let Some(entry) = top.take("pyramid") else {
        let fault = |spp: Entry<'_>| spp.fault("`pyramid-spp` needs `pyramid`");
        return spp.map_or(Ok(None), |spp| Err(fault(spp)));
    };
    let name = claims::known(&entry, &names.methods)?;
    let is_other = |method: &MethodSpec| {
        let integrator = method.request.integrator;
        method.name == name && integrator.is_some_and(|kind| kind != IntegratorKind::Bdpt)
    };
    if methods.iter().any(is_other) {
        let message = format!("the method `{name}` is not bidirectional");
        let hint = "strategies (s, t) are those of a method whose integrator is \"bdpt\"";
        return Err(entry.fault_with(message, hint.to_owned()));
    }
    Ok(Some(PyramidSpec {
        method: name,
        spp: spp.map_or(Ok(PYRAMID_SPP), |spp| spp.whole(2))?,
        scenes,
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

/// Reads the threads of each render. 0: the key is missing.
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

/// Reads width and height, written `64x48`.
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

/// Reads the metrics in addition to `rmse`.
fn metrics(top: &mut Section<'_>) -> Result<Vec<Metric>> {
    let Some(entry) = top.take("metrics") else {
        return Ok(vec![Metric::Relmse, Metric::RelmseTrimmed]);
    };
    let mut metrics = Vec::new();
    for entry in entry.list("a list of strings")? {
        let metric = entry.read(|name| value_of(&Metric::NAMES, name))?;
        if metric != Metric::Rmse && !metrics.contains(&metric) {
            metrics.push(metric);
        }
    }
    Ok(metrics)
}

/// Reads all tables `[[key]]`, at least one; their names differ also as parts of file names.
fn all<'a, T>(
    top: &mut Section<'a>,
    key: &'static str,
    name_of: fn(&T) -> &str,
    mut read: impl FnMut(&mut Section<'a>) -> Result<T>,
) -> Result<Vec<T>> {
    let mut all: Vec<T> = Vec::new();
    for mut section in top.sections(key)? {
        let one = read(&mut section)?;
        let name = file_name(name_of(&one));
        if name.is_empty() {
            return Err(section.fault("a name needs a letter or a digit"));
        }
        if all.iter().any(|other| file_name(name_of(other)) == name) {
            let message = format!("there is another {key} `{}`", name_of(&one));
            return Err(section.fault(message));
        }
        all.push(one);
    }
    if all.is_empty() {
        return Err(top.fault(format!("there is no [[{key}]]")));
    }
    Ok(all)
}

/// Reads the settings of a table, by the names of flags; `inherited` is the integrator of `[settings]`.
///
/// Errors: a setting without effect on the integrator.
fn settings(section: &mut Section<'_>, inherited: Option<IntegratorKind>) -> Result<Request> {
    let mut request = Request::default();
    let mut entries = Vec::new();
    for name in names() {
        let entry = match &*name {
            "light-start" => section.take_renamed(&name, "emission")?,
            _ => section.take(&name),
        };
        if let Some(entry) = entry {
            entry.read(|value| request.set(&name, value))?;
            entries.push((name, entry));
        }
    }
    let Some(integrator) = request.integrator.or(inherited) else {
        return Ok(request);
    };
    let ignored = request.ignored(&Settings::new(integrator));
    match entries.iter().find(|(name, _)| ignored.contains(name)) {
        None => Ok(request),
        Some((name, entry)) => {
            let hint = request.integrator.is_none().then_some(INHERITED);
            Err(entry.fault_hinted(no_effect(name, integrator), hint))
        }
    }
}

fn method(section: &mut Section<'_>, defaults: &Request, of: &Names) -> Result<MethodSpec> {
    let names = names();
    let known = ["name", "scenes"].into_iter().chain(borrowed(&names));
    section.only(&known.collect::<Vec<_>>(), &OLD_SETTINGS)?;
    Ok(MethodSpec {
        name: section.need("name")?.text()?.to_owned(),
        request: settings(section, defaults.integrator)?.over(defaults),
        scenes: list(section, "scenes", &of.scenes)?,
    })
}

fn borrowed(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

fn budget(section: &mut Section<'_>, names: &Names) -> Result<BudgetSpec> {
    section.only(&BUDGET, &[])?;
    let name = text_of(section, "name")?;
    let given = BudgetKind::NAMES.map(|(key, kind)| (key, kind, section.take(key)));
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
        methods: list(section, "methods", &names.methods)?,
        scenes: list(section, "scenes", &names.scenes)?,
        ..budget
    })
}
