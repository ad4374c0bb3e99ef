//! Plans, and all of it small.

use super::plan::{LightTracing, SCENES};
use super::variants::{AUTO, BASELINE, PATH, SHARED};
use super::*;
use crate::experiment::{Start, texts};
use crate::results::{Cell, Claim, Machine, Table, Verdict};
use bidir::driver::Settings;
use bidir::integrator::{BlindSpot, IntegratorKind, blind_spots};
use bidir::settings::Request;
use formats::pbrt::{LoadOptions, load};
use std::collections::BTreeSet;
use std::path::Path;

fn options() -> Options {
    Options {
        amounts: Amounts {
            size: Some([8, 6]),
            scale: 1,
            seconds: 2.5,
            rays: 30.0,
            judged: Judged {
                seconds: 60.0,
                rays: 1e6,
            },
            seeds: 2,
            reference_spp: 16,
        },
        threads: 2,
        others: None,
        scenes: Vec::new(),
    }
}

#[test]
fn every_variant_is_of_one_that_is_rendered_and_has_settings_of_its_own() {
    let mut settings = BTreeSet::new();
    for variant in variants::rendered(LightTracing::Complete) {
        let own = texts(&variant.changes().apply(&Settings::default()));
        assert!(settings.insert(format!("{own:?}")), "{}", variant.name);
    }
    let rendered: Vec<_> = variants::rendered(LightTracing::Incomplete)
        .map(|variant| variant.name)
        .collect();
    assert_eq!((rendered[0], rendered[1]), (BASELINE, PATH));
    assert!(rendered.contains(&SHARED) && rendered.contains(&AUTO));
    assert!(!rendered.contains(&"light"));
    for idea in variants::ideas() {
        for (variant, of) in variants::of_idea(idea) {
            assert!(rendered.contains(&of), "{} of {of}", variant.name);
            assert!(rendered.contains(&variant.rendered().name));
            assert_ne!(variant.changes(), Request::default(), "{}", variant.name);
        }
    }
    // The defaults stand for what they are.
    let aliases = variants::aliases();
    assert!(
        aliases.contains(&"lvc learned is lvc".to_owned()),
        "{aliases:?}"
    );
}

#[test]
fn equal_time_is_of_estimators_and_equal_rays_are_of_all() {
    let folder = Path::new("");
    let (places, _) = plan::places(&options(), folder);
    let experiment = plan::experiment(&options(), &places[0]);
    let [time, rays] = &experiment.budgets[..] else {
        panic!("{:?}", experiment.budgets);
    };
    assert_eq!(
        (time.kind, rays.kind),
        (BudgetKind::Seconds, BudgetKind::Rays)
    );
    assert_eq!(time.methods, [BASELINE, PATH, SHARED, AUTO]);
    assert!(experiment.methods.iter().all(|method| rays.is_of(method)));
    assert_eq!(experiment.cells(), 2 * (4 + experiment.methods.len()));
    let mis = SCENES
        .iter()
        .find(|scene| scene.name == "veach-mis")
        .unwrap();
    let mut light = variants::rendered(mis.light).map(|variant| variant.name);
    assert!(light.any(|name| name == "light"));
}

/// Small images have the shape of the scene's own, and light tracing takes part where it should.
#[test]
fn own_scenes_are_as_they_are_described() {
    let folder = tempfile::tempdir().unwrap();
    scenes::unpack(folder.path()).unwrap();
    let (places, _) = plan::places(&options(), folder.path());
    assert_eq!(places.len(), 4);
    for Place { scene, path } in places {
        let loaded = load(&path, &LoadOptions::default()).unwrap();
        let [width, height] = loaded.scene.film().resolution;
        assert_eq!(width * scene.size[1], height * scene.size[0], "{path:?}");
        let spots = blind_spots(&loaded.scene, IntegratorKind::Light);
        let misses = spots.into_iter().any(BlindSpot::is_missing);
        assert_eq!(misses, scene.light == LightTracing::Incomplete, "{path:?}");
    }
}

#[test]
fn what_is_not_there_is_absent_with_a_reason() {
    let (places, absent) = plan::places(&options(), Path::new("own"));
    assert_eq!((places.len(), absent.len()), (4, 5));
    assert!(
        absent
            .iter()
            .all(|absent| absent.reason.contains("not set"))
    );
    let folder = tempfile::tempdir().unwrap();
    let there = scenes::path_of_others(folder.path(), "coffee");
    std::fs::create_dir_all(there.parent().unwrap()).unwrap();
    std::fs::write(&there, "").unwrap();
    let some = Options {
        others: Some(folder.path().to_owned()),
        scenes: vec!["coffee".to_owned(), "veach-mis".to_owned()],
        ..options()
    };
    let (places, absent) = plan::places(&some, Path::new("own"));
    assert_eq!((places.len(), &places[0].path), (1, &there));
    let [Absent { name, reason }] = &absent[..] else {
        panic!("{absent:?}");
    };
    assert_eq!(*name, "veach-mis");
    assert!(
        reason.contains("pbrt-v4/veach-mis/veach-mis.pbrt"),
        "{reason}"
    );
}

