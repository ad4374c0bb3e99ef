use super::*;
use crate::image::{Pixels, digest};
use crate::seal;
use crate::statistics::{Estimated, z_test};
use bidir::driver::{Progress, Resources, Settings, Stop};
use bidir::integrator::IntegratorKind;
use bidir::path::LightPointChoice;
use bidir::sampler::SamplerKind;
use bidir::settings::Request;
use formats::film::Subject;
use formats::pbrt::{LoadOptions, Loaded, build, parse_text};
use std::fs;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use tempfile::TempDir;

/// A floor and a wall below a light that the camera does not see.
const SCENE: &str = r#"
LookAt 0 1 -4  0 1 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 12 "integer yresolution" 8
Integrator "bdpt" "integer maxdepth" 3
WorldBegin
Material "diffuse" "rgb reflectance" [0.7 0.6 0.5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-2 0 -2 -2 0 2 2 0 2 2 0 -2]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-2 0 2 -2 3 2 2 3 2 2 0 2]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [9 8 7]
Shape "trianglemesh" "integer indices" [0 2 1 0 3 2]
  "point3 P" [-0.5 2.8 0 -0.5 2.8 1 0.5 2.8 1 0.5 2.8 0]
AttributeEnd
"#;

fn scene(text: &str) -> Loaded {
    let description = parse_text("room.pbrt", text).unwrap();
    build(&description, &LoadOptions::default()).unwrap()
}

fn subject(text: &str) -> Subject {
    scene(text).subject()
}

/// A temporary folder and a scene.
struct Workplace {
    folder: TempDir,
    subject: Subject,
}

impl Workplace {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            subject: subject(SCENE),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn made(
        &self,
        name: &str,
        plan: &Plan,
        host: &dyn Progress,
    ) -> Result<Option<Provenance>, Error> {
        let resources = Resources {
            threads: 1,
            ..Resources::default()
        };
        let job = Job {
            folder: &self.path(name),
            subject: &self.subject,
            plan,
            resources: &resources,
            host,
        };
        job.make()
    }

    #[track_caller]
    fn make(&self, name: &str, plan: &Plan) -> Provenance {
        let made = self.made(name, plan, &()).unwrap();
        made.expect("the host never stops")
    }

    /// Reads the image and its variances.
    fn images(&self, name: &str) -> [Pixels; 2] {
        let layers = formats::image::read_layers(&self.path(name).join(PICTURE)).unwrap();
        ["", "Variance."].map(|prefix| Pixels::layer(&layers, prefix).unwrap())
    }

    /// Returns the error of loading the reference.
    #[track_caller]
    fn refusal(&self, name: &str) -> String {
        Provenance::load(&self.path(name)).unwrap_err().to_string()
    }
}

fn plan(spp: u64) -> Plan {
    let mut scene = Settings::default();
    scene.path.max_depth = Some(3);
    let request = Request::default();
    Plan::new(&scene, spp, [&request; 2])
}

#[test]
fn estimators_that_agree_make_a_reference() {
    let place = Workplace::new();
    let made = place.make("a", &plan(256));
    let Agreement {
        agree,
        comparisons,
        block,
        smallest_bias,
        ..
    } = made.agreement;
    assert!(agree && comparisons == 9 && block == 8);
    let bias = smallest_bias.unwrap();
    assert!((0.01..0.2).contains(&bias), "{bias}");
    let loaded = Provenance::load(&place.path("a")).unwrap();
    let [picture, variance] = place.images("a");
    assert_eq!(loaded.picture, digest(&[&picture, &variance]));
    assert_eq!(loaded.estimators, made.estimators);
    loaded.check(&place.subject).unwrap();
    for (record, light) in made.estimators.iter().zip([true, false]) {
        assert_eq!((record.spp, record.replicates), (256, REPLICATES));
        assert_eq!(record.rays.light > 0, light);
        let samples = 256 * 12 * 8;
        assert!(record.rays.camera > samples && record.dropped == 0);
    }
}

