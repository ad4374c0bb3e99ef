//! Claims and tables of a description.

use super::super::claims::{
    BudgetChoice, CellSpec, ClaimSpec, Measure, Over, PlotSpec, Quantity, TablePlace, TableSpec,
};
use super::super::error::ExperimentError;
use super::super::expand::Binding;
use super::super::names::{file_name, value_of};
use super::super::reader::{Entry, Section};
use super::super::{Absent, SceneSpec};
use crate::results::{BudgetKind, Scale};
use bidir::names::UnknownName;

type Result<T> = std::result::Result<T, ExperimentError>;

/// The keys of a quantity.
const QUANTITY: &str = "measure budget scene method over gain-over than";
/// The other keys of `[[claim]]`.
const CLAIM: &str = "id source claim goal each part below above";
/// The other keys of `[[table]]`.
const TABLE: &str = "claim section caption each columns plot histogram";
/// The other keys of a column.
const COLUMN: &str = "head value for";
const PLOT: &str = "x curves label log";

/// The names that quantities can refer to.
#[derive(Default)]
pub(super) struct Names {
    /// The names of all scenes, including missing ones.
    pub(super) scenes: Vec<String>,
    pub(super) methods: Vec<String>,
    pub(super) budgets: Vec<BudgetKind>,
}

impl Names {
    pub(super) fn of_scenes(scenes: &[SceneSpec], absent: &[Absent]) -> Self {
        let scenes = scenes.iter().map(|scene| scene.name.clone());
        let absent = absent.iter().map(|scene| scene.name.clone());
        Self {
            scenes: scenes.chain(absent).collect(),
            ..Self::default()
        }
    }
}

/// Reads a name, which is one of `names`.
pub(super) fn known(entry: &Entry<'_>, names: &[String]) -> Result<String> {
    let name = entry.written()?;
    if names.iter().any(|known| known == name) {
        return Ok(name.to_owned());
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Err(entry.fault(UnknownName::new(name, &names).to_string()))
}

/// Reads a quantity.
fn quantity(section: &mut Section<'_>, names: &Names) -> Result<Quantity> {
    let measure = section.need("measure")?.read(str::parse::<Measure>)?;
    let budget = section.get("budget", |entry| {
        let kind = entry.read(|name| value_of(&BudgetKind::NAMES, name))?;
        let is_there = names.budgets.contains(&kind);
        let choice = is_there.then_some(BudgetChoice::Kind(kind));
        choice.ok_or_else(|| entry.fault("no [[budget]] is of this kind"))
    });
    let method = known(&section.need("method")?, &names.methods)?;
    let (method, over) = match (section.take("over"), section.take("gain-over")) {
        (Some(_), Some(gain)) => {
            return Err(gain.fault("`over` and `gain-over` exclude each other"));
        }
        (None, None) => (method, Over::Nothing),
        (Some(over), None) => (method, divisor(&over, names)?),
        (None, Some(over)) => (known(&over, &names.methods)?, Over::Method(method)),
    };
    Ok(Quantity {
        measure,
        budget: budget?.unwrap_or(BudgetChoice::First),
        scene: known(&section.need("scene")?, &names.scenes)?,
        method,
        over,
        than: section.get("than", |entry| known(entry, &names.scenes))?,
    })
}

/// Reads a divisor: a number, or another method.
fn divisor(entry: &Entry<'_>, names: &Names) -> Result<Over> {
    match entry.written()?.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(Over::Number(number)),
        Ok(_) => Err(entry.fault("expected a number above 0")),
        Err(_) => Ok(Over::Method(known(entry, &names.methods)?)),
    }
}

/// Reads a `[[claim]]`.
pub(super) fn claim(section: &mut Section<'_>, names: &Names) -> Result<ClaimSpec> {
    section.only(&[CLAIM, QUANTITY].join(" "), &[])?;
    let id = section.need("id")?;
    let goal = section.get("goal", Entry::truth)?.unwrap_or(false);
    let claim = section.need("claim")?.text()?.to_owned();
    let source = section.text("source")?;
    let above = section.get("above", Entry::number)?;
    let below = section.get("below", Entry::number)?;
    if above.or(below).is_none() {
        return Err(section.fault("expected `below`, `above`, or both"));
    }
    let name = file_name(id.text()?);
    if name.is_empty() {
        return Err(id.fault("an id needs a letter or a digit"));
    }
    let bindings = section.bindings("each")?;
    let parts = bindings.iter().map(|binding| part(section, binding, names));
    Ok(ClaimSpec {
        id: name,
        source: source.unwrap_or_else(|| "Own claim".to_owned()),
        claim,
        goal,
        above,
        below,
        parts: parts.collect::<Result<_>>()?,
    })
}

