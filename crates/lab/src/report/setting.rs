//! What was compared, on what, with which settings.

use super::definitions;
use super::number::number;
use super::table::table;
use crate::experiment::analysis::reference_noise;
use crate::markup::{Element, element};
use crate::results::{BudgetInfo, BudgetKind, Cell, MethodInfo, Results, SceneInfo, Table};
use std::collections::BTreeSet;

/// The section.
pub(super) fn section(results: &Results) -> Element {
    super::section("setting", "Comparison")
        .child(element("p").text(extent(results)))
        .children(methods(&results.methods))
        .child(element("h3").text("Scenes"))
        .child(table(&scenes(&results.scenes)))
        .children(results.scenes.iter().map(|scene| reference(results, scene)))
        .child(element("h3").text("Budgets"))
        .child(table(&budgets(&results.budgets)))
        .child(element("h3").text("Machine and seeds"))
        .child(machine(results))
}

/// How much was rendered.
fn extent(results: &Results) -> String {
    let seconds: f64 = results.records.iter().map(|record| record.seconds).sum();
    let rays: u64 = results
        .records
        .iter()
        .map(|record| record.rays.total())
        .sum();
    format!(
        "{} of {}, {} and {}, with {}: {} rays in {} seconds.",
        counted(results.records.len(), "render"),
        counted(results.scenes.len(), "scene"),
        counted(results.methods.len(), "method"),
        counted(results.budgets.len(), "budget"),
        counted(seeds(results).len(), "seed"),
        number(rays as f64),
        number(seconds),
    )
}

fn counted(count: usize, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{} {thing}{plural}", number(count as f64))
}

fn seeds(results: &Results) -> BTreeSet<u64> {
    results.records.iter().map(|record| record.seed).collect()
}

/// Settings that differ stand in the table, those that all methods share below it.
fn methods(methods: &[MethodInfo]) -> [Element; 3] {
    let names: BTreeSet<_> = methods
        .iter()
        .flat_map(|method| method.settings.keys())
        .collect();
    let differs = |name: &&String| {
        let mut values = methods.iter().map(|method| method.settings.get(*name));
        let first = values.next();
        values.any(|value| Some(value) != first)
    };
    let (different, shared): (Vec<&String>, Vec<_>) = names.into_iter().partition(differs);
    let row = |method: &MethodInfo| {
        let value = |name: &&String| {
            method
                .settings
                .get(*name)
                .map_or("–", String::as_str)
                .into()
        };
        let cells = [method.name.clone()]
            .into_iter()
            .chain(different.iter().map(value));
        cells.map(Cell::Text).collect()
    };
    let columns = ["method"]
        .into_iter()
        .chain(different.iter().map(|name| name.as_str()));
    let settings = Table {
        caption: "Settings that differ between methods; ratios are relative to the first method."
            .into(),
        columns: columns.map(str::to_owned).collect(),
        rows: methods.iter().map(row).collect(),
    };
    let shared = shared.into_iter().map(|name| {
        let value = methods.first().and_then(|method| method.settings.get(name));
        (name.clone(), value.cloned().unwrap_or_default())
    });
    [
        element("h3").text("Methods"),
        element("div").class("differing").child(table(&settings)),
        element("details")
            .with("open", "")
            .child(element("summary").text("Settings that are the same for all methods"))
            .child(definitions(shared)),
    ]
}

fn scenes(scenes: &[SceneInfo]) -> Table {
    let row = |scene: &SceneInfo| {
        let [width, height] = scene.size;
        let cells = [
            scene.name.clone(),
            scene.file.clone(),
            format!("{width} × {height}"),
            scene.digest.clone(),
        ];
        cells.map(Cell::Text).to_vec()
    };
    Table {
        caption: "The digest is of every byte that was read for the scene.".into(),
        columns: ["scene", "file", "pixels", "digest"]
            .map(str::to_owned)
            .to_vec(),
        rows: scenes.iter().map(row).collect(),
    }
}

/// What the images of a scene are compared with.
fn reference(results: &Results, scene: &SceneInfo) -> Element {
    let stored = scene.reference_image.as_ref();
    let stored = stored.map_or(String::new(), |file| format!(" ({file})"));
    element("p")
        .child(element("b").text(format!("Reference of {}: ", scene.name)))
        .text(&scene.reference)
        .text(stored)
        .text(noise(results, scene))
}

/// How far the reference itself is from the truth. Empty where nobody knows.
fn noise(results: &Results, scene: &SceneInfo) -> String {
    let Some(mse) = scene.reference_mse else {
        return String::new();
    };
    let mut noises = reference_noise(results);
    let part = noises.find(|noise| noise.scene == scene.name);
    let part = part.map_or(String::new(), |noise| {
        let percent = number(100.0 * noise.share);
        format!(
            ", {percent} % of the smallest ({}, {})",
            noise.method, noise.budget
        )
    });
    let mse = number(mse);
    format!(". The mean square error of its own is {mse}; it is in that of every image{part}.")
}

fn budgets(budgets: &[BudgetInfo]) -> Table {
    let row = |budget: &BudgetInfo| {
        let what = match budget.kind {
            BudgetKind::Samples => "samples per pixel",
            BudgetKind::Rays => "rays of all kinds per pixel, with those of training",
            BudgetKind::Seconds => "seconds of rendering and training",
        };
        vec![
            Cell::Text(budget.name.clone()),
            Cell::Number(budget.amount),
            Cell::Text(what.into()),
        ]
    };
    Table {
        caption: "The amounts that are equal for all methods.".into(),
        columns: ["budget", "amount", "of"].map(str::to_owned).to_vec(),
        rows: budgets.iter().map(row).collect(),
    }
}

fn machine(results: &Results) -> Element {
    let machine = &results.machine;
    let pairs = [
        ("Program", results.program.clone()),
        ("Processor", machine.processor.clone()),
        ("Threads of each render", machine.threads.to_string()),
        ("Instruction set of the intersector", machine.isa.clone()),
        ("System", machine.system.clone()),
        ("Seeds", ranges(&seeds(results))),
    ];
    definitions(pairs.map(|(word, meaning)| (word.to_owned(), meaning)))
}

/// Numbers in order, `1–5, 9`.
fn ranges(numbers: &BTreeSet<u64>) -> String {
    let mut runs: Vec<[u64; 2]> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some([_, last]) if number - *last == 1 => *last = number,
            _ => runs.push([number; 2]),
        }
    }
    let written = |[first, last]: [u64; 2]| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}–{last}")
        }
    };
    runs.into_iter().map(written).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_ranges() {
        let written = |numbers: &[u64]| ranges(&numbers.iter().copied().collect());
        assert_eq!(written(&[]), "");
        assert_eq!(written(&[3, 1, 2, 9, 11, 12]), "1–3, 9, 11–12");
    }
}