#[test]
fn restricted_estimators_agree_where_they_make_the_same_paths() {
    let place = Workplace::new();
    let mut plan = plan(128);
    let [first, second] = &mut plan.estimators;
    first.path.strategies = "all,-s0,-t1".parse().unwrap();
    first.path.light_point = LightPointChoice::Shared;
    second.set_integrator(IntegratorKind::Bdpt);
    second.path.strategies = "s1,-t1".parse().unwrap();
    let made = place.make("a", &plan);
    assert!(made.agreement.agree);
    let summary = made.summary();
    let extended = Plan::extended(&made, 16).unwrap();
    let made = place.make("a", &extended);
    assert_eq!(made.estimators[1].spp, 144);
    clear(&place.path("a")).unwrap();
    assert!(!is_reference(&place.path("a")));
    assert_eq!(place.make("a", &plan).estimators[0].spp, 128);
    let expected = "bdpt --light-point shared --strategies all,-s0,-t1, 128 samples per pixel; agrees with \
                    bdpt --strategies s1,-t1, 128";
    assert!(summary.starts_with(expected), "{summary}");
}

#[test]
fn an_estimator_that_misses_paths_is_detected() {
    let place = Workplace::new();
    let mut plan = plan(128);
    plan.estimators[1].path.max_depth = Some(1);
    let made = place.make("a", &plan);
    let agreement = &made.agreement;
    assert!(!agreement.agree && agreement.p < LEVEL);
    let refusal = place.refusal("a");
    assert!(refusal.contains("its estimators disagree"), "{refusal}");
    // Setting the flag by hand does not help.
    let path = place.path("a/provenance.json");
    let json = fs::read_to_string(&path).unwrap();
    let by_hand = json.replace("\"agree\": false", "\"agree\": true");
    fs::write(&path, resealed(&by_hand)).unwrap();
    assert!(place.refusal("a").contains("its estimators disagree"));
}

/// A host whose clock counts readings, and that stops after some samples.
struct Readings {
    looks: AtomicU64,
    left: AtomicI64,
    flag: AtomicBool,
}

impl Progress for Readings {
    fn advance(&self, samples: u64) {
        let samples = samples as i64;
        let is_last = self.left.fetch_sub(samples, Ordering::Relaxed) <= samples;
        self.flag.fetch_or(is_last, Ordering::Relaxed);
    }

    fn resume(&self, _samples: u64) {}

    fn stop(&self) -> Stop<'_> {
        Stop::when(&self.flag)
    }

    fn nanoseconds(&self) -> u64 {
        self.looks.fetch_add(1_000_000_000, Ordering::Relaxed)
    }
}

#[test]
fn stopped_and_extended_references_have_the_same_bits() {
    let place = Workplace::new();
    place.make("a", &plan(64));
    let at_once = Provenance::load(&place.path("a")).unwrap();
    place.make("b", &plan(17));
    let mut stops = 0;
    // In the middle of the first estimator, of the second, and never.
    for passes in [7, 50, 1000] {
        let readings = Readings {
            looks: AtomicU64::new(0),
            left: AtomicI64::new(passes * 12 * 8),
            flag: AtomicBool::new(false),
        };
        if place.made("b", &plan(60), &readings).unwrap().is_none() {
            stops += 1;
            // The reference of 32 samples stays intact meanwhile.
            let spp = Provenance::load(&place.path("b")).unwrap();
            assert_eq!(spp.estimators[0].spp, 32);
        }
    }
    assert_eq!(stops, 2);
    let extended = Provenance::load(&place.path("b")).unwrap();
    assert!(extended.estimators[1].seconds > 0.0);
    assert_eq!(extended.picture, at_once.picture);
    assert_eq!(extended.agreement, at_once.agreement);
    let rays = |reference: &Provenance| reference.estimators.clone().map(|e| e.rays);
    assert_eq!(rays(&extended), rays(&at_once));
    let film = |name: &str| {
        let path = place.path(name).join("films/against-15.film");
        formats::film::read(&path).unwrap().film
    };
    assert!(film("a") == film("b"));
    let error = place.made("b", &plan(32), &()).unwrap_err().to_string();
    assert!(error.contains("has 64 samples per pixel"), "{error}");
}

#[test]
fn references_of_other_seeds_differ_within_their_variance() {
    let place = Workplace::new();
    let a = place.make("a", &plan(128));
    let mut other = plan(128);
    for settings in &mut other.estimators {
        settings.seed = 1;
    }
    let b = place.make("b", &other);
    assert_ne!(a.picture, b.picture);
    let seeds = [&a, &b].map(|r| r.estimators.each_ref().map(|e| e.first_seed));
    let seeds = seeds.as_flattened();
    assert!(seeds.windows(2).all(|pair| pair[1] == pair[0] + REPLICATES));
    let images = ["a", "b"].map(|name| place.images(name));
    let [a, b] = images.each_ref().map(|[mean, variance]| Estimated {
        mean,
        variance,
        freedom: 127.0,
    });
    let p = z_test(&a, &b, 4).unwrap().p;
    assert!(p >= LEVEL, "{p}");
}

