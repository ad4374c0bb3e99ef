use super::common::{DESCRIPTION, SCENE, Watch, Workplace};
use bidir_lab::experiment::ExperimentError;
use bidir_lab::reference::Error;
use bidir_lab::results::Results;
use formats::image::{ExrImage, ExrLayer, read_layers, write_exr};
use std::fs;

const MADE: &str = "reference-spp = 16";
const BUDGET: &str = "[[budget]]\nsamples = 1\n";

/// Runs an experiment; returns its folder, its results, and a function that makes the same description with
/// an existing reference.
fn place() -> (Workplace, Results, impl Fn(&str) -> String) {
    let place = Workplace::new();
    let results = place.complete(&format!("{DESCRIPTION}{BUDGET}"), "made");
    let given = |name: &str| {
        let description = DESCRIPTION.replace(MADE, &format!("reference = \"{name}\""));
        description + BUDGET
    };
    (place, results, given)
}

/// Writes the reference of an experiment as `name`, with changed pixels.
fn write_changed(
    place: &Workplace,
    results: &Results,
    name: &str,
    change: impl Fn(&mut [[f32; 3]]),
) {
    let image = results.scenes[0].reference_image.as_ref().unwrap();
    let layers = read_layers(&place.path("made").join(image)).unwrap();
    let mut pixels = layers.triples(["R", "G", "B"]).unwrap();
    change(&mut pixels);
    let picture = [ExrLayer::rgb("", &pixels)];
    let image = ExrImage::whole(layers.size(), &picture);
    write_exr(&place.path(name), &image).unwrap();
}

#[test]
fn a_missing_file_is_reported_at_the_place_that_names_it() {
    let place = Workplace::new();
    let text = format!("{DESCRIPTION}{BUDGET}");
    let misspelt = text.replace("\"room", "\"rom");
    let parts = ["test.toml:5:8: cannot open `", "rom.pbrt`: no such file"];
    place.refusal(&misspelt, "out", &parts);
    let missing = text.replace(MADE, "reference = \"none.exr\"");
    place.refusal(&missing, "out", &["test.toml:6:13: cannot open `"]);
    // The error of an included file is placed in the scene file.
    let scene = format!("{SCENE}Include \"none.pbrt\"");
    fs::write(place.path("room.pbrt"), scene).unwrap();
    place.refusal(&text, "out", &["room.pbrt:18:9: "]);
}

#[test]
fn an_existing_reference_is_identified_by_its_pixels() {
    let (place, results, given) = place();
    let text = given("image.exr");
    write_changed(&place, &results, "image.exr", |_| {});
    let compared = place.complete(&text, "out");
    let metrics = |results: &Results| {
        let records = results.records.iter();
        records.map(|r| r.metrics.clone()).collect::<Vec<_>>()
    };
    assert_eq!(metrics(&compared), metrics(&results));
    write_changed(&place, &results, "image.exr", |pixels| pixels[7][1] += 0.5);
    let error = place.refusal(&text, "out", &[]);
    assert!(matches!(error, ExperimentError::Mismatch(_)), "{error}");
    // The same pixels in another image or in a folder give the same experiment.
    write_changed(&place, &results, "moved.exr", |_| {});
    let image = results.scenes[0].reference_image.as_ref().unwrap();
    let folder = format!("made/{}", image.trim_end_matches("/picture.exr"));
    for name in ["moved.exr", &folder] {
        let mut watch = Watch::default();
        place.run(&given(name), "out", &mut watch).unwrap();
        assert_eq!((watch.resumed, watch.renders), (4, 0), "{name}");
    }
}

#[test]
fn pixels_that_are_not_finite_are_refused() {
    let (place, results, given) = place();
    write_changed(&place, &results, "image.exr", |pixels| {
        (pixels[16 + 3][2], pixels[100][0]) = (f32::NAN, f32::INFINITY);
    });
    let parts = [
        "image.exr: the reference of `room` has 2 pixels that are not finite, the first at 3,1",
        "render it again",
    ];
    place.refusal(&given("image.exr"), "out", &parts);
}

