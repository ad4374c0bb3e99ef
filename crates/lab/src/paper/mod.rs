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
//! are compared, which is the error at exactly equal cost. Ratios are paired by seed. Under uniform
//! weights, whose variance is infinite near edges, errors without the worst pixels decide. Training, of
//! ray roulette alone, is in the rays of the budget and in the seconds, and not in the rays that errors
//! are scaled by: it is as long however many samples follow.

pub mod claims;
pub mod contributions;
pub mod depths;
mod plans;
mod room;
#[cfg(test)]
mod tests;

use crate::experiment::{
    End, Experiment, ExperimentError, Observer, Outcome, Setup, write_results,
};
use crate::results::{Claim, Results};
use crate::{parts, scenes};
use bidir::driver::Settings;
use bidir::settings::Request;
use contributions::Contributions;
use depths::Depths;
use formats::pbrt::LoadOptions;
use plans::{ALBEDOS, Complexity, WEIGHTS};
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
pub(crate) fn setting() -> Request {
    let mut changes = Request::default();
    let values = [
        ("integrator", "bdpt"),
        ("strategies", "all,-s0,-t1"),
        ("light-point", "shared"),
        ("light-choice", "power"),
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
    let amounts = options.effort.amounts();
    parts::begin("paper", setup)?;
    let folder = setup.folder.join("scenes");
    scenes::unpack(&folder).map_err(|error| ExperimentError::Folder {
        path: folder.clone(),
        error,
    })?;
    let mut claims = section_3(amounts.walks)?;
    claims.extend(figure_2(&folder)?);
    let Some(parts) = Parts::render(options, &folder, setup, observer)? else {
        return Ok(Outcome {
            end: End::Stopped,
            results: None,
        });
    };
    claims.extend(parts.claims());
    let results = merge(parts.named(), claims, setup);
    write_results(&setup.folder, &results)?;
    Ok(Outcome {
        end: End::Complete,
        results: Some(results),
    })
}

/// What the three experiments found.
struct Parts {
    table_1: Results,
    complexity: Results,
    /// Numbers of triangles, ascending.
    levels: Vec<usize>,
    albedo: Results,
}

impl Parts {
    /// Renders what has no record yet, of the scenes in `folder`. None: the observer stopped it.
    fn render(
        options: Options,
        folder: &Path,
        setup: &Setup,
        observer: &mut dyn Observer,
    ) -> Result<Option<Self>> {
        let amounts = options.effort.amounts();
        let mut part = |plan, name| -> Result<Option<Results>> {
            let plan = Experiment {
                threads: options.threads,
                ..plan
            };
            let outcome = parts::run(&plan, name, setup, observer)?;
            Ok(outcome.results.filter(|_| outcome.end == End::Complete))
        };
        let Some(table_1) = part(plans::table_1(&amounts, folder), "table-1")? else {
            return Ok(None);
        };
        let rooms = Complexity::write(&amounts, folder)?;
        let Some(references) = part(rooms.references(), REFERENCES)? else {
            return Ok(None);
        };
        let plan = rooms.plan(&amounts, &references, &setup.folder.join(REFERENCES));
        let Some(complexity) = part(plan, "complexity")? else {
            return Ok(None);
        };
        let albedo = part(plans::albedo(&amounts, folder)?, "albedo")?;
        Ok(albedo.map(|albedo| Self {
            table_1,
            complexity,
            levels: rooms.levels(),
            albedo,
        }))
    }

    /// What their records say.
    fn claims(&self) -> Vec<Claim> {
        let table_1 = &self.table_1.records;
        [
            claims::table_1(table_1),
            claims::times(table_1),
            claims::complexity(&self.complexity.records, &self.levels),
            claims::rooms(table_1),
            claims::albedo(&self.albedo.records),
            claims::beyond(table_1),
        ]
        .concat()
    }

    /// With the names of their folders.
    fn named(self) -> [(&'static str, Results); 3] {
        [
            ("table-1", self.table_1),
            ("complexity", self.complexity),
            ("albedo", self.albedo),
        ]
    }
}

/// The folder of the references of the sweep of triangles.
const REFERENCES: &str = "complexity-references";

/// Walks in closed rooms.
fn section_3(walks: u64) -> Result<Vec<Claim>> {
    let confidence = claims::shared(ALBEDOS.len());
    let mut rooms = Vec::new();
    for albedo in ALBEDOS {
        let depths = Depths::measure(albedo, walks, confidence);
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

/// One for all.
fn merge(parts: [(&str, Results); 3], claims: Vec<Claim>, setup: &Setup) -> Results {
    let description = "The statements of Lafortune and Willems (1995), each with what was found. \
                       Strategies s >= 1 and t >= 2 take part, next-event estimation shares the light \
                       subpath's point, walks end by roulette with the reflectivity.";
    let all = parts::empty(
        "Reducing the number of shadow rays, 1995 and now",
        description,
        setup,
    );
    // The sweeps have many images, of which none shows more than the first.
    let all = parts.into_iter().fold(all, |all, (folder, part)| {
        parts::with(all, folder, part, |_| folder == "table-1")
    });
    Results { claims, ..all }
}
