//! The experiment of the 1995 paper, repeated claim by claim.
//!
//! [`run`] needs no files: the scenes are in the program, or are made. It renders three experiments
//! with the engine of [`crate::experiment`], walks and counts where no image is needed, and gives
//! [`Results`] with a [`Claim`] for each statement of \[Lafortune95\]:
//!
//! | part | folder | statements |
//! |---|---|---|
//! | [`depths`] | | section 3: E(N_e) and E(N_l N_e) |
//! | [`contributions`] | | figure 2: the range of contributions |
//! | table 1 | `table-1/` | errors at equal rays; times; rooms with lights of their own |
//! | complexity | `complexity/` | section 4: what more triangles change |
//! | albedo | `albedo/` | section 3: more shadow rays where more light is reflected |
//!
//! # The setting
//!
//! Hits of lights (s = 0) and the light image (t = 1) are left out, from references too; next-event
//! estimation shares the light subpath's own point; walks end by roulette with the reflectivity, and in
//! no other way; random numbers are independent. What the weights were is not known: everything is
//! done under uniform weights, the balance heuristic and the power heuristic.
//!
//! # Errors at equal cost
//!
//! Renders end after whole passes, so costs are equal to half a pass. As samples are independent,
//! E(error²) · samples is a constant, and so is error² · cost: √(error² · rays) and √(error² · seconds)
//! are compared, which is the error at exactly equal cost. Ratios are paired by seed.

pub mod claims;
pub mod contributions;
pub mod depths;
mod plans;
mod room;
mod scenes;
#[cfg(test)]
mod tests;

use crate::experiment::{
    Changes, End, Experiment, ExperimentError, Observer, Outcome, Setup, run as render,
    write_results,
};
use crate::results::{Claim, FORMAT, Results};
use bidir::driver::Settings;
use contributions::Contributions;
use depths::Depths;
use formats::pbrt::LoadOptions;
use plans::{Complexity, WEIGHTS};
use std::path::Path;

type Result<T> = std::result::Result<T, ExperimentError>;

/// How much is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A few pixels, to see whether it works: nothing can be concluded.
    Trial,
    /// Every claim within 15 minutes on two cores.
    Quick,
    /// Tighter intervals, and up to 10⁶ triangles, within 2 hours.
    Full,
}

/// How the experiment is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// How much is rendered.
    pub effort: Effort,
    /// Threads of each render; 0 is one per processor.
    pub threads: usize,
}

/// The setting of the paper, but for weights and rules.
pub(crate) fn setting() -> Changes {
    let mut changes = Changes::default();
    let values = [
        ("integrator", "bdpt"),
        ("strategies", "all,-s0,-t1"),
        ("light-point", "shared"),
        ("path-roulette", "albedo:0"),
        ("sampler", "independent"),
        ("max-depth", "0"),
    ];
    for (name, value) in values {
        let set = changes.set(name, value);
        debug_assert!(set.is_ok(), "{name} {value}: {set:?}");
    }
    changes
}

/// Runs everything that has no record yet, judges, and writes `results.json`.
pub fn run(options: Options, setup: &Setup, observer: &mut dyn Observer) -> Result<Outcome> {
    let Options { effort, threads } = options;
    let amounts = effort.amounts();
    let part = |plan, name, observer: &mut dyn Observer| {
        let plan = Experiment { threads, ..plan };
        part(&plan, name, setup, observer)
    };
    let folder = setup.folder.join("scenes");
    scenes::unpack(&folder).map_err(|error| ExperimentError::Folder {
        path: folder.clone(),
        error,
    })?;
    let mut claims = section_3(amounts.walks)?;
    claims.extend(figure_2(&folder)?);
    let mut parts = Vec::new();
    let plan = plans::table_1(&amounts, &folder);
    let Some(table) = part(plan, "table-1", observer)? else {
        return Ok(STOPPED);
    };
    parts.push(("table-1", table));
    let complexity = Complexity::write(&amounts, &folder)?;
    let plan = complexity.references();
    let Some(references) = part(plan, "complexity-references", observer)? else {
        return Ok(STOPPED);
    };
    let at = setup.folder.join("complexity-references");
    let plan = complexity.plan(&amounts, &references, &at);
    let Some(sweep) = part(plan, "complexity", observer)? else {
        return Ok(STOPPED);
    };
    parts.push(("complexity", sweep));
    let plan = plans::albedo(&amounts, &folder)?;
    let Some(albedo) = part(plan, "albedo", observer)? else {
        return Ok(STOPPED);
    };
    parts.push(("albedo", albedo));
    claims.extend(claims::table_1(&parts[0].1.records));
    claims.extend(claims::times(&parts[0].1.records));
    claims.extend(claims::complexity(
        &parts[1].1.records,
        &complexity.levels(),
    ));
    claims.extend(claims::rooms(&parts[0].1.records));
    claims.extend(claims::albedo(&parts[2].1.records));
    claims.extend(claims::beyond(&parts[0].1.records));
    let results = merge(parts, claims, setup);
    write_results(&setup.folder, &results)?;
    Ok(Outcome {
        end: End::Complete,
        results: Some(results),
    })
}