#[test]
fn another_scene_and_another_film_are_refused() {
    let place = Workplace::new();
    let reference = place.make("a", &plan(1));
    let refusal = |subject: &Subject| {
        let error = reference.check(subject).unwrap_err();
        error.to_string()
    };
    let changed = refusal(&subject(&SCENE.replace("9 8 7", "9 8 8")));
    assert!(changed.contains("one that has changed since"), "{changed}");
    let mut other = place.subject.clone();
    let mut film = other.view.film().clone();
    film.crop.max[1] = 7;
    let camera = *other.view.camera();
    other.view = other.view.moved(camera, film.clone()).unwrap();
    assert!(refusal(&other).contains("another crop: 0,0,12,8, not 0,0,12,7"));
    film.resolution = [24, 16];
    other.view = other.view.moved(camera, film).unwrap();
    assert!(refusal(&other).contains("another size: 12 x 8, not 24 x 16"));
}

#[test]
fn films_of_another_render_are_refused() {
    let mut place = Workplace::new();
    place.make("a", &plan(1));
    let mut other = plan(32);
    other.estimators[0].sampler = SamplerKind::Sobol;
    let error = place.made("a", &other, &()).unwrap_err().to_string();
    let expected = "picture-00.film is the film of another render: sampler is sobol in this render and independent";
    assert!(error.contains(expected), "{error}");
    place.subject = subject(&SCENE.replace("9 8 7", "9 8 8"));
    let error = place.made("a", &plan(32), &()).unwrap_err().to_string();
    assert!(error.contains("scene-digest is"), "{error}");
}

/// Replaces the checksum of a JSON text.
fn resealed(json: &str) -> String {
    seal::sealed(&unsealed(json).to_string())
}

fn unsealed(json: &str) -> serde_json::Value {
    let mut json: serde_json::Value = serde_json::from_str(json).unwrap();
    json.as_object_mut().unwrap().remove("checksum");
    json
}

#[test]
fn every_flipped_bit_in_a_file_of_a_reference_is_an_error() {
    let place = Workplace::new();
    place.make("a", &plan(1));
    for name in [PICTURE, AGAINST, PROVENANCE] {
        let path = place.path("a").join(name);
        let whole = fs::read(&path).unwrap();
        let bits = 8 * (whole.len() - 1);
        for bit in (0..bits).step_by(bits / 40) {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, bytes).unwrap();
            let refusal = place.refusal("a");
            assert!(refusal.contains(name), "bit {bit}: {refusal}");
        }
        fs::remove_file(&path).unwrap();
        let refusal = place.refusal("a");
        assert!(refusal.contains(name), "{refusal}");
        fs::write(&path, whole).unwrap();
    }
    Provenance::load(&place.path("a")).unwrap();
}

#[test]
fn damaged_and_stale_references_are_refused() {
    let place = Workplace::new();
    place.make("a", &plan(1));
    let path = place.path("a/provenance.json");
    let whole = fs::read_to_string(&path).unwrap();
    let check = |text: &str, part: &str| {
        fs::write(&path, text).unwrap();
        let refusal = place.refusal("a");
        assert!(refusal.contains(part), "{refusal}");
    };
    check(&whole[..whole.len() / 2], "provenance.json: damaged: EOF");
    check("{}", "damaged: it has no checksum");
    check("[2]", "damaged");
    check(
        &resealed(&whole.replace("\"format\": 2", "\"format\": 3")),
        "the reference has format 3; this program reads format 2",
    );
    check(&unsealed(&whole).to_string(), "damaged: it has no checksum");
    let version = bidir::ESTIMATOR_VERSION;
    let line = |version: u32| format!("\"estimator_version\": {version}");
    check(
        &resealed(&whole.replace(&line(version), &line(version + 1))),
        "stale: made by version",
    );
    fs::write(&path, &whole).unwrap();
    fs::copy(place.path("a/against.exr"), place.path("a/picture.exr")).unwrap();
    check(&whole, "picture.exr: damaged: it is not the file that");
    fs::remove_file(place.path("a/picture.exr")).unwrap();
    check(&whole, "picture.exr: damaged: it is missing");
    fs::remove_file(&path).unwrap();
    assert!(place.refusal("a").contains("provenance.json"));
    assert!(!is_reference(&place.path("a")));
}