#[test]
fn references_with_variances_have_a_known_noise_and_a_warning_if_it_is_large() {
    let (place, results, given) = place();
    let mse = results.scenes[0].reference_mse.unwrap();
    write_changed(&place, &results, "image.exr", |_| {});
    let plain = place.complete(&given("image.exr"), "plain");
    assert_eq!(plain.scenes[0].reference_mse, None);
    let picture = format!(
        "made/{}",
        results.scenes[0].reference_image.as_ref().unwrap()
    );
    let with_layers = place.complete(&given(&picture), "with-layers");
    assert!((with_layers.scenes[0].reference_mse.unwrap() - mse).abs() < 1e-9 * mse);
    // A method with as many samples as the reference: half of the mean error is noise of the reference.
    let many = "[[budget]]\nsamples = 128\n[settings]\nmax-depth = 1\n";
    let text = format!("{DESCRIPTION}{many}").replace(MADE, "reference-spp = 128");
    let text = text.replace("seeds = 2", "seeds = 24");
    let mut watch = Watch::default();
    place.run(&text, "many", &mut watch).unwrap();
    let [warning] = &watch.warnings[..] else {
        panic!("{:?}", watch.warnings);
    };
    let percent = warning
        .split(" %")
        .next()
        .unwrap()
        .rsplit(' ')
        .next()
        .unwrap();
    let percent: f64 = percent.parse().unwrap();
    assert!((25.0..75.0).contains(&percent), "{warning}");
}

/// Makes a scene with a caustic of a point light on a mirror, which path tracing cannot sample.
fn beneath_a_mirror() -> Workplace {
    let place = Workplace::new();
    let begin = SCENE.find("AttributeBegin").unwrap();
    let light = "LightSource \"point\" \"rgb I\" [9 8 7] \"point3 from\" [0 2 0.3]\n";
    let scene = SCENE[..begin].replace(
        "Shape \"sphere\"",
        "Material \"conductor\"\nShape \"sphere\"",
    );
    fs::write(place.path("room.pbrt"), scene + light).unwrap();
    place
}

#[test]
fn a_cross_check_that_samples_all_paths_can_be_named() {
    let text = format!("{DESCRIPTION}{BUDGET}");
    let naming = |integrator: &str| {
        let named = format!("reference-spp = 1024\nreference-cross-check = \"{integrator}\"");
        text.replace(MADE, &named)
    };
    let place = beneath_a_mirror();
    let results = place.complete(&naming("lvc"), "out");
    assert!(results.scenes[0].reference_image.is_some());
    let folder = fs::read_dir(place.path("out/references")).unwrap().next();
    let provenance = folder.unwrap().unwrap().path().join("provenance.json");
    let provenance = fs::read_to_string(provenance).unwrap();
    assert!(
        provenance.contains("\"integrator\": \"lvc\""),
        "{provenance}"
    );
    // Older descriptions use another key.
    let old = naming("lvc").replace("reference-cross-check", "reference-witness");
    assert!(place.read(&old).is_ok());
}

#[test]
fn strategies_without_paths_are_refused_and_lost_light_is_a_warning() {
    let place = Workplace::new();
    let text = |list: &str| {
        let method = format!("integrator = \"bdpt\"\nstrategies = \"{list}\"");
        format!("{DESCRIPTION}{BUDGET}").replace("shadow-rays = \"per-pair\"", &method)
    };
    let message = "method `one`: strategies s0t0 makes no path";
    place.refusal(&text("s0t0"), "none", &[message]);
    let mut watch = Watch::default();
    place.run(&text("s2"), "some", &mut watch).unwrap();
    let lost = "method `one`: strategies s2 loses light: no strategy makes paths of 2 vertices";
    assert!(
        watch.warnings.iter().any(|warning| warning == lost),
        "{:?}",
        watch.warnings
    );
    let both = text("s2").replace(
        "name = \"all\"",
        "name = \"all\"\nstrategies = \"s2\"\nintegrator = \"bdpt\"",
    );
    let mut watch = Watch::default();
    place.run(&both, "both", &mut watch).unwrap();
    let lost = lost.replace("`one`", "`all` and another");
    let losses = watch
        .warnings
        .iter()
        .filter(|warning| warning.contains("loses light"));
    assert_eq!(losses.collect::<Vec<_>>(), [&lost]);
}

#[test]
fn a_reference_whose_estimators_disagree_is_not_used() {
    let place = beneath_a_mirror();
    let text = format!("{DESCRIPTION}{BUDGET}").replace(MADE, "reference-spp = 1024");
    let disagree = ["room", "its estimators disagree (p = ", "--against"];
    // The second run finds the existing reference.
    for _ in 0..2 {
        let error = place.refusal(&text, "out", &disagree);
        let ExperimentError::Reference {
            scene,
            error: Error::Disagree { folder, p },
        } = &error
        else {
            panic!("{error}");
        };
        assert!(scene == "room" && *p < 1e-3 && folder.join("picture.exr").exists());
    }
    let mut folders = fs::read_dir(place.path("out/references")).unwrap();
    let folder = folders.next().unwrap().unwrap().file_name();
    let given = format!("reference = \"out/references/{}\"", folder.display());
    let text = text.replace("reference-spp = 1024", &given);
    place.refusal(&text, "other", &disagree);
}
