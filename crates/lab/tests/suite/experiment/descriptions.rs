use super::common::{DESCRIPTION, Workplace};
use bidir_lab::experiment::{
    BudgetSpec, Experiment, ExperimentError, ReferenceRecipe, ReferenceSpec,
};
use bidir_lab::results::BudgetKind;

/// Checks message, place and hint of the error of a description.
#[track_caller]
fn check(text: &str, expected: &str, hint: Option<&str>) {
    let place = Workplace::new();
    let error = place.read(text).unwrap_err();
    assert!(matches!(error, ExperimentError::Description(_)));
    let said = error.to_string();
    let name = place.path("test.toml").display().to_string();
    assert_eq!(said.strip_prefix(&name), Some(expected));
    assert_eq!(error.hint(), hint);
}

#[test]
fn errors_have_their_place() {
    check(
        "seeds = \n",
        ":1:9: string values must be quoted, expected literal string",
        None,
    );
    // A misspelt key is reported before the required key that is then missing.
    let near = |name: &str| Some(format!("did you mean `{name}`?"));
    check(
        "sedes = 3\n",
        ":1:1: there is no key `sedes` here",
        near("seeds").as_deref(),
    );
    check(
        &DESCRIPTION.replace("reference-spp", "reference-sp"),
        ":6:1: there is no key `reference-sp` here",
        near("reference-spp").as_deref(),
    );
    check(
        &(DESCRIPTION.to_owned() + "[[budget]]\nsample = 2\n"),
        ":13:1: there is no key `sample` here",
        near("samples").as_deref(),
    );
    check("title = \"a\"\n", ":1:1: there is no [[scene]]", None);
}

#[test]
fn wrong_values_are_refused_with_their_place() {
    let all = DESCRIPTION.to_owned() + "[[budget]]\nsamples = 2\n";
    check(
        &all.replace("seeds", "sedes"),
        ":2:1: there is no key `sedes` here",
        Some("did you mean `seeds`?"),
    );
    check(
        &all.replace("shadow-rays = \"per-pair\"", "mis = \"powr\""),
        ":11:7: unknown name `powr`: did you mean `power`?",
        None,
    );
    check(
        &all.replace("samples = 2", "samples = 0"),
        ":13:11: expected a whole number of at least 1",
        None,
    );
    for threads in [
        "0",
        "1025",
        "4294967296",
        "9223372036854775807",
        "-1",
        "2.0",
    ] {
        check(
            &all.replace("threads = 1", &format!("threads = {threads}")),
            ":3:11: expected a whole number from 1 to 1024",
            None,
        );
    }
    check(
        &all.replace("samples = 2", "samples = 2\nrays = 3"),
        ":14:8: this budget has both `samples` and `rays`",
        Some("write one [[budget]] for each"),
    );
    check(
        &all.replace("samples = 2", ""),
        ":12:1: expected one of `samples`, `rays` and `seconds`",
        None,
    );
    check(
        &all.replace("\"one\"", "\"All \""),
        ":9:1: there is another method `All `",
        None,
    );
    check(
        &all.replace("reference-spp = 16", "size = 3"),
        ":6:8: expected WIDTHxHEIGHT, such as 320x240",
        None,
    );
    check(
        &all.replace("shadow-rays = \"per-pair\"", "max-depth = 0x10"),
        ":11:13: expected a decimal number",
        None,
    );
    check(
        &all.replace(
            "shadow-rays = \"per-pair\"",
            "candidates = \"12,1\"\nintegrator = \"path\"",
        ),
        ":11:14: `candidates` has no effect on the integrator `path`",
        None,
    );
    check(
        &("[[settings]]\nmis = \"power\"\n[[settings]]\n".to_owned() + &all),
        ":3:1: there is a second [settings]",
        None,
    );
    check(
        &all.replace("reference-spp = 16", ""),
        ":4:1: `reference`, `reference-of` or `reference-spp` is missing",
        None,
    );
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

#[test]
fn settings_without_effect_on_the_integrator_of_a_method_are_refused() {
    let of_all =
        format!("{DESCRIPTION}[settings]\nintegrator = \"path\"\n[[budget]]\nsamples = 2\n");
    let hint = "[settings] sets this integrator: give the method its own, or leave the setting out";
    check(
        &of_all,
        ":11:15: `shadow-rays` has no effect on the integrator `path`",
        Some(hint),
    );
    let own = of_all.replace("shadow-rays =", "integrator = \"bdpt\"\nshadow-rays =");
    Workplace::new().read(&own).unwrap();
    // The scene file may set the integrator.
    let place = Workplace::new();
    let scene = std::fs::read_to_string(place.path("room.pbrt")).unwrap();
    let scene = scene.replace("Integrator \"bdpt\"", "Integrator \"path\"");
    std::fs::write(place.path("room.pbrt"), scene).unwrap();
    let text = DESCRIPTION.to_owned() + "[[budget]]\nsamples = 2\n";
    assert_eq!(
        place.refusal(&text, "out").to_string(),
        "scene `room`: method `one`: `shadow-rays` has no effect on the integrator `path`, which the \
         scene sets"
    );
}

#[test]
fn the_method_of_a_pyramid_is_bidirectional() {
    let with = |lines: &str| format!("{lines}\n{DESCRIPTION}[[budget]]\nsamples = 2\n");
    check(
        &with("pyramid = \"al\""),
        ":1:11: unknown name `al`: did you mean `all`?",
        None,
    );
    check(
        &with("pyramid = \"everything\""),
        ":1:11: unknown name `everything`: expected all, one",
        None,
    );
    check(
        &with("pyramid = \"one\"").replace("shadow-rays = \"per-pair\"", "integrator = \"light\""),
        ":1:11: the method `one` is not bidirectional",
        Some("strategies (s, t) are those of a method whose integrator is \"bdpt\""),
    );
    check(
        &with("pyramid-spp = 4"),
        ":1:15: `pyramid-spp` needs `pyramid`",
        None,
    );
    check(
        &with("pyramid = \"all\"\npyramid-spp = 1"),
        ":2:15: expected a whole number of at least 2",
        None,
    );
    let place = Workplace::new();
    let experiment = place.read(&with("pyramid = \"one\"")).unwrap();
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
    let both = text(
        "reference-cross-check",
        "emission = \"power\"\nlight-start",
        "auto",
    );
    let error = place.read(&both).unwrap_err().to_string();
    let both = "`emission` is the older name of `light-start`: write one of them";
    assert!(error.ends_with(both), "{error}");
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
