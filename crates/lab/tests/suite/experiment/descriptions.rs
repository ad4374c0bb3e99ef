use super::common::{DESCRIPTION, Workplace};
use bidir_lab::experiment::{
    BudgetSpec, Experiment, ExperimentError, ReferenceRecipe, ReferenceSpec,
};
use bidir_lab::results::BudgetKind;
use expect_test::expect_file;
use std::path::Path;

/// Tables that a description needs; each is left out where the description has its own.
const NEEDED: [&str; 3] = [
    "[[scene]]\nfor.name = [\"A\", \"B\"]\nname = \"{name}\"\nfile = \"a.pbrt\"\nreference-spp = 1\n",
    "[[method]]\nfor.name = [\"all\", \"one\"]\nname = \"{name}\"\n",
    "[[budget]]\nseconds = 1\n[[budget]]\nrays = 100\n",
];

/// Returns the error of a description, with its hint.
fn error_of(text: &str) -> String {
    let is_needed = |table: &&str| {
        let head = table.split('\n').next().unwrap_or_default();
        !text.contains(head) && !text.contains("# nothing else")
    };
    let needed: String = NEEDED.into_iter().filter(is_needed).collect();
    match Experiment::read(&format!("{text}\n{needed}"), Path::new("a.toml")) {
        Err(error @ ExperimentError::Description(_)) => {
            let hint = error.hint().map(|hint| format!("\n   hint: {hint}"));
            format!("{error}{}", hint.unwrap_or_default())
        }
        other => format!("{other:?}"),
    }
}

/// A case is a line `## NAME`, a description, and its error behind `=>`.
#[test]
fn errors_are_as_listed() {
    let cases = include_str!("errors.txt").split("## ").skip(1);
    let case = |case: &str| {
        let (name, rest) = case.split_once('\n').expect("a case has a name");
        let (text, _) = rest.split_once("\n=> ").expect("a case has an error");
        format!("## {name}\n{text}\n=> {}\n", error_of(text))
    };
    let cases: Vec<String> = cases.map(case).collect();
    assert!(cases.len() > 50);
    expect_file!["errors.txt"].assert_eq(&cases.join("\n"));
}

#[test]
fn paths_of_scenes_have_no_detours() {
    let place = Workplace::new();
    for file in ["out/../room.pbrt", "./room.pbrt"] {
        let text = DESCRIPTION.replace("room.pbrt", file) + "[[budget]]\nsamples = 2\n";
        let experiment = place.read(&text).unwrap();
        assert_eq!(experiment.scenes[0].path, place.path("room.pbrt"));
    }
}

/// The scene file may set the integrator.
#[test]
fn settings_without_effect_on_the_integrator_of_a_scene_are_refused() {
    let place = Workplace::new();
    let scene = std::fs::read_to_string(place.path("room.pbrt")).unwrap();
    let scene = scene.replace("Integrator \"bdpt\"", "Integrator \"path\"");
    std::fs::write(place.path("room.pbrt"), scene).unwrap();
    let text = DESCRIPTION.to_owned() + "[[budget]]\nsamples = 2\n";
    let message = "scene `room`: method `one`: `shadow-rays` has no effect on the integrator `path`, \
                   which the scene sets; set `integrator`";
    place.refusal(&text, "out", &[message]);
}

#[test]
fn a_method_has_its_own_integrator_and_a_pyramid_its_samples() {
    let own = DESCRIPTION.replace("shadow-rays =", "integrator = \"bdpt\"\nshadow-rays =");
    let text = format!(
        "pyramid = \"one\"\n{own}[settings]\nintegrator = \"path\"\n[[budget]]\nsamples = 2\n"
    );
    let experiment = Workplace::new().read(&text).unwrap();
    let spp = |experiment: &Experiment| experiment.pyramid.as_ref().unwrap().spp;
    assert_eq!((spp(&experiment), spp(&experiment.quick())), (64, 8));
}

#[test]
fn methods_inherit_the_common_settings() {
    let place = Workplace::new();
    let text = "[settings]\nmis = \"uniform\"\nstrategies = \"all,-t1\"\n".to_owned()
        + &DESCRIPTION.replace("seeds = 2\nthreads = 1\n", "")
        + "mis = \"power\"\n[[budget]]\nrays = 50.5\n";
    let experiment = place.read(&text).unwrap();
    let names = experiment.methods.iter().map(|method| {
        let mis = method.request.mis.unwrap();
        (method.name.clone(), format!("{mis:?}"))
    });
    let expected = [("all", "Uniform"), ("one", "Power")];
    assert!(names.eq(expected.map(|(name, mis)| (name.to_owned(), mis.to_owned()))));
    assert_eq!(
        experiment.budgets,
        [BudgetSpec::new(BudgetKind::Rays, 50.5)]
    );
    let ReferenceSpec::Make(ReferenceRecipe {
        spp: 16,
        request,
        cross_check: None,
    }) = &experiment.scenes[0].reference
    else {
        panic!("{:?}", experiment.scenes);
    };
    assert_eq!(request.strategies.as_ref().unwrap().to_string(), "all,-t1");
    assert_eq!(request.mis, None);
}

#[test]
fn older_names_are_accepted() {
    let text = |check: &str, start: &str, auto: &str| {
        let cross = format!("reference-spp = 16\n{check} = \"lvc\"");
        let own = format!("integrator = \"lvc\"\n{start} = \"power\"\nshadow-rays = \"{auto}\"");
        DESCRIPTION
            .replace("reference-spp = 16", &cross)
            .replace("shadow-rays = \"per-pair\"", &own)
            + "[[budget]]\nsamples = 2\n"
    };
    let place = Workplace::new();
    let today = text("reference-cross-check", "light-start", "auto");
    let older = text("reference-witness", "emission", "suited");
    let [today, older] = [today, older].map(|text| place.read(&text).unwrap());
    assert_eq!(format!("{today:?}"), format!("{older:?}"));
}

#[test]
fn a_quick_experiment_has_fewer_seeds_and_smaller_images_but_all_methods() {
    let place = Workplace::new();
    let text = DESCRIPTION.replace("seeds = 2", "seeds = 20\nsize = \"640x480\"")
        + "[[budget]]\nsamples = 1\n[[budget]]\nsamples = 64\n[[budget]]\nsamples = 2\n\
           [[scene]]\nname = \"there\"\nfile = \"room.pbrt\"\nreference = \"room.exr\"\n";
    let quick = place.read(&text).unwrap().quick();
    let sizes: Vec<_> = quick.scenes.iter().map(|scene| scene.size).collect();
    assert_eq!((quick.seeds.count, quick.size), (3, None));
    // The size of an existing image stays.
    assert_eq!(sizes, [Some([64, 48]), Some([640, 480])]);
    let names: Vec<_> = quick.budgets.iter().map(|budget| &*budget.name).collect();
    assert_eq!(names, ["1 spp", "8 spp"]);
    assert_eq!(quick.methods.len(), 2);
}
