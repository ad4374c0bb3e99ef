use super::common::{DESCRIPTION, Watch, Workplace, without_times};
use bidir_lab::experiment::{End, ExperimentError, Setup, Start, run};
use bidir_lab::results::{Machine, Results};
use std::fs;

fn with_budget(budget: &str) -> String {
    format!("{DESCRIPTION}[[budget]]\n{budget}\n")
}

#[test]
fn every_run_has_a_record() {
    let place = Workplace::new();
    let results = place.complete(&with_budget("samples = 3"), "out");
    let runs = results.records.iter();
    let runs = runs.map(|record| (record.seed, &*record.method, record.spp));
    let expected = [(0, "all", 3), (0, "one", 3), (1, "all", 3), (1, "one", 3)];
    assert!(runs.eq(expected));
    for record in &results.records {
        let rmse = record.metrics["rmse"];
        let efficiency = record.efficiency_rays * rmse * rmse * record.rays.total() as f64;
        assert!((efficiency - 1.0).abs() < 1e-9, "{record:?}");
        assert!(record.metrics.contains_key("relmse_trim"));
        // Training and each of three passes take a second.
        assert!((record.seconds - 4.0).abs() < 1e-9, "{record:?}");
        // The processors' clock is read at the beginning, after training and at the end.
        assert_eq!(record.processor_seconds, Some(4.0));
        assert_eq!(record.training_seconds, Some(1.0));
        assert_eq!(record.training_processor_seconds, Some(2.0));
        assert_eq!(record.image.is_some(), record.seed == 0);
        let images = record
            .image
            .iter()
            .map(|image| place.path("out").join(image));
        assert!(images.into_iter().all(|image| image.exists()));
    }
    let rmse = |record: usize| results.records[record].metrics["rmse"].to_bits();
    assert_ne!(rmse(0), rmse(2), "seeds are not used");
    assert_eq!(results.scenes[0].size, [16, 12]);
    assert_eq!(results.methods[1].settings["shadow-rays"], "per-pair");
    let text = fs::read_to_string(place.path("out/results.json")).unwrap();
    assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), results);
}

#[test]
fn a_budget_may_apply_to_some_methods_only() {
    let place = Workplace::new();
    let text = with_budget("samples = 1") + "[[budget]]\nsamples = 2\n";
    let mut experiment = place.read(&text).unwrap();
    experiment.budgets[1].methods.push("one".to_owned());
    assert_eq!(experiment.run_count(), 6);
    let setup = Setup {
        folder: place.path("out"),
        start: Start::Resume,
        program: "test".to_owned(),
        machine: Machine::default(),
    };
    let outcome = run(&experiment, &setup, &mut Watch::default()).unwrap();
    let records = outcome.results.unwrap().records;
    let of_two = records.iter().filter(|record| record.spp == 2);
    assert!(of_two.map(|record| &*record.method).eq(["one", "one"]));
    assert_eq!(records.len(), 6);
}

/// The first stop is during the reference.
#[test]
fn a_resumed_experiment_has_the_records_of_an_uninterrupted_one() {
    let place = Workplace::new();
    let text = with_budget("samples = 2") + "[[budget]]\nrays = 20\n";
    let whole = place.complete(&text, "whole");
    for most in 0..whole.records.len() {
        let out = format!("stopped-{most}");
        let mut watch = Watch::until(most);
        let stopped = place.run(&text, &out, &mut watch).unwrap();
        assert_eq!((stopped.end, watch.renders), (End::Stopped, most));
        let mut watch = Watch::default();
        let outcome = place.run(&text, &out, &mut watch).unwrap();
        assert_eq!((outcome.end, watch.resumed), (End::Complete, most));
        assert_eq!(watch.renders, whole.records.len() - most);
        let records = outcome.results.unwrap().records;
        assert_eq!(without_times(&records), without_times(&whole.records));
    }
}

