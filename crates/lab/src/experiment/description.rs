//! Reads descriptions in TOML.

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

/// Maximum number of bytes that repetitions add, as a small file must not fill the memory.
const MOST_REPEATED: usize = 64 << 20;
/// The default number of seeds.
const SEEDS: u64 = 10;
/// The keys of the whole description.
const TOP: &str = "title description seeds first-seed size threads metrics pyramid pyramid-spp \
    pyramid-scenes contributions quick settings scene method budget claim table";
/// The hint for a setting that has no effect on the integrator, if another table sets the integrator.
const INHERITED: &str =
    "[settings] sets this integrator: give the method its own, or leave the setting out";
/// The keys of `[[budget]]`.
const BUDGET: &str = "name samples rays seconds methods scenes";
/// The keys of `[contributions]`.
const CONTRIBUTIONS: &str = "methods scenes spp";
/// The keys of `[quick]`.
const QUICK: &str = "seeds size samples rays seconds references";
/// Older names of settings.
const OLD_SETTINGS: [&str; 1] = ["emission"];
/// The default samples per pixel of images of strategies.
const PYRAMID_SPP: u64 = 64;
/// The default samples per pixel of measured contributions.
const CONTRIBUTIONS_SPP: u64 = 16;

impl Experiment {
    /// Reads a description. `file` is its name in messages; paths of scenes are relative to its folder.
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
        top.only(TOP, &[])?;
        let mut defaults = Request::default();
        for (i, mut section) in top.sections("settings")?.into_iter().enumerate() {
            if i > 0 {
                return Err(section.fault("there is a second [settings]"));
            }
            section.only(&names().join(" "), &OLD_SETTINGS)?;
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
        let title = top.text("title")?;
        let threads = top.get("threads", |threads| threads.up_to(Threads::MOST))?;
        let mut experiment = Self {
            title: title.unwrap_or_else(|| "Experiment".to_owned()),
            description: top.text("description")?.unwrap_or_default(),
            size: size(&mut top)?,
            seeds: Seeds {
                first: top.get("first-seed", |first| first.whole(0))?.unwrap_or(0),
                count: top.get("seeds", |count| count.whole(1))?.unwrap_or(SEEDS),
            },
            threads: threads.unwrap_or(0),
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
        let claim = |section: &mut Section<'_>| claims::claim(section, &names);
        experiment.claims = all(&mut top, "claim", |claim| &claim.id, claim)?;
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
    top.nested("contributions", CONTRIBUTIONS, |section| {
        Ok(ContributionsSpec {
            methods: list(section, "methods", &names.methods)?,
            scenes: list(section, "scenes", &names.scenes)?,
            spp: section
                .get("spp", |spp| spp.whole(2))?
                .unwrap_or(CONTRIBUTIONS_SPP),
        })
    })
}

fn quick(top: &mut Section<'_>) -> Result<Quick> {
    let default = Quick::default();
    let quick = top.nested("quick", QUICK, |section| {
        let mut factor = |key, default| -> Result<f64> {
            Ok(section.get(key, Entry::positive)?.unwrap_or(default))
        };
        Ok(Quick {
            samples: factor("samples", default.samples)?,
            rays: factor("rays", default.rays)?,
            seconds: factor("seconds", default.seconds)?,
            references: factor("references", default.references)?,
            size: section.get("size", Entry::positive)?,
            seeds: section
                .get("seeds", |seeds| seeds.whole(1))?
                .unwrap_or(default.seeds),
        })
    });
    Ok(quick?.unwrap_or(default))
}

/// Reads the method whose strategies are rendered, and the samples per pixel and scenes for them.
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
        return Err(entry.fault_with(message, hint));
    }
    Ok(Some(PyramidSpec {
        method: name,
        spp: spp.map_or(Ok(PYRAMID_SPP), |spp| spp.whole(2))?,
        scenes,
    }))
}

/// Reads width and height, written `64x48`.
fn size(section: &mut Section<'_>) -> Result<Option<[u32; 2]>> {
    let read = |text: &str| {
        let sides = text.split_once(['x', 'X']);
        let side = |side: &str| side.trim().parse().ok().filter(|side| *side > 0);
        let size = sides.and_then(|(width, height)| Some([side(width)?, side(height)?]));
        size.ok_or("expected WIDTHxHEIGHT, such as 320x240")
    };
    section.get("size", |entry| entry.read(read))
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

/// Reads all tables `[[key]]`. Errors: there is none, except of claims; two names are equal, also as parts of file names.
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
    if all.is_empty() && key != "claim" {
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
            Err(entry.fault_with(no_effect(name, integrator), hint))
        }
    }
}

fn method(section: &mut Section<'_>, defaults: &Request, of: &Names) -> Result<MethodSpec> {
    section.only(&format!("name scenes {}", names().join(" ")), &OLD_SETTINGS)?;
    Ok(MethodSpec {
        name: section.need("name")?.text()?.to_owned(),
        request: settings(section, defaults.integrator)?.over(defaults),
        scenes: list(section, "scenes", &of.scenes)?,
    })
}

fn budget(section: &mut Section<'_>, names: &Names) -> Result<BudgetSpec> {
    section.only(BUDGET, &[])?;
    let name = section.text("name")?;
    let given = BudgetKind::NAMES.map(|(key, kind)| (key, kind, section.take(key)));
    let mut given = given
        .into_iter()
        .filter_map(|(key, kind, entry)| Some((key, kind, entry?)));
    let Some((key, kind, entry)) = given.next() else {
        return Err(section.fault("expected one of `samples`, `rays` and `seconds`"));
    };
    if let Some((other, _, entry)) = given.next() {
        let message = format!("this budget has both `{key}` and `{other}`");
        return Err(entry.fault_with(message, "write one [[budget]] for each"));
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