/// Reads a number of a claim, with its name.
fn part(section: &Section<'_>, binding: &Binding, names: &Names) -> Result<(String, Quantity)> {
    let mut section = section.bound(binding)?;
    let name = section.text("part")?;
    let quantity = quantity(&mut section, names)?;
    let default = || format!("{}, {}", quantity.method, quantity.scene);
    Ok((name.unwrap_or_else(default), quantity))
}

/// Reads all `[[table]]`.
pub(super) fn tables(
    top: &mut Section<'_>,
    names: &Names,
    claims: &[ClaimSpec],
) -> Result<Vec<TableSpec>> {
    let mut sections = top.sections("table")?;
    sections
        .iter_mut()
        .map(|section| table(section, names, claims))
        .collect()
}

fn table(section: &mut Section<'_>, names: &Names, claims: &[ClaimSpec]) -> Result<TableSpec> {
    section.only(&[TABLE, QUANTITY].join(" "), &[])?;
    let place = place(section, claims)?;
    let caption = section.need("caption")?.text()?.to_owned();
    let histogram = section.text("histogram")?;
    let (mut columns, mut rows) = (Vec::new(), Vec::new());
    for binding in section.bindings("each")? {
        let row = row(section.bound(&binding)?, names)?.into_iter();
        let (heads, cells) = row.unzip();
        columns = heads;
        rows.push(cells);
    }
    Ok(TableSpec {
        place,
        caption,
        plot: section.nested("plot", PLOT, |section| plot(section, &columns))?,
        columns,
        rows,
        histogram,
    })
}

/// Reads the claim or the section of a table.
fn place(section: &mut Section<'_>, claims: &[ClaimSpec]) -> Result<TablePlace> {
    match (section.take("claim"), section.take("section")) {
        (Some(claim), None) => {
            let id = file_name(claim.text()?);
            if claims.iter().any(|other| other.id == id) {
                return Ok(TablePlace::Claim(id));
            }
            Err(claim.fault(format!("there is no claim `{id}`")))
        }
        (None, title) => Ok(TablePlace::Section(match title {
            Some(title) => title.text()?.to_owned(),
            None => "Tables".to_owned(),
        })),
        (_, Some(title)) => Err(title.fault("`claim` and `section` exclude each other")),
    }
}

/// Reads the cells of a row with the heads of their columns.
fn row(mut section: Section<'_>, names: &Names) -> Result<Vec<(String, CellSpec)>> {
    let columns = section.need("columns")?;
    let mut cells = Vec::new();
    for column in columns.list("a list of columns")? {
        for mut column in column.section()?.expanded()? {
            column.only(&[COLUMN, QUANTITY].join(" "), &[])?;
            let head = column.need("head")?.text()?.to_owned();
            let cell = if let Some(value) = column.take("value") {
                CellSpec::Value(value.written()?.to_owned())
            } else {
                column.fill(&section, QUANTITY);
                CellSpec::Quantity(quantity(&mut column, names)?)
            };
            cells.push((head, cell));
        }
    }
    Ok(cells)
}

/// Reads a plot of columns.
fn plot(section: &mut Section<'_>, heads: &[String]) -> Result<PlotSpec> {
    let column = |entry: &Entry<'_>| {
        let head = entry.text()?;
        let place = heads.iter().position(|known| known == head);
        place.ok_or_else(|| entry.fault(format!("there is no column `{head}`")))
    };
    let x = column(&section.need("x")?)?;
    let curves = section.need("curves")?.list("a list of columns")?;
    let curves = curves.iter().map(column).collect::<Result<_>>()?;
    let label = section.need("label")?.text()?.to_owned();
    let log = section.text("log")?.unwrap_or_default();
    let scale = |axis| {
        if log.contains(axis) {
            Scale::Log
        } else {
            Scale::Linear
        }
    };
    Ok(PlotSpec {
        x,
        curves,
        label,
        x_scale: scale('x'),
        y_scale: scale('y'),
    })
}