#[test]
fn another_experiment_is_refused() {
    let place = Workplace::new();
    let text = with_budget("samples = 1");
    place.complete(&text, "out");
    // The title does not identify an experiment.
    place.complete(&format!("title = \"Other\"\n{text}"), "out");
    let other = with_budget("samples = 2");
    let error = place.refusal(&other, "out", &["--restart"]);
    assert!(matches!(error, ExperimentError::Mismatch(_)), "{error}");
    let scene = fs::read_to_string(place.path("room.pbrt")).unwrap();
    fs::write(place.path("room.pbrt"), scene + "# another\n").unwrap();
    let error = place.refusal(&text, "out", &[]);
    assert!(matches!(error, ExperimentError::Mismatch(_)), "{error}");
}

/// Tests another processor, an unknown one, and another number of threads.
#[test]
fn records_of_another_machine_are_refused() {
    let place = Workplace::new();
    let text = with_budget("samples = 1");
    place.run(&text, "out", &mut Watch::until(2)).unwrap();
    let other = Machine {
        processor: "another one".to_owned(),
        ..Machine::default()
    };
    let mut watch = Watch::default();
    let error = place.run_on(&other, &text, "out", &mut watch).unwrap_err();
    assert!(
        matches!(error, ExperimentError::Elsewhere { .. }),
        "{error}"
    );
    let message = error.to_string();
    assert!(message.contains("here another one"), "{message}");
    assert!(error.hint().unwrap().contains("--restart"));
    let unnamed = Machine {
        processor: Machine::UNKNOWN.to_owned(),
        ..Machine::default()
    };
    let mut watch = Watch::until(1);
    assert!(place.run_on(&unnamed, &text, "out", &mut watch).is_ok());
    let text_of_two = text.replace("threads = 1", "threads = 2");
    place.refusal(&text_of_two, "out", &["1 threads, here 2 threads; "]);
    assert_eq!(place.complete(&text, "out").records.len(), 4);
}

#[test]
fn equal_rays_are_equal_within_half_a_pass() {
    let place = Workplace::new();
    let (rays, pixels) = (150.0, 16.0 * 12.0);
    let text = with_budget(&format!("rays = {rays}"));
    for record in place.complete(&text, "out").records {
        let total = record.rays.total() as f64 / pixels;
        let pass = total / record.spp as f64;
        assert!(record.spp > 4, "{record:?}");
        // Passes differ a little from their mean.
        assert!((total - rays).abs() < 0.55 * pass, "{total} {pass}");
    }
}

/// Training and each pass take one second.
#[test]
fn no_pass_exceeds_the_time() {
    let place = Workplace::new();
    for record in place.complete(&with_budget("seconds = 5.5"), "out").records {
        assert_eq!(record.spp, 4, "{record:?}");
        assert!((record.seconds - 5.0).abs() < 1e-9);
    }
}

#[test]
fn rays_of_training_count_towards_the_budget() {
    let place = Workplace::new();
    let text = with_budget("rays = 1").replace("per-pair", "ray-roulette");
    let results = place.complete(&text, "out");
    let trained = &results.records[1];
    assert!(
        trained.rays.training > 10_000 && trained.spp == 1,
        "{trained:?}"
    );
    assert_eq!(results.records[0].rays.training, 0);
}

#[test]
fn a_first_pass_far_beyond_the_budget_is_a_warning() {
    let place = Workplace::new();
    let warnings = |rays: &str| {
        let mut watch = Watch::default();
        let text = with_budget(&format!("rays = {rays}"));
        place
            .run(&text, &format!("out-{rays}"), &mut watch)
            .unwrap();
        watch.warnings.retain(|text| text.contains("equal rays"));
        watch.warnings
    };
    let small = warnings("1");
    assert_eq!(small.len(), 2, "{small:?}");
    assert!(
        small[0].starts_with("scene `room`: `all` takes ")
            && small[0].ends_with(
                " rays per pixel for training and its first pass, and the budget is 1: these results \
                 are not at equal rays"
            ),
        "{small:?}"
    );
    assert_eq!(warnings("200"), [""; 0]);
}