const STOPPED: Outcome = Outcome {
    end: End::Stopped,
    results: None,
};

/// Runs one of the experiments in a folder of its own. None: it was stopped.
fn part(
    experiment: &Experiment,
    folder: &str,
    setup: &Setup,
    observer: &mut dyn Observer,
) -> Result<Option<Results>> {
    let setup = Setup {
        folder: setup.folder.join(folder),
        ..setup.clone()
    };
    let outcome = render(experiment, &setup, observer)?;
    Ok(outcome.results.filter(|_| outcome.end == End::Complete))
}

/// Walks in closed rooms.
fn section_3(walks: u64) -> Result<Vec<Claim>> {
    let mut rooms = Vec::new();
    for albedo in [0.3, 0.5, 0.7, 0.8] {
        let depths = Depths::measure(albedo, walks);
        let depths = depths.map_err(|error| ExperimentError::Render {
            scene: format!("closed room of albedo {albedo}"),
            error,
        })?;
        rooms.extend(depths);
    }
    Ok(claims::section_3(&rooms))
}

/// The contributions of both scenes, under all weights.
fn figure_2(folder: &Path) -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for (name, file) in plans::ROOMS {
        let options = LoadOptions {
            resolution: Some(plans::SMALL),
            ..LoadOptions::default()
        };
        let loaded = formats::pbrt::load(&scenes::path(folder, file), &options)?;
        let measure = |weights: &str| {
            let mut changes = setting();
            let set = changes.set("mis", weights);
            debug_assert!(set.is_ok(), "{set:?}");
            let settings = changes.apply(&Settings::default());
            Contributions::measure(&loaded.scene, &settings, 16)
        };
        claims.push(claims::figure_2(name, &WEIGHTS.map(|w| (w, measure(w)))));
    }
    Ok(claims)
}

/// One for all: images are found from the common folder.
fn merge(parts: Vec<(&str, Results)>, claims: Vec<Claim>, setup: &Setup) -> Results {
    let mut all = Results {
        format: FORMAT,
        title: "Reducing the number of shadow rays, 1995 and now".to_owned(),
        description: "The statements of Lafortune and Willems (1995), each with what was found. \
                      Strategies s >= 1 and t >= 2 take part, next-event estimation shares the light \
                      subpath's point, walks end by roulette with the reflectivity."
            .to_owned(),
        program: setup.program.clone(),
        machine: setup.machine.clone(),
        scenes: Vec::new(),
        methods: Vec::new(),
        budgets: Vec::new(),
        records: Vec::new(),
        pyramids: Vec::new(),
        claims,
    };
    for (folder, part) in parts {
        let moved = |image: Option<String>| image.map(|image| format!("{folder}/{image}"));
        all.machine.threads = part.machine.threads;
        for mut scene in part.scenes {
            scene.reference_image = moved(scene.reference_image);
            all.scenes.push(scene);
        }
        for mut record in part.records {
            // The sweeps have many images, of which none shows more than the first.
            record.image = moved(record.image).filter(|_| folder == "table-1");
            all.records.push(record);
        }
        for mut pyramid in part.pyramids {
            for sheet in [&mut pyramid.weighted, &mut pyramid.raw] {
                *sheet = format!("{folder}/{sheet}");
            }
            all.pyramids.push(pyramid);
        }
        for method in part.methods {
            if all.methods.iter().all(|known| known.name != method.name) {
                all.methods.push(method);
            }
        }
        for budget in part.budgets {
            if all.budgets.iter().all(|known| known.name != budget.name) {
                all.budgets.push(budget);
            }
        }
    }
    all
}
