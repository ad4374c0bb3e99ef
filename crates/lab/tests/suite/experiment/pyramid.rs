use super::common::{DESCRIPTION, Watch, Workplace, without_times};
use bidir_lab::experiment::{End, ExperimentError};
use bidir_lab::results::Results;
use std::fs;

/// Four samples per pixel of the method `all`.
fn description() -> String {
    format!("pyramid = \"all\"\npyramid-spp = 4\n{DESCRIPTION}[[budget]]\nsamples = 2\n")
}

#[test]
fn strategies_add_up_to_the_picture() {
    let place = Workplace::new();
    let results = place.complete(&description(), "out");
    let [pyramid] = &results.pyramids[..] else {
        panic!("{:?}", results.pyramids);
    };
    assert_eq!((&*pyramid.scene, &*pyramid.method), ("room", "all"));
    assert_eq!((pyramid.seed, pyramid.spp, pyramid.size), (0, 4, [16, 12]));
    let sum: f64 = pyramid
        .strategies
        .iter()
        .map(|strategy| strategy.mean)
        .sum();
    assert!((sum + pyramid.longer - pyramid.mean).abs() < 1e-5 * pyramid.mean);
    for strategy in &pyramid.strategies {
        assert!(strategy.raw_mean >= strategy.mean && strategy.blocked <= strategy.rays);
        assert_eq!(strategy.rays > 0, strategy.s > 0);
        assert!(strategy.variance.is_some(), "{strategy:?}");
    }
    let images = place.path("out").join(&pyramid.images);
    let layers = formats::image::read_layers(&images).unwrap();
    assert_eq!(layers.size(), pyramid.size);
    for strategy in &pyramid.strategies {
        let name = format!("raw.s{}t{}", strategy.s, strategy.t);
        let [r, g, b] = ["R", "G", "B"].map(|channel| format!("{name}.{channel}"));
        assert!(layers.triples([&r, &g, &b]).is_some(), "{name}");
    }
    let text = fs::read_to_string(place.path("out/results.json")).unwrap();
    assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), results);
}

/// Also where records are there before it is asked for.
#[test]
fn records_know_nothing_of_it_and_it_is_rendered_once() {
    let place = Workplace::new();
    let plain = description().replace("pyramid", "# pyramid");
    let before = place.complete(&plain, "out");
    assert!(before.pyramids.is_empty());
    let mut watch = Watch::default();
    let first = place.run(&description(), "out", &mut watch).unwrap();
    assert_eq!((watch.strategy_passes, watch.renders), (4, 0));
    let first = first.results.unwrap();
    assert_eq!(first.records, before.records);
    let mut watch = Watch::default();
    let again = place.run(&description(), "out", &mut watch).unwrap();
    assert_eq!((watch.strategy_passes, watch.renders), (0, 0));
    assert_eq!(again.results.unwrap(), first);
    // Another number of samples is another pyramid; what was found before is not shown.
    let more = description().replace("spp = 4", "spp = 5");
    let more = place.complete(&more, "out");
    assert_eq!((more.pyramids.len(), more.pyramids[0].spp), (1, 5));
    let whole = place.complete(&description(), "whole");
    assert_eq!(whole.pyramids, first.pyramids);
    // No time of a record has any part of it.
    for (record, plain) in whole.records.iter().zip(&before.records) {
        assert!((record.seconds - plain.seconds).abs() < 1e-9);
    }
}

#[test]
fn stopping_forgets_what_was_running() {
    let place = Workplace::new();
    let whole = place.complete(&description(), "whole");
    for passes in 0..4 {
        let out = format!("out-{passes}");
        // References are there before strategies are.
        place.complete(&description().replace("pyramid", "# pyramid"), &out);
        let mut watch = Watch::at_strategy_pass(passes);
        let stopped = place.run(&description(), &out, &mut watch).unwrap();
        assert_eq!(stopped.end, End::Stopped);
        assert!(stopped.results.unwrap().pyramids.is_empty());
        let results = place.complete(&description(), &out);
        assert_eq!(results.pyramids, whole.pyramids);
        assert_eq!(
            without_times(&results.records),
            without_times(&whole.records)
        );
    }
}

/// A tile shows no more.
#[test]
fn large_images_are_rendered_small() {
    let place = Workplace::new();
    let text = description().replace("threads = 1", "threads = 1\nsize = \"240x8\"");
    let results = place.complete(
        &text.replace("reference-spp = 16", "reference-spp = 1"),
        "out",
    );
    assert_eq!(results.scenes[0].size, [240, 8]);
    assert_eq!(results.pyramids[0].size, [128, 4]);
}

#[test]
fn a_scene_whose_method_has_no_strategies_is_refused() {
    let place = Workplace::new();
    let scene = fs::read_to_string(place.path("room.pbrt")).unwrap();
    let scene = scene.replace("Integrator \"bdpt\"", "Integrator \"path\"");
    fs::write(place.path("room.pbrt"), scene).unwrap();
    let other = "shadow-rays = \"per-pair\"";
    let description = description().replace(other, &format!("integrator = \"bdpt\"\n{other}"));
    let error = place.run(&description, "out", &mut Watch::default());
    let error = error.unwrap_err();
    assert!(matches!(error, ExperimentError::Pyramid { .. }), "{error}");
    assert_eq!(error.hint(), Some("give the method integrator = \"bdpt\""));
}
