use super::common::{DESCRIPTION, Watch, Workplace, without_times};
use bidir_lab::experiment::End;
use bidir_lab::results::Results;
use std::fs;

/// Returns a description with a pyramid of the method `all`, with four samples per pixel.
fn description() -> String {
    format!("pyramid = \"all\"\npyramid-spp = 4\n{DESCRIPTION}[[budget]]\nsamples = 2\n")
}

#[test]
fn strategies_add_up_to_the_image() {
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

/// The pyramid may be added to a description that already has records.
#[test]
fn a_pyramid_is_rendered_once_and_leaves_records_unchanged() {
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
    // Another number of samples gives another pyramid, which replaces the former one in the results.
    let more = description().replace("spp = 4", "spp = 5");
    let more = place.complete(&more, "out");
    assert_eq!((more.pyramids.len(), more.pyramids[0].spp), (1, 5));
    let whole = place.complete(&description(), "whole");
    assert_eq!(whole.pyramids, first.pyramids);
    // The times of records exclude the pyramid.
    for (record, plain) in whole.records.iter().zip(&before.records) {
        assert!((record.seconds - plain.seconds).abs() < 1e-9);
    }
}

#[test]
fn a_stopped_pyramid_starts_over() {
    let place = Workplace::new();
    let whole = place.complete(&description(), "whole");
    for passes in 0..4 {
        let out = format!("out-{passes}");
        // This run makes the reference.
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

#[test]
fn strategies_of_large_images_are_rendered_at_the_size_of_a_tile() {
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
fn a_pyramid_of_a_method_that_is_not_bidirectional_is_refused() {
    let place = Workplace::new();
    let scene = fs::read_to_string(place.path("room.pbrt")).unwrap();
    let scene = scene.replace("Integrator \"bdpt\"", "Integrator \"path\"");
    fs::write(place.path("room.pbrt"), scene).unwrap();
    let other = "shadow-rays = \"per-pair\"";
    let description = description().replace(other, &format!("integrator = \"bdpt\"\n{other}"));
    let parts = [
        "scene `room`: method `all`: its strategies cannot be measured",
        "give the method integrator = \"bdpt\"",
    ];
    place.refusal(&description, "out", &parts);
}