pub(super) fn setup(folder: &Path) -> Setup {
    Setup {
        folder: folder.to_owned(),
        start: Start::Resume,
        program: "test".to_owned(),
        machine: Machine::default(),
    }
}

#[track_caller]
pub(super) fn check_shape(table: &Table) {
    let columns = table.columns.len();
    assert!(
        table.rows.iter().all(|row| row.len() == columns),
        "{table:#?}"
    );
}

/// A clock that goes on when it is looked at, and stops after a number of renders.
#[derive(Default)]
struct Host {
    looks: std::cell::Cell<u32>,
    renders: usize,
    most: Option<usize>,
    warnings: Vec<String>,
}

impl Observer for Host {
    fn tell(&mut self, event: Event<'_>) {
        match event {
            Event::Record(_) => self.renders += 1,
            Event::Warning(text) => self.warnings.push(text.to_owned()),
            _ => {}
        }
    }

    fn seconds(&self) -> f64 {
        self.looks.set(self.looks.get() + 1);
        f64::from(self.looks.get())
    }

    fn should_stop(&mut self) -> bool {
        self.most.is_some_and(|most| self.renders >= most)
    }
}

/// Stopped and gone on with: nothing is rendered twice, and tables are full.
#[test]
fn everything_works_small() {
    let folder = tempfile::tempdir().unwrap();
    let mut options = Options {
        scenes: vec!["room-direct".to_owned(), "coffee".to_owned()],
        ..options()
    };
    options.amounts.seeds = 1;
    let mut host = Host {
        most: Some(3),
        ..Host::default()
    };
    let stopped = run(&options, &setup(folder.path()), &mut host).unwrap();
    let found = stopped.results.unwrap();
    assert_eq!((stopped.end, found.records.len()), (End::Stopped, 3));
    assert_eq!(
        host.warnings[0],
        "scene `coffee` is left out: BIDIR_SCENES is not set"
    );
    let mut host = Host::default();
    let whole = run(&options, &setup(folder.path()), &mut host).unwrap();
    let results = whole.results.unwrap();
    assert_eq!(whole.end, End::Complete);
    assert_eq!(host.renders + 3, results.records.len());
    assert!(results.description.contains("coffee is left out"));
    let metrics = |record: &Record| record.metrics.contains_key("relmse_block");
    assert!(results.records.iter().all(metrics));
    let images: Vec<_> = results
        .records
        .iter()
        .filter_map(|r| r.image.as_ref())
        .collect();
    assert_eq!(images.len(), 4);
    assert!(
        images
            .iter()
            .all(|image| folder.path().join(image).exists())
    );
    check_tables(results, &options);
}

/// Every gain in the scene that was rendered has an interval, were there a second seed with other
/// errors.
fn check_tables(mut results: Results, options: &Options) {
    let mut others = results.records.clone();
    for (i, record) in others.iter_mut().enumerate() {
        let factor = 1.0 + 0.1 * (i % 5) as f64;
        record.seed += 1;
        record
            .metrics
            .values_mut()
            .for_each(|error| *error *= factor);
    }
    results.records.extend(others);
    let results = concluded(options, results, &[]);
    let sections = sections(&results, &options.amounts);
    let nothing = Cell::Text("–".to_owned());
    for table in sections.iter().flat_map(|section| &section.tables) {
        check_shape(table);
        for row in &table.rows {
            let is_known = |cell: &&Cell| **cell != nothing;
            let known = row.iter().filter(is_known).count();
            let is_measured = !row.contains(&Cell::Text("not measured".to_owned()));
            // Only the processors' clock is missing, in two columns.
            assert!(!is_measured || known + 2 >= row.len(), "{row:?}");
        }
    }
    let judged = |claim: &&Claim| claim.verdict != Verdict::NotMeasured;
    assert_eq!(results.claims.iter().filter(judged).count(), 2);
}

#[test]
fn a_scene_is_left_out_only_where_its_reference_is_contradicted() {
    let of = |error| ExperimentError::Reference {
        scene: "coffee".to_owned(),
        error,
    };
    let folder = Path::new("reference").to_owned();
    assert!(is_contradicted(&of(reference::Error::Disagree {
        folder: folder.clone(),
        p: 1e-6,
    })));
    let reason = "of another scene".to_owned();
    assert!(!is_contradicted(&of(reference::Error::Refused {
        folder,
        reason
    })));
    assert!(!is_contradicted(&ExperimentError::NoScenes(String::new())));
}

#[test]
fn without_any_scene_there_is_nothing_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        scenes: vec!["coffee".to_owned()],
        ..options()
    };
    let error = run(&options, &setup(folder.path()), &mut Host::default()).unwrap_err();
    assert!(matches!(error, ExperimentError::NoScenes(_)), "{error}");
    assert!(error.hint().unwrap().contains("pbrt-v4"));
}
